# SPDX-License-Identifier: LGPL-3.0-or-later
"""Quantities: names, units and display formats of results.

A quantity that has a place is an entry of :data:`MEASURED`, and :mod:`.analysis.measure` yields its
values. The design effect of a proof is an entry of :data:`PROVED`. A number of a whole model
annotates the field of its record:

>>> from protractile.runs.pipeline.residual_vibration import ResidualVibration
>>> declared_quantities(ResidualVibration)["tip"].title
'residual vibration'
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import KW_ONLY, dataclass, replace
from functools import partial
from types import UnionType
from typing import ClassVar, get_args, get_type_hints

from protractile.geometry.units import Unit


@dataclass(frozen=True, slots=True)
class Quantity:
    """Name, unit and display format of a result."""

    name: str  #: name in files and limits; "." for the name of the field; empty to omit the result
    unit: str  #: SI unit in files
    title: str  #: a lower-case phrase for display
    _: KW_ONLY
    shown: str = ""  #: displayed unit; the SI unit unless given
    heading: str = ""  #: heading in tables of reports; empty to omit the result there
    form: str = ".4g"  #: number format in tables of reports
    charted: bool = True  #: True if the result is smooth enough for a chart
    logarithmic: bool = False  #: True for a logarithmic scale in charts
    at_rest: str = ""  #: title of the largest static value; the title unless given
    in_motion: str = ""  #: title of the largest value in motion; the title unless given
    limit: str = ""  #: name of the permitted value, for sentences
    short: str = ""  #: one word for narrow tables; empty without a limit
    lowest: bool = False  #: True if the smallest value governs
    swept: bool = True  #: True if sweeps and limits have the largest value in motion

    @property
    def factor(self) -> float:
        """The conversion factor from the SI unit to the displayed unit."""
        return Unit.conversion(self.shown_unit)

    @property
    def shown_unit(self) -> str:
        """The displayed unit, which is "–" for dimensionless numbers."""
        return self.shown or ("–" if self.unit == "1" else self.unit)

    @property
    def unit_of_heading(self) -> str:
        """The displayed unit as part of the heading; empty for dimensionless numbers."""
        return "" if self.unit == "1" else self.shown_unit


# Quantity that sweeps do not have.
_unswept = partial(Quantity, swept=False)

#: quantities at places of the boom, by name
MEASURED: Mapping[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity(
            "tip", "m", "tip deflection", shown="mm",
            at_rest="static tip deflection (maximum load)",
            in_motion="maximum dynamic tip deflection",
        ),
        Quantity("tip_lateral", "m", "lateral tip deflection", shown="mm"),
        Quantity("contact_force", "N", "contact force", shown="kN"),
        _unswept("penetration", "m", "contact penetration", shown="mm"),
        _unswept("closed_play", "m", "lateral play closed by bulging walls", shown="mm"),
        _unswept(
            "cylinder_force", "N", "cylinder force", shown="kN",
            limit="the capacity", short="cylinder",
        ),
        _unswept("cylinder_force_difference", "N", "force difference of cylinders", shown="kN"),
        _unswept(
            "larger_cylinder_force", "N", "larger force of two cylinders", shown="kN",
            limit="the capacity", short="cylinder",
        ),
        _unswept("rope_force", "N", "rope force", shown="kN"),
        _unswept("bending_moment", "N m", "bending moment", shown="kN m"),
        _unswept("lateral_bending_moment", "N m", "lateral bending moment", shown="kN m"),
        _unswept("reaction", "N", "transverse reaction", shown="kN"),
        _unswept("support_moment", "N m", "moment at the support", shown="kN m"),
        _unswept("lateral_reaction", "N", "lateral reaction", shown="kN"),
        _unswept("lateral_support_moment", "N m", "lateral moment at the support", shown="kN m"),
        _unswept("support_torque", "N m", "torque at the support", shown="kN m"),
        _unswept("axial_reaction", "N", "axial reaction", shown="kN"),
        _unswept("foot_reaction", "N", "foot reaction", shown="kN"),
        _unswept("outrigger_force", "N", "largest outrigger force", shown="kN"),
        _unswept("rotation", "rad", "rotation of the joint", shown="mrad"),
        _unswept("rotation_tip", "m", "tip deflection by the rotation of the joint", shown="mm"),
        Quantity(
            "stress", "Pa", "bending stress", shown="MPa",
            in_motion="maximum bending stress", limit="yield", short="bending",
        ),
        Quantity(
            "wall_stress", "Pa", "local plate stress", shown="MPa",
            limit="yield", short="plate",
        ),
        _unswept("triangle_stress", "Pa", "largest stress of a triangle", shown="MPa"),
        _unswept("pad_force", "N", "force of one pad", shown="kN"),
        Quantity(
            "pad_pressure", "Pa", "pad pressure", shown="MPa",
            limit="the allowable pressure", short="pad",
        ),
        _unswept(
            "wear", "m", "wear of a pad", shown="mm", limit="the thickness of the pad", short="wear"
        ),
        _unswept("wear_life", "1", "runs until wear reaches its limit"),
        _unswept("worn_play", "m", "play after wear", shown="mm"),
        _unswept(
            "worn_tip", "m", "static tip deflection after wear", shown="mm",
            limit="the limit of the tip at rest", short="wear",
        ),
        _unswept("frequency", "Hz", "natural frequency"),
        _unswept("plate_buckling", "1", "plate buckling factor, panel formulas", lowest=True),
        _unswept("cycles", "1", "stress cycles of a run"),
        _unswept("stress_range", "Pa", "largest stress range", shown="MPa"),
        _unswept("equivalent_range", "Pa", "damage-equivalent stress range", shown="MPa"),
        _unswept("run_damage", "1", "damage of a run"),
        Quantity(
            "damage", "1", "fatigue damage", logarithmic=True,
            limit="the fatigue life", short="fatigue",
        ),
    )
}  # fmt: skip

#: design effects of proofs, by the kind of proof
PROVED: Mapping[str, Quantity] = {
    quantity.name: quantity
    for quantity in (
        Quantity("yield", "Pa", "static strength", shown="MPa"),
        Quantity("patch", "Pa", "local plate stress", shown="MPa"),
        Quantity("plate", "Pa", "plate buckling", shown="MPa"),
        Quantity("buckling", "Pa", "plate buckling (shell)", shown="MPa"),
        Quantity("column", "N", "column buckling", shown="kN"),
        Quantity("pad", "Pa", "pad pressure", shown="MPa"),
        Quantity("cylinder", "N", "cylinder force", shown="kN"),
        Quantity("pin", "N", "pin shear", shown="kN"),
        Quantity("deflection", "m", "static tip deflection", shown="mm"),
        Quantity("tipping", "N m", "tipping", shown="kN m"),
        Quantity("fatigue", "1", "fatigue strength"),
    )
}


class Record:
    """Results of one model, which are one row of a table in reports."""

    __slots__ = ()
    title: ClassVar[str]
    notes: ClassVar[tuple[str, ...]]


def declared_quantities(kind: type) -> dict[str, Quantity]:
    """Return the quantities of a record by the names of their fields."""
    hints = get_type_hints(kind, include_extras=True)
    return {
        name: replace(quantity, name=name) if quantity.name == "." else quantity
        for name, hint in hints.items()
        for quantity in getattr(hint, "__metadata__", ())
        if isinstance(quantity, Quantity)
    }


def records(kind: type) -> dict[str, type[Record]]:
    """Return, by field name, the :class:`Record` class of each field that may hold a record."""
    return {
        name: record
        for name, hint in get_type_hints(kind).items()
        for record in (get_args(hint) if isinstance(hint, UnionType) else ())
        if issubclass(record, Record)
    }

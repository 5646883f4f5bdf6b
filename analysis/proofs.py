# SPDX-License-Identifier: LGPL-3.0-or-later
"""Proofs: design effects on parts of a boom, and their limit design values.

A proof is a row of a quantity of :data:`.analysis.quantities.PROVED`. Its value is the design
effect, and its limit the limit design value. Stresses are those of outer fibres and of walls from
section forces of second order.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from protractile.analysis.plate_buckling import (
    plate_stresses,
    reduced_stress,
    reduction_factors,
    relative_slenderness,
)
from protractile.analysis.rows import Row, Rows
from protractile.analysis.states import States
from protractile.analysis.wall_buckling import WallBuckling

# Pairs of a slenderness and a reduction factor; empty for the curves of EN 1993-1-5.
ReductionCurve = Sequence[tuple[float, float]]

#: Kinds of proofs by beams.
BY_BEAMS = "yield", "plate", "column", "pad", "cylinder", "pin", "deflection"

# Relative difference below which utilisations are equal.
_EQUAL = 1.0e-9


class Resistance(NamedTuple):
    """Factors by which resistances are divided."""

    material: float = 1.0  #: factor on yield strengths
    stability: float = 1.0  #: factor on buckling resistances of plates and of the boom
    pad: float = 1.0  #: factor on allowable pressures of pads
    cylinder: float = 1.0  #: factor on capacities of cylinders
    pin: float = 1.0  #: factor on shear resistances of pins
    tipping: float = 1.0  #: factor on the stabilising moment


def proofs(
    states: States,
    rows: Callable[[], Rows],
    requested: Collection[str],
    resistance: Resistance,
    curve: ReductionCurve = (),
    permitted_tip: float | None = None,
    critical_factor: float | None = None,
    buckling: Iterable[WallBuckling] = (),
) -> Iterator[Row]:
    """Yield the proofs of states for which the boom has numbers.

    Only those that are requested are computed.

    Args:
        states: states under the loads of a combination.
        rows: function that returns extremes of these states, and wall stresses of a shell.
        requested: kinds of proofs, of :data:`BY_BEAMS`; ``yield`` and ``plate`` include those by a
            shell.
        resistance: factors on resistances.
        curve: reduction factors of plates.
        permitted_tip: permitted tip deflection in m; None without a limit.
        critical_factor: buckling factor of the axial forces; None if it is unknown.
        buckling: buckling of the segments of a shell.
    """
    kinds = {*requested}
    if kinds & {"yield", "plate"}:
        yield from _of_plates(states, kinds, resistance, curve)
    if "yield" in kinds:
        yield from _of_walls(rows(), resistance)
    if "plate" in kinds:
        yield from _of_shells(states, resistance, curve, buckling)
    if kinds & {"pad", "cylinder", "pin"}:
        yield from (row for row in _of_forces(states, rows(), resistance) if row.quantity in kinds)
    if "column" in kinds:
        yield from _of_column(states, resistance, critical_factor)
    if "deflection" in kinds and permitted_tip is not None:
        (tip,) = rows().where(quantity="tip")
        yield _proof("deflection", "tip", "", tip.value, permitted_tip)


def governing(proved: Iterable[Row]) -> Rows:
    """Return the governing proof of each part of the boom, that with the largest utilisation first.

    The plates of a segment are one part, and so are the pads of a station.
    """
    found: dict[tuple[str, str, str], Row] = {}
    for row in proved:
        key = row.quantity, row.part, row.place.rpartition(", ")[0]
        other = found.setdefault(key, row)
        # Plates that mirror each other are equal; the first one counts.
        if (row.utilisation or 0.0) > (1.0 + _EQUAL) * (other.utilisation or 0.0):
            found[key] = row
    return Rows(sorted(found.values(), key=lambda row: -(row.utilisation or 0.0)))


def _proof(
    kind: str, part: str, place: str, effect: float, limit: float, x: float | None = None
) -> Row:
    return Row("", "", True, kind, part, place, abs(effect), x, limit=limit)


def _of_plates(
    states: States, kinds: Collection[str], resistance: Resistance, curve: ReductionCurve
) -> Iterator[Row]:
    """Yield the proofs of strength and buckling of each plate by section forces."""
    for found in plate_stresses(states):
        strengths = found.strengths
        proved = []
        if "yield" in kinds:
            axial = np.abs(found.fibres).max(axis=0)
            equivalent = np.sqrt(axial**2 + 3.0 * found.shear**2)
            proved.append(("yield", equivalent, resistance.material))
        if "plate" in kinds:
            proved.append(("plate", reduced_stress(found, curve), resistance.stability))
        for k, (plate, strength) in enumerate(zip(found.plates, strengths.ravel(), strict=True)):
            for kind, stresses, factor in proved if np.isfinite(strength) else ():
                stress = stresses[k]
                step, at = np.unravel_index(int(stress.argmax()), stress.shape)
                where, limit = (found.segment.name, plate.name), float(strength) / factor
                yield _proof(kind, *where, float(stress[step, at]), limit, float(found.x[at]))


def most_slender_plate(states: Iterable[States]) -> tuple[float, str, str] | None:
    """Return the largest slenderness λ̄ of a plate, and the names of its segment and itself.

    None if no plate has a yield strength.
    """
    slender = (
        (float(slenderness.max()), found.segment.name, plate.name)
        for each in states
        for found in plate_stresses(each)
        for plate, slenderness in zip(found.plates, relative_slenderness(found), strict=True)
        if np.isfinite(slenderness).all()
    )
    return max(slender, key=lambda row: row[0], default=None)


def _of_walls(rows: Rows, resistance: Resistance) -> Iterator[Row]:
    """Yield the proofs of strength by the wall stresses of a shell."""
    for row in rows.where(quantity="wall_stress"):
        if row.limit is not None:
            limit = row.limit / resistance.material
            yield _proof("patch", row.part, "", row.value, limit, row.x)


def _of_shells(
    states: States,
    resistance: Resistance,
    curve: ReductionCurve,
    buckling: Iterable[WallBuckling],
) -> Iterator[Row]:
    """Yield the proofs of stability by the buckling factors of the segments of a shell."""
    for result in buckling:
        plates = [found for found in plate_stresses(states) if found.segment.name == result.segment]
        strength = plates[0].segment.yield_strength if plates else None
        if strength is None or not result.factors:
            continue
        stress = max(
            float(np.hypot(np.abs(found.edges).max(axis=0), np.sqrt(3.0) * found.shear).max())
            for found in plates
        )
        slenderness = float(np.sqrt(strength / (stress * result.factors[0])))
        reduction = float(min(reduction_factors(slenderness, 1.0, curve)))
        limit = reduction * strength / resistance.stability
        yield _proof("buckling", result.segment, result.walls[0], stress, limit, result.x[0])


def _of_forces(states: States, rows: Rows, resistance: Resistance) -> Iterator[Row]:
    """Yield the proofs of pads, cylinders and pins."""
    for row in rows.where(quantity="pad_pressure"):
        if row.limit is not None and row.value:
            limit = row.limit / resistance.pad
            yield _proof("pad", row.part, row.place, row.value, limit, row.x)
    # Of two cylinders side by side, one carries more.
    pairs = {row.part: row for row in rows.where(quantity="larger_cylinder_force")}
    forces = rows.where(quantity="cylinder_force")
    for force, cylinder in zip(forces, states.boom.cylinders, strict=True):
        row = pairs.get(force.part, force)
        if row.limit is not None:
            yield _proof("cylinder", row.part, "", row.value, row.limit / resistance.cylinder)
        if cylinder.pin is not None:
            limit = cylinder.pin.resistance / resistance.pin
            yield _proof("pin", row.part, "lug", row.value, limit, cylinder.x)
    feet = {segment.name: segment.foot for segment in states.boom.segments}
    for row in rows.where(quantity="foot_reaction"):
        foot = feet[row.part]
        if foot is not None and foot.pin is not None:
            limit = foot.pin.resistance / resistance.pin
            yield _proof("pin", f"foot, {row.part}", "", row.value, limit, foot.x)


def _of_column(states: States, resistance: Resistance, factor: float | None) -> Iterator[Row]:
    """Yield the proof of column buckling by the buckling factor of the axial forces."""
    normal = min(
        float(states.section_forces(number)["normal"].min())
        for number in range(len(states.boom.segments))
    )
    if factor is not None and np.isfinite(factor) and normal < 0.0:
        yield _proof("column", "boom", "", normal, -normal * factor / resistance.stability)

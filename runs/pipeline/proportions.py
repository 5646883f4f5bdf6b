# SPDX-License-Identifier: LGPL-3.0-or-later
"""What of a case or a boom is out of proportion: slips of the unit or of the sign, most often."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dynamics.equilibrium import equilibrium
from dynamics.excitation import Thrown
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem
from geometry.boom import Boom
from geometry.load import Load
from geometry.segment import Segment
from runs.case.actions import STANDARD_GRAVITY
from runs.case.build import contact_laws
from runs.case.schema import Case

# Of the solids that booms are made of, from plastics to tungsten, with room on either side.
MODULI = 1.0e9, 1.0e12
DENSITIES = 500.0, 2.5e4

# Height over length of a segment above which it is no beam.
DEEP = 0.2

# Of the boom's weight: loads below it are not felt, loads beyond it no boom carries.
LIGHT, HEAVY = 1.0e-3, 1.0e2

# Of the boom's weight: loads upwards beyond it are weights of the wrong sign.
LIFTING = 0.3

# Part of the critical force above which the second order is no small correction.
CLOSE = 1.0 / 3.0

# Part of the boom's length beyond which a static tip is no small deflection.
FAR = 0.05


def slips(case: Case, boom: Boom) -> list[str]:
    """What to look at again, a line each."""
    found = [*_materials(boom), *_sections(boom), *_loads(case, boom), *_pads(case, boom)]
    return [f"caution: {line}" for line in [*found, *_meshes(case, boom)]]


def _materials(boom: Boom) -> Iterator[str]:
    told = set()
    for segment in boom.segments:
        for what, value, unit, (low, high) in (
            ("Young's modulus", segment.material.youngs_modulus, "Pa", MODULI),
            ("density", segment.material.density, "kg/m^3", DENSITIES),
        ):
            if not low <= value <= high and (what, value) not in told:
                told.add((what, value))
                yield (
                    f"the {what} of {segment.name!r}, {value:g} {unit}, is outside what solids "
                    f"have, {low:g} to {high:g} {unit}; check the units"
                )


def _sections(boom: Boom) -> Iterator[str]:
    for segment in boom.segments:
        if segment.section is None:
            continue
        height = max(segment.section_at(x).size("z") for x in segment.ends)
        if height > DEEP * segment.length:
            yield (
                f"the section of {segment.name!r} is {height:g} m high, more than a fifth of its "
                f"length of {segment.length:g} m: no beam, or another unit"
            )


def _weight(segment: Segment) -> float:
    """In N, with what the segment carries."""
    return STANDARD_GRAVITY * segment.mass


def _loads(case: Case, boom: Boom) -> Iterator[str]:
    weight = sum(map(_weight, boom.segments))
    added = [load for load in boom.loads if load.direction == "z" and not _thrown(load)]
    forces = [segment.load * segment.length for segment in boom.segments]
    forces += [load.resultant(boom.segments[load.segment].length) for load in added]
    payload = case.payload
    if payload is not None and STANDARD_GRAVITY * payload.mass < LIGHT * weight:
        yield (
            f"the payload of {payload.mass:g} kg is less than a thousandth of the boom's "
            f"{weight / STANDARD_GRAVITY:.4g} kg; check the units"
        )
    largest = max(map(abs, forces))
    if largest > HEAVY * weight:
        yield (
            f"a load of {largest:.4g} N is more than a hundred times the boom's weight of "
            f"{weight:.4g} N; check the units"
        )
    if min(forces) >= 0.0 and sum(forces) > LIFTING * weight:
        yield (
            f"all loads pull upwards, by {sum(forces):.4g} N; those that pull down, as weights do, "
            "are negative"
        )


def _thrown(load: Load) -> bool:
    """Whether it is but the impulse of an initial velocity."""
    return isinstance(load.history, Thrown)


def _pads(case: Case, boom: Boom) -> Iterator[str]:
    """A contact that gives way more than the inner segment bends is none."""
    for model in (model for model in case.models if not model.play_free):
        for number, law in enumerate(contact_laws(case, model)):
            joint = boom.joints[number]
            inner = boom.segments[joint.inner]
            bending = 3.0 * inner.bending_stiffness / inner.length**3
            force = 0.5 * _weight(inner)
            stiffness = law.slope_at(force)
            if stiffness < bending:
                yield (
                    f"the contacts of {inner.name!r} in {model.name!r} give way by "
                    f"{1.0 / stiffness:.3g} m/N, more than the segment itself as a cantilever, "
                    f"{1.0 / bending:.3g} m/N; check their stiffness"
                )


def _meshes(case: Case, boom: Boom) -> Iterator[str]:
    narrowest = min((_narrowest(segment) for segment in boom.segments), default=np.inf)
    for model in case.models:
        edge = model.longest_edge
        if edge > narrowest:
            yield (
                f"the mesh size of {model.name!r}, {edge:g} m, is larger than a wall of "
                f"{narrowest:.3g} m"
            )


def _narrowest(segment: Segment) -> float:
    """Width of its narrowest wall in m; infinite where the section is not known."""
    if segment.section is None:
        return np.inf
    ends = (segment.section_at(x) for x in segment.ends)
    return min(plate.length for section in ends for plate in section.plates)


def static_tip(system: GapSystem) -> float:
    """The tip's deflection in m at rest under the constant loads; NaN where there is no such rest.

    Args:
        system: all that stays constant from t = 0 on is in its ``load``.
    """
    try:
        return float(system.observers["tip"].row @ equilibrium(system, system.load))
    except NumericsError:
        return float("nan")


def of_buckling(name: str, critical_factor: float | None) -> list[str]:
    """A caution against a model's axial forces, if they deserve one.

    Args:
        name: of the model.
        critical_factor: of its axial forces, None where it is not known or there are none.
    """
    if critical_factor is None or critical_factor * CLOSE >= 1.0:
        return []
    return [
        f"caution: in {name} the axial forces are {100.0 / critical_factor:.3g} % of those under "
        "which the boom buckles, more than a third: deflections grow out of proportion"
    ]


def of_tip(where: str, tip: float | None, boom: Boom) -> list[str]:
    """A caution against a deflection at rest, if it deserves one.

    Args:
        where: ``in MODEL``, say.
        tip: in m, NaN or None where there is no rest.
        boom: from whose first end to its tip is its length.
    """
    if tip is None or not abs(tip) > FAR * boom.length:
        return []
    return [
        f"caution: {where} the tip rests at {tip:.3g} m, {100.0 * abs(tip) / boom.length:.2g} % of "
        "the boom's length and more than 5 %: small displacements do not hold; check units and "
        "loads"
    ]

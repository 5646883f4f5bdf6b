# SPDX-License-Identifier: LGPL-3.0-or-later
"""What of a case or a boom is out of proportion: slips of the unit or of the sign, most often."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dynamics.equilibrium import equilibrium
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem
from geometry.boom import Boom
from geometry.segment import Segment
from runs.case.actions import STANDARD_GRAVITY
from runs.case.build import contact_laws
from runs.case.schema import Case
from runs.case.usual import usual_numbers
from runs.pipeline.load_slips import load_slips

# Degrees up to which a boom may well be called level.
LEVEL = 0.1

# Part of the critical force above which the second order is no small correction.
CLOSE = 1.0 / 3.0

# Part of the boom's length beyond which a static tip is no small deflection.
FAR = 0.05


def slips(case: Case, boom: Boom) -> list[str]:
    """What to look at again, a line each."""
    unusual = (one for one in usual_numbers(case, boom) if one.unusual)
    found = [f"{one.key}: {one.said(case.system)}" for one in unusual]
    found += [*load_slips(case, boom), *_in_vain(case), *_pads(case, boom), *_meshes(case, boom)]
    return [f"caution: {line}" for line in found]


def _in_vain(case: Case) -> Iterator[str]:
    """What does nothing, or hardly what is meant."""
    duration = case.time.duration
    ramps = [(f"load[{i}].ramp", load.ramp) for i, load in enumerate(case.loads, start=1)]
    ramps += [(f"base[{i}].ramp", base.ramp) for i, base in enumerate(case.base, start=1)]
    for key, ramp in ramps:
        if ramp is not None and ramp > duration:
            yield (
                f"{key}: the run of {duration:g} s ends at {100.0 * duration / ramp:.3g} % of the "
                f"ramp of {ramp:g} s; usual is a ramp that ends within the run"
            )
    for number, joint in enumerate(case.joints, start=1):
        if any(joint.normal_forces) and "friction" not in joint.model_fields_set:
            yield (
                f"joint[{number}].normal_forces: they press for a friction that is not given, and "
                "do nothing; give friction, usual is 0.05 to 0.3, or leave them out"
            )
    angle = 0.0 if case.gravity is None else case.gravity.angle
    if LEVEL < abs(angle) <= 0.5 * np.pi:
        yield (
            f"gravity.angle: {angle:g} degrees is nearly level; if it is in radians, give "
            f"{np.rad2deg(angle):.4g}"
        )
    for number, cylinder in enumerate(case.cylinders, start=1):
        if (height := cylinder.ground[1]) > -cylinder.depth:
            yield (
                f"cylinder[{number}].ground: a height of {height:g} m is above the lug, and the "
                "cylinder would pull; usual is below, where heights are negative"
            )


def _pads(case: Case, boom: Boom) -> Iterator[str]:
    """A contact that gives way more than the inner segment bends is none."""
    for model in (model for model in case.models if not model.play_free):
        for number, law in enumerate(contact_laws(case, model)):
            joint = boom.joints[number]
            inner = boom.segments[joint.inner]
            bending = 3.0 * inner.bending_stiffness / inner.length**3
            force = 0.5 * STANDARD_GRAVITY * inner.mass
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


def of_period(where: str, frequency: float, case: Case) -> list[str]:
    """A caution against a run that ends before the boom has swung once.

    Args:
        where: ``in MODEL``, say.
        frequency: the first one in Hz, with the joints pressed.
        case: that says how long it runs.
    """
    if case.time.duration * frequency >= 1.0:
        return []
    return [
        f"caution: time.duration: the run of {case.time.duration:g} s is shorter than one swing "
        f"{where}, {1.0 / frequency:.3g} s; usual are three swings at least"
    ]


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

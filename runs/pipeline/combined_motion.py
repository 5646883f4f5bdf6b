# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of a combination or a load case by beam elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dynamics.gap_system import GapSystem
from dynamics.line import Line
from geometry.arrays import Array
from geometry.boom import Boom
from runs.case.build import build_boom
from runs.case.kinds.finite_element import BeamElements
from runs.case.schema import Case
from runs.pipeline.largest_loads import StaticBeam
from runs.pipeline.models import MotionPlan, build_on
from runs.pipeline.section_forces import section_forces, with_cylinder_forces
from runs.pipeline.static_results import static_result
from runs.pipeline.strength import Fibres


class BeamMotion(NamedTuple):
    """Motion of a boom of beam elements.

    Args:
        boom: the boom with the contacts of its model, without drives.
        system: system of the model.
        lines: lines along the segments, with the forces of cylinders.
        time: (num_times,) in s.
        positions: modal coordinates (num_times, num_modes).
    """

    boom: Boom
    system: GapSystem
    lines: Sequence[Line]
    time: Array
    positions: Array


def beam_motion(case: Case) -> BeamMotion:
    """Return the motion of the first model of beam elements with play, or of Timoshenko elements.

    Args:
        case: case of a combination.

    Raises:
        NumericsError: the motion cannot be computed.
    """
    beams = [one for one in case.models if isinstance(one, BeamElements) and not one.bonded]
    model = beams[0] if beams else BeamElements(name="beam")
    joints = tuple(replace(joint, drive=None) for joint in case.joints)
    case = case.model_copy(update={"joints": joints, "ensemble": None, "models": (model,)})
    joined = model.model_boom(build_boom(case))
    boom, built = joined.boom, build_on(joined, case, model)
    system = built.system.gather_loads()
    lines = with_cylinder_forces(boom, system, model.lines(boom, built))
    trajectory = MotionPlan.of(built.system, case, model).trajectory()
    return BeamMotion(boom, system, lines, trajectory.time, trajectory.states)


def beam_in_motion(case: Case) -> StaticBeam:
    """Return a moving beam at the instants at which a result is extreme.

    The results are tip, contacts, cylinders and fibre stresses.

    Args:
        case: case of a combination.

    Raises:
        NumericsError: the motion cannot be computed.
    """
    boom, system, lines, time, states = beam_motion(case)
    rows = [system.rows, *(one.row[None] for one in system.observers.values())]
    curves = [states @ np.vstack(rows).T]
    for number, (segment, line) in enumerate(zip(boom.segments, lines, strict=True)):
        if (fibres := Fibres.of(segment, line)) is not None:
            forces = section_forces(boom, number, line, states, time)
            stresses = (fibres.stress(fibre, forces) for fibre in range(len(fibres.z)))
            curves += [np.abs(one).max(axis=1, keepdims=True) for one in stresses]
    every = np.hstack(curves)
    steps = np.unique([0, *every.argmax(axis=0), *every.argmin(axis=0)])
    rests = [static_result(boom, system, lines, float(time[k]), states[k]) for k in steps]
    return StaticBeam(boom, lines, states[steps], rests)

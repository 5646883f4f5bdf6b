# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of a combination or a load case by beam elements."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from runs.case.build import build_boom
from runs.case.kinds.finite_element import BeamElements
from runs.case.schema import Case
from runs.pipeline.largest_loads import BeamStates
from runs.pipeline.models import MotionPlan, build_on
from runs.pipeline.section_forces import LoadedModel
from runs.pipeline.strength import fibre_forces


def beam_motion(case: Case) -> BeamStates:
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
    built = build_on(joined, case, model)
    trajectory = MotionPlan.of(built.system, case, model).trajectory()
    loaded = LoadedModel.of(joined.boom, built.system, model.lines(joined.boom, built))
    return BeamStates(loaded, trajectory.time, trajectory.states)


def beam_in_motion(case: Case) -> BeamStates:
    """Return a moving beam at the instants at which a result is extreme.

    The results are tip, contacts, cylinders and fibre stresses.

    Args:
        case: case of a combination.

    Raises:
        NumericsError: the motion cannot be computed.
    """
    motion = beam_motion(case)
    system, time, states = motion.model.system, motion.time, motion.positions
    rows = [system.rows, *(one.row[None] for one in system.observers.values())]
    curves = [states @ np.vstack(rows).T]
    for _, fibres, forces in fibre_forces(motion.model, states, time):
        stresses = (fibres.stress(fibre, forces) for fibre in range(len(fibres.z)))
        curves += [np.abs(one).max(axis=1, keepdims=True) for one in stresses]
    every = np.hstack(curves)
    steps = np.unique([0, *every.argmax(axis=0), *every.argmin(axis=0)])
    return BeamStates(motion.model, time[steps], states[steps]).with_results()

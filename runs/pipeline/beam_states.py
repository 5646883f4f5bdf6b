# SPDX-License-Identifier: LGPL-3.0-or-later
"""Statics of a boom at t = 0 and under its largest loads, and its states in motion.

The model has beam elements and the compliance of walls under pads, at the initial extension.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from protractile.analysis.beams import static_beam
from protractile.analysis.model import AnalysisModel
from protractile.analysis.states import States
from protractile.geometry.boom import Boom
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.models import MotionPlan, build_on, complete_system


def static_states(
    case: Case, boom: Boom, build: Callable[..., AnalysisModel] = static_beam
) -> States:
    """Return the static states of a boom without drives at t = 0 and under extreme loads.

    The boom has the contact laws of the first model with play, or is bonded. ``build`` is
    :func:`.beam_of` for states about which the boom vibrates.

    Raises:
        NumericsError: there is no equilibrium at t = 0.
    """
    boom = boom.without_drives
    model = build(boom, lambda system, lines: complete_system(system, case, boom, lines))
    return States.at_rest(model, case.time.duration)


def moving_states(case: Case) -> States:
    """Return the states of a motion without drives.

    The model is the first one of beam elements with play, or a default beam.

    Raises:
        NumericsError: the motion cannot be computed.
    """
    beams = [one for one in select_kind(BeamElements, case.models) if not one.bonded]
    model = beams[0] if beams else BeamElements(name="beam")
    joints = tuple(replace(joint, drive=None) for joint in case.joints)
    case = case.model_copy(update={"joints": joints, "ensemble": None, "models": (model,)})
    joined = model.model_boom(build_boom(case))
    built = build_on(joined, case, model)
    trajectory = MotionPlan.of(built.system, case, model).trajectory()
    loaded = model.analysis_model(joined.boom, built)
    return States.in_motion(loaded, trajectory)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Study of design results against the lever rule and exact beams."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from mpi4py import MPI

from beam_model.component import SegmentModel
from beam_model.finite_element import finite_element_segments
from beam_model.kantorovich import kantorovich_segments
from beam_model.lines import lines
from beam_model.segment_model import gap_system
from dynamics.integrator import simulate
from geometry.boom import Boom, Segment
from runs import CASES
from runs.case import reading as case_file
from runs.pipeline.context import RunContext
from runs.pipeline.design_results import DesignResults, ModelDesignResults
from runs.pipeline.modes import modes
from runs.pipeline.motion_results import MotionAndStatics, evaluate_motion
from runs.pipeline.run import run_case
from runs.pipeline.section_forces import LoadedModel
from runs.pipeline.static_results import Diagram, positions, static_result
from studies.second_order import BOX, CLAMP, LENGTH, STEEL, STIFFNESS
from studies.study import Criterion, Progress, Verification, define_study

# Distributed loads in N/m on both segments of the paper's boom.
OUTER, INNER = 83.16, 55.07
# Positions in m of the stations, the second support and the tip; play in m; contacts in N/m.
TAIL, HEAD, SUPPORT, TIP, PLAY, STIFF = 9.0, 10.0, 2.0, 19.0, 0.014, 1.0e9
MODELS = ("timoshenko", "shell")
# Places in m between which section forces are compared.
ALONG_OUTER, ALONG_INNER = 5.5, 14.0
# Distributed load in N/m on the cantilever.
LOAD = -100.0

# Elements of half a metre have moments with errors up to q h²/12, here 1.7 N m.
CLOSE, OF_PIECES, EXACT = 1.0e-3, 5.0e-3, 1.0e-6
LEVERS: Criterion = ("analytic", "lever rule", EXACT)


@define_study("design-results", "Design results")
def study(progress: Progress) -> Iterator[Verification]:
    """Compare the paper's boom at rest and a cantilever in motion with closed forms."""
    progress("the paper's boom at rest")
    answers = design_results_at_rest()
    for name in MODELS:
        yield from _at_rest(name, answers.models[name])
    for held, force in zip(answers.reactions, support_forces(), strict=True):
        what = f"reaction at {held.x:g} m"
        yield Verification(what, 1e-3 * held.force, 1e-3 * force, "kN", *LEVERS)
    progress("a cantilever")
    yield from _cantilever()


def design_results_at_rest() -> DesignResults:
    """Return the design results of the paper's boom from a very short run."""
    case = case_file.load(str(CASES / "coarse.toml"))
    time = case.time.model_copy(update={"duration": 0.01})
    models = tuple(model for model in case.models if model.name in MODELS)
    short = case.model_copy(update={"models": models, "time": time})
    run = run_case(short, "coarse.toml", RunContext(MPI.COMM_SELF))
    assert run is not None
    run.evaluate()
    return run.results.summary.design


def station_forces() -> tuple[float, float]:
    """Return the contact forces at tail and head in N by the lever rule.

    They act on the outer segment; positive forces act upwards.
    """
    load = INNER * (TIP - TAIL)
    head = load * (0.5 * (TIP + TAIL) - TAIL) / (HEAD - TAIL)
    return load - head, head


def support_forces() -> tuple[float, float]:
    """Return the forces in N at both supports of the outer segment; upward forces are positive."""
    tail, head = station_forces()
    far = -(0.5 * OUTER * HEAD**2 + tail * TAIL + head * HEAD) / SUPPORT
    return -OUTER * HEAD - tail - head - far, far


def _at_rest(name: str, own: ModelDesignResults) -> Iterator[Verification]:
    (rest,) = own.static
    tail, head = station_forces()
    tilt = (PLAY + (abs(tail) + head) / STIFF) / (HEAD - TAIL)
    criterion: Criterion = (
        "analytic",
        "2 Δ and the compression of contacts, over the overlap",
        CLOSE,
    )
    turned = 1e3 * rest.tilts[0].rotation
    yield Verification(f"tilt of the joint, {name}", turned, 1e3 * tilt, "mrad", *criterion)
    for pressed, force in zip(rest.stations, (tail, head), strict=True):
        what = f"contact force at {pressed.x:g} m, {name}"
        yield Verification(what, 1e-3 * pressed.force, 1e-3 * force, "kN", *LEVERS)
    at_foot, far = support_forces()
    x, s = ALONG_OUTER, TIP - ALONG_INNER
    outer, inner = rest.diagrams
    bent = -(at_foot * x + far * (x - SUPPORT) + 0.5 * OUTER * x**2)
    for diagram, place, what, unit, force in (
        (outer, x, "shear", "kN", -(at_foot + far + OUTER * x)),
        (outer, x, "moment", "kN m", bent),
        (inner, ALONG_INNER, "shear", "kN", INNER * s),
        (inner, ALONG_INNER, "moment", "kN m", -0.5 * INNER * s**2),
    ):
        found, named = 1e-3 * value_at(diagram, what, place), f"{what} at {place:g} m, {name}"
        yield Verification(named, found, 1e-3 * force, unit, "analytic", "by hand", OF_PIECES)


def value_at(diagram: Diagram, what: str, place: float) -> float:
    """Return the value of a curve at x in m."""
    return float(np.interp(place, diagram.x, diagram.curves[what]))


def _cantilever() -> Iterator[Verification]:
    """Compare a cantilever with closed forms: modes, static stress, and vibration of one mode."""
    arm = Segment.of_section("arm", 0.0, LENGTH, STEEL, BOX, supports=(CLAMP,), load=LOAD)
    boom = Boom((arm,), ())
    elements = finite_element_segments(boom, 0.2, "euler-bernoulli", rotary_inertia=False)
    own = suddenly_loaded_results(boom, elements)
    rate = np.sqrt(STIFFNESS / arm.mass_per_length) / (2.0 * np.pi * LENGTH**2)
    for number, root in ((1, 1.875104068711961), (2, 4.694091132974175)):
        mode = next(one for one in own.modes if one.number == number)
        what = f"cantilever, {mode.motion}, mode {number}"
        yield Verification(
            what, mode.frequency, root**2 * rate, "Hz", "analytic", "Blevins 1979", CLOSE
        )
    assert own.motion is not None
    moment = 0.5 * abs(LOAD) * LENGTH**2
    stress = moment * 0.5 * (BOX.height + BOX.flange) / BOX.second_moment_of_area
    (fibre,) = own.motion.fibres
    assert fibre.at_rest is not None
    criterion: Criterion = ("analytic", "M c/J, Navier 1826", CLOSE)
    yield Verification(
        "outer fibre of it at rest", 1e-6 * fibre.at_rest, 1e-6 * stress, "MPa", *criterion
    )
    single = suddenly_loaded_results(
        boom, kantorovich_segments(boom, [1], "complete", rotary_inertia=False)
    )
    assert single.motion is not None
    for peak in single.motion.peaks:
        assert peak.factor is not None
        what = f"dynamic factor of its {peak.what}, one coordinate, loaded suddenly"
        yield Verification(what, peak.factor, 2.0, "", "analytic", "1 − cos ωt", CLOSE)


def suddenly_loaded_results(boom: Boom, segments: list[SegmentModel]) -> ModelDesignResults:
    """Return the design results of half a second of a single segment under a sudden load."""
    system, along = gap_system(boom.bonded, segments), lines(boom, segments)
    rest = positions(system)[0.0]
    model = LoadedModel.of(boom, system, along)
    static = [static_result(model, 0.0, rest)]
    motion = simulate(system, duration=0.5)
    motions = MotionAndStatics(model, motion, rest[None], static, jumps=False)
    moved, _ = evaluate_motion(motions)
    return ModelDesignResults(static=static, modes=modes(model, rest), motion=moved)

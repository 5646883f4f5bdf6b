# SPDX-License-Identifier: LGPL-3.0-or-later
"""Partial loads and moments in every kind of model."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from runs.case.build import build_boom
from runs.case.kinds.model import BuildContext
from runs.case.schema import Case
from runs.pipeline.models import build
from studies.reference_models.statics import static_response
from tests.runs.case_texts import read_case, refusal
from tests.runs.test_actions import BENDING, CANTILEVER, ELEMENTS

PART = '[[load]]\nsegment = "beam"\nfrom = 3.0\nto = 7.0\nmagnitude = -500.0\n'
MOMENT = '[[load]]\nsegment = "beam"\nx = 6.0\nmagnitude = 2.0e4\nmoment = true\n'
SERIES = '[[model]]\nname = "series"\nkind = "kantorovich"\nterms = [6]\nbase = "complete"\n'
SHELL = '[[model]]\nname = "shell"\nkind = "shell"\nmesh_size = 0.1\ncontact_tolerance = "any"\n'
BOX = "section = { height = 0.47, width = 0.41, flange = 0.006, web = 0.006 }\n"


def tip_at_rest(case: Case) -> float:
    """Return the tip deflection in m under all loads at the value 1 of their histories."""
    tools = BuildContext(MPI.COMM_SELF)
    system = build(case, build_boom(case), case.models[0], tools).system
    load = system.load + np.sum([x.load for x in system.excitations], axis=0)
    return float(system.observers["tip"].row @ static_response(system, load))


def under_part(bending: float) -> float:
    """Return the tip of a cantilever, −q ∫ x² (3 L − x)/6 dx from 3 to 7 m over E J."""
    antiderivative = [10.0 * x**3 / 6.0 - x**4 / 24.0 for x in (3.0, 7.0)]
    return -500.0 * (antiderivative[1] - antiderivative[0]) / bending


def under_moment(bending: float) -> float:
    """Return the tip of a cantilever, M a (L − a/2)/E J."""
    return 2.0e4 * 6.0 * (10.0 - 3.0) / bending


@pytest.mark.parametrize("model", [ELEMENTS, SERIES], ids=["elements", "series"])
@pytest.mark.parametrize(("load", "expected"), [(PART, under_part), (MOMENT, under_moment)])
def test_beams_have_the_deflections_of_statics(
    tmp_path: Path, load: str, expected: Callable[[float], float], model: str
) -> None:
    """Reference: analytic. Elements and series contain the influence line of the tip, a cubic."""
    found = tip_at_rest(read_case(tmp_path, CANTILEVER + load + model))
    assert found == pytest.approx(expected(BENDING), rel=1e-9)


@pytest.mark.parametrize(("load", "expected"), [(PART, under_part), (MOMENT, under_moment)])
def test_a_shell_rests_near_a_beam_with_shear(
    tmp_path: Path, load: str, expected: Callable[[float], float]
) -> None:
    """Reference: other model, Timoshenko elements. The mesh has an error of 0.5 %."""
    beam = CANTILEVER.replace("mass_per_length = 83.16\n", BOX).replace(
        "second_moment_of_area = 3.7986e-4\n", ""
    )
    elements = ELEMENTS.replace("euler-bernoulli", "timoshenko")
    beams = tip_at_rest(read_case(tmp_path, beam + load + elements))
    shell = tip_at_rest(read_case(tmp_path, beam + load + SHELL))
    assert shell == pytest.approx(beams, rel=5e-3)


@pytest.mark.parametrize(
    ("load", "message"),
    [
        (MOMENT.replace("x = 6.0\n", ""), "x: missing; it is the x in m at which the moment acts"),
        (PART.replace("to = 7.0", "to = 2.0"), "to: must be beyond from, 3 m, got 2 m"),
        (PART.replace("from = 3.0", "x = 3.0"), "to: x is given; leave one of them out"),
    ],
)  # fmt: skip
def test_bad_loads_are_refused(tmp_path: Path, load: str, message: str) -> None:
    assert refusal(tmp_path, CANTILEVER + load + ELEMENTS) == f"load[1].{message}"

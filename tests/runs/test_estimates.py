# SPDX-License-Identifier: LGPL-3.0-or-later
"""Estimates of memory and time, and refusal of large runs."""

import os
import re
from pathlib import Path
from time import process_time

import pytest

from protractile.runs.case import reading as case_file
from protractile.runs.case.reading import CheckedCase
from protractile.runs.check import check_case
from protractile.runs.pipeline.estimates import (
    Cost,
    Preview,
    models_cost,
    refuse_large,
    run_cost,
    states_cost,
    sweep_cost,
)
from protractile.runs.process.bad_input import BadInput
from tests.runs.case_texts import COARSE, edited, long_boom, read_case, refused, shipped, table
from tests.system.run_folder import protractile, python

PROGRAM = """
import sys
from pathlib import Path
from protractile.runs.cli import main
from protractile.runs.report import figures
figures.FIGURES = figures.FIGURES[-2:]
try:
    # Pictures are drawn by other processes.
    main([*sys.argv[1:], "--no-pictures"])
except SystemExit as end:
    assert not end.code
# Its own: what getrusage tells begins with the process that started this one.
(most,) = (x for x in Path("/proc/self/status").read_text().splitlines() if x.startswith("VmHWM"))
print(1024 * int(most.split()[1]))
"""

pytestmark = pytest.mark.usefixtures("here")


@pytest.mark.slow
def test_memory_is_not_above_the_estimate_and_not_far_below() -> None:
    """Reference: external, the operating system. Compilation needs three times as much."""
    edits = ("mesh_size = 0.25", "mesh_size = 0.1"), ("duration = 0.6", "duration = 0.01")
    case = read_case(Path(), edited(COARSE, *edits))
    told = run_cost(case_file.select(case, "", ["shell"])).memory
    command = "run", "case.toml", "--out", "out", "--models", "shell"
    for _ in range(2):
        used = int(python("-c", PROGRAM, *command, folder=Path()).stdout.split()[-1])
        if used <= told:  # else it had to compile; a later run has not
            break
    assert used <= told <= 4.0 * used


@pytest.mark.parametrize(
    ("name", "seconds"),
    [
        ("paper", 111.2), ("three-segments", 42.3), ("lift", 21.6), ("crane-telescopes", 4.4),
    ],
)  # fmt: skip
def test_times_are_within_a_factor_of_two(name: str, seconds: float) -> None:
    """Reference: external, wall times of all models on two idle cores, in ``summary.json``."""
    case = shipped(name)
    assert 0.5 * seconds <= models_cost(Preview(CheckedCase(case))).seconds <= 2.0 * seconds


def test_short_times_are_in_seconds() -> None:
    for seconds, text in ((3.4, "3 s"), (46.0, "50 s"), (95.0, "2 min"), (6000.0, "1.67 h")):
        assert str(Cost(2.0e9, seconds)) == f"2 GB and {text}"
    with pytest.raises(BadInput):
        refuse_large(Cost(float("nan"), 0.0), "case.toml")


@pytest.mark.parametrize(
    ("edit", "told"),
    [
        (("output_step = 1e-3", "output_step = 1e-7"), "83 GB and 30 min"),
        (("mesh_size = 0.25", "mesh_size = 0.015"), "9.1 GB and 3 min"),
        (("element_length = 0.5", "element_length = 0.002"), "21 GB and 11.2 h"),
        (("duration = 0.6", "duration = 60.0\nstep = 1e-8"), "2.6 GB and 20.1 h"),
    ],
)
def test_excessive_memory_or_time_is_refused(edit: tuple[str, str], told: str) -> None:
    """Reference: non-regression, measured for a million outputs, degrees of freedom and steps."""
    with refused(
        f"case.toml: --large: missing, and it may take {told}; give it to start anyway, or "
        "ask for fewer outputs, members, points, states or steps, or for coarser meshes"
    ):
        refuse_large(run_cost(read_case(Path(), edited(COARSE, edit))), "case.toml")


def test_frequencies_of_short_elements_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: non-regression, a dense eigenproblem of 22,000 coordinates."""
    read_case(Path(), COARSE)
    vary = "--vary", "model[3].element_length=0.002,0.5"
    assert protractile("frequencies", "case.toml", *vary, "--models", "beam-fe") == 2
    line = "case.toml: --large: missing, and it may take 21 GB and 22.3 h; "
    assert capsys.readouterr().err.startswith(f"protractile: {line}")


def test_a_check_of_short_elements_is_soon_done() -> None:
    """Reference: other code path, elements of 0.5 m, within 1 %; 4 mm would take minutes."""
    told = []
    for length in ("0.5", "0.004"):
        text = COARSE.replace("element_length = 0.5", f"element_length = {length}")
        Path("case.toml").write_text(f"{text}\n[damping]\nmass = 0.1\n", encoding="utf-8")
        begin = process_time()
        told.append(repr(check_case(case_file.load_checked("case.toml"))))
    assert process_time() - begin < 20.0
    numbers = [[float(x) for x in re.findall(r"([\d.]+) (?:%|Hz)", text)] for text in told]
    assert len(numbers[0]) > 10
    assert numbers[1] == pytest.approx(numbers[0], rel=1e-2)


def test_a_sweep_takes_the_time_of_its_points(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: analytic, equal points, two at a time."""
    monkeypatch.setattr(os, "cpu_count", lambda: 2)
    points = 100 * [case_file.select(shipped("coarse"), "", ["beam-fe"])]
    one, all_of_them = sweep_cost(points[:1]), sweep_cost(points)
    assert all_of_them.memory == pytest.approx(2.0 * one.memory, rel=1e-9)
    assert all_of_them.seconds == pytest.approx(50.0 * one.seconds, rel=1e-9)


def test_many_combined_states_need_a_confirmation() -> None:
    """Reference: analytic. 100 combinations in 100 load cases are 10,000 states."""
    text = COARSE
    for number in range(100):
        text += table("[[load_case]]", name=f"l{number}")
        text += table("[[combination]]", name=f"c{number}", factors={"dead": 1.0})
    many = read_case(Path(), text)
    cost = states_cost(many, proofs=False)
    assert (str(cost), cost.large) == ("7.3 GB and 4 min", True)
    few = many.model_copy(update={"combinations": many.combinations[:9]})
    assert not states_cost(few, proofs=False).large


@pytest.mark.parametrize(
    ("name", "check", "prove"),
    [
        ("8, 40, 10", 6.84, 8.62), ("2, 30, 10", 2.92, 3.0), ("inspection-arm", 3.44, 3.27),
    ],
)  # fmt: skip
def test_times_of_states_are_within_a_factor_of_two(name: str, check: float, prove: float) -> None:
    """Reference: external, processor times in s of `check` and `prove`."""
    numbers = [int(part) for part in name.split(",") if part.strip().isdigit()]
    case = read_case(Path(), long_boom(*numbers)) if numbers else shipped(name)
    for proofs, taken in ((False, check), (True, prove)):
        assert 0.5 * taken <= states_cost(case, proofs).seconds <= 2.0 * taken

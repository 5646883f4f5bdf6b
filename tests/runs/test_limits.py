# SPDX-License-Identifier: LGPL-3.0-or-later
"""Limits of a case in tables, figures and sweeps, and in the exit status."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure as Sheet

from protractile.cases import run_case
from runs.case import reading
from runs.case.checked_case import CheckedCase
from runs.case.schema import Case
from runs.check import check_case
from runs.pipeline.quantities import case_limits, check_limits, decay_time, measure
from runs.report.summary_table import limit_faults, limit_table
from runs.sweep import output
from runs.sweep.points import plan
from tests.runs.cantilever import CANTILEVER, LENGTH, LOAD, MASS, SECOND, YOUNG, static_tip
from tests.runs.summaries import printed
from tests.runs.sweeping import run
from tests.system.run_folder import protractile

pytestmark = pytest.mark.usefixtures("here")


def write(limits: str, text: str = CANTILEVER) -> str:
    Path("case.toml").write_text(text + f"\n[limits]\n{limits}\n", encoding="utf-8")
    return "case.toml"


def test_limits_decide_by_the_numbers_of_a_run() -> None:
    """Reference: analytic, q L⁴/(8 E J) and f = 1.8751² √(E J/m)/(2π L²) of a cantilever."""
    tip = static_tip()
    case = reading.load(write(f"tip_at_rest = {1.001 * tip}\nfirst_frequency = 3.4\ntip = {tip}"))
    results = run_case(case)
    checks = {check.limit.quantity.name: check for check in check_limits(results)}
    # A load that is suddenly there deflects twice as far.
    held = {name: check.holds for name, check in checks.items()}
    assert held == {"tip_at_rest": True, "tip": False, "first_frequency": True}
    assert checks["tip_at_rest"].values["beam"] == pytest.approx(tip, rel=1e-6)
    frequency = 1.875104**2 * np.sqrt(2.0e5 / 20.0) / (2.0 * np.pi * 16.0)
    assert checks["first_frequency"].values["beam"] == pytest.approx(frequency, rel=1e-4)
    assert measure(results, "beam")["decay_time"] == pytest.approx(
        np.log(10.0) / (0.02 * 2.0 * np.pi * frequency), rel=1e-4
    )
    table = limit_table(results)
    assert [row[1] for row in table.rows] == ["✓", "✗", "✓"]
    (fault,) = limit_faults(results)
    far = 1e3 * measure(results, "beam")["tip"]
    assert fault == f"limits.tip: {far:.4g} mm in beam; the case demands tip deflection ≤ 16 mm"


def test_limits_are_in_the_units_of_the_case() -> None:
    """Reference: analytic, 900 mm and 160 MPa."""
    text = f'units = "mm-t-s"\n{CANTILEVER}'
    for given, converted in (
        (YOUNG, 2.0e5), (7850.0, 7.85e-9), (LENGTH, 4000.0), (MASS, 2.0e-5), (SECOND, 1.0e6),
        (LOAD, 0.1),
    ):  # fmt: skip
        assert f"= {given}" in text
        text = text.replace(f"= {given}", f"= {converted}")
    case = reading.load(write("tip = 900\nstress = 160.0", text))
    found = {limit.quantity.name: limit.permitted for limit in case_limits(case.limits)}
    assert found == {"tip": 0.9, "stress": 160.0e6}


def test_check_compares_limits_with_the_tip_at_rest() -> None:
    """Reference: analytic, q L⁴/(8 E J) = 16 mm; exact words."""
    loose = reading.load(write("tip_at_rest = 0.02\ntip = 0.02\nfirst_frequency = 3.4"))
    rests = "the static tip deflection (maximum load) is 16 mm"
    assert limit_sentences(loose) == [
        "Limit static tip deflection (maximum load) ≤ 20 mm: met, 16 mm.",
        f"Limit tip deflection ≤ 20 mm: {rests}, and the motion adds to it; a run decides.",
        "Limit first frequency ≥ 3.4 Hz: a run decides.",
    ]
    tight = reading.load(write("tip_at_rest = 0.01\ntip = 0.015"))
    assert limit_sentences(tight) == [
        f"caution: the limit static tip deflection (maximum load) ≤ 10 mm is exceeded: {rests}",
        f"caution: the limit tip deflection ≤ 15 mm is exceeded: {rests}",
    ]


def limit_sentences(case: Case) -> list[str]:
    return [line for line in check_case(CheckedCase(case)).lines if "imit " in line]


@pytest.mark.usefixtures("few_figures")
def test_the_exit_status_is_1_beyond_a_limit(capsys: pytest.CaptureFixture[str]) -> None:
    write("tip = 0.001\npad_pressure = 1e6\ndecay_time = 10.0")
    for command in (["run", "case.toml", "--out", "out"], ["report", "out"]):
        assert protractile(*command) == 1
        out, err = capsys.readouterr()
        first, second = err.splitlines()
        name = command[1]
        assert first.startswith(f"protractile: {name}: limits.tip: ")
        assert second == f"protractile: {name}: limits.pad_pressure: no model has such a result"
        assert "Limits of the case" in out
    assert "Limits of the case" in Path("out/report.html").read_text(encoding="utf-8")
    write("tip = 1.0")
    assert protractile("run", "case.toml", "--out", "out") == 0


def test_a_sweep_draws_and_counts_limits(sheets: list[Sheet]) -> None:
    """Reference: analytic, static tips of q L⁴/(8 E J)."""
    limit = static_tip(4.5)
    planned = plan(write(f"tip_at_rest = {limit}"), ["segment[1].length=4,4.4,4.6,5"], None, None)
    assert all(point.case.limits is None for point in planned.points)
    data = output.write(planned, run(planned), Path("out"))
    assert data["tip_at_rest"].attrs["permitted"] == limit
    shown = f"beam: static tip deflection (maximum load) ≤ {1e3 * limit:.4g} mm at 2 of 4 points"
    assert shown in printed(output.print_ranges, data, planned, width=80).splitlines()
    (axes,) = (axes for axes in sheets[0].axes if "dotted: limit" in axes.get_title(loc="left"))
    line = axes.lines[-1]
    assert np.asarray(line.get_ydata()) == pytest.approx(1e3 * limit)


def test_permitted_values_themselves_are_permitted() -> None:
    (limit,) = case_limits(reading.load(write("first_frequency = 2.0")).limits)
    assert limit.is_met_by(2.0)
    assert not limit.is_met_by(1.99)
    assert not limit.is_met_by(float("nan"))
    assert decay_time(0.0, 2.0) is None

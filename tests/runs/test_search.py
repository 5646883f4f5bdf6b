# SPDX-License-Identifier: LGPL-3.0-or-later
"""Bounds and limits of results, their changes by each number of a case, and their scatter."""

from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

from protractile.cases import change, run_case
from protractile.runs.case import reading, toml
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.reading import CheckedCase, load
from protractile.runs.case.schema import LimitsTable
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import cautions
from protractile.runs.check import check_case
from protractile.runs.pipeline.quantities import decay_time
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.summary_table import limit_faults, limit_table
from protractile.runs.sweep import output, sampling
from protractile.runs.sweep.points import plan, tables_of
from protractile.runs.sweep.sampling import QUANTILES, normal_points
from protractile.runs.sweep.search import rigid_wall_cautions
from protractile.runs.sweep.variation import numbers
from tests.docs.conftest import toml_blocks
from tests.runs.case_texts import CANTILEVER, LOAD, MASS, THIN, edited, shipped, static_tip, table
from tests.runs.summaries import printed, run
from tests.system.run_folder import protractile

sweep = partial(protractile, "sweep", "case.toml")
LENGTHS = "segment[1].length=3:5:3"
ONE = "give one of --vary, --sensitivity and --samples"


@pytest.fixture(autouse=True)
def _folder(here: Path, in_this_process: None) -> None:
    Path("case.toml").write_text(CANTILEVER, encoding="utf-8")


@pytest.mark.slow
@pytest.mark.usefixtures("unprinted")
def test_a_bound_is_bracketed(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: analytic, the length at which q L⁴/(8 E J) is that of 4.321 m."""
    bound = f"tip_at_rest<{static_tip(4.321)}"
    assert sweep("--vary", LENGTHS, "--until", bound, "--out", "out") == 0
    table = pd.read_csv("out/sweep.csv")
    lengths = table["segment[1].length"]
    low = lengths[table["tip_at_rest"] <= static_tip(4.321)].max()
    high = lengths[table["tip_at_rest"] > static_tip(4.321)].min()
    assert low <= 4.321 <= high
    assert high - low <= 1e-3 * high
    assert len(table) == 3 + 8
    told = capsys.readouterr().out
    title = "Bracket of segment[1].length: static tip deflection (maximum load) ≤ "
    bracket = told[told.index(title) :]
    rows = [row.split()[0] for row in bracket.splitlines() if row.strip().endswith(("✓", "✗"))]
    assert rows == [f"{low:.6g}", f"{high:.6g}"]


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ((), f"--vary: missing; {ONE}"),
        (("--vary", LENGTHS, "--sensitivity"), f"--vary: does not go with --sensitivity; {ONE}"),
        (("--vary", LENGTHS, "--until", "tip=0.9"),
         "--until: 'tip=0.9' is not understood; give QUANTITY<NUMBER or QUANTITY>NUMBER"),
        (("--vary", LENGTHS, "--vary", "segment.load=1,2", "--until", "tip<0.9"),
         "--until: 2 keys vary; give one --vary"),
        # At 3 m the tip is 5.0625 mm, whose fourth digit depends on round-off.
        (("--vary", "segment[1].length=4,5", "--until", "tip_at_rest<0.5"),
         "--until: static tip deflection (maximum load) does not pass 500 mm over "
         f"segment[1].length, where it is {1e3 * static_tip(4.0):.4g} mm to "
         f"{1e3 * static_tip(5.0):.4g} mm; give values of segment[1].length around one place "
         "where it does"),
    ],
)  # fmt: skip
def test_a_search_without_an_aim_is_refused(
    arguments: tuple[str, ...], line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Reference: analytic, static tips of lengths of 4 and 5 m."""
    assert sweep(*arguments, "--out", "out") == 2
    assert capsys.readouterr().err == f"protractile: case.toml: {line}\n"


def test_search_with_governing_walls_gives_a_caution() -> None:
    """Reference: exact words. Pads away from the webs on flanges of 2 mm bend these alone."""
    text = toml_blocks("tutorial.md")[0]
    for edits, count in (((), 0), (THIN, 1)):
        Path("case.toml").write_text(edited(text, *edits), encoding="utf-8")
        lines = rigid_wall_cautions(load("case.toml"), "beam")
        assert len(lines) == count
    assert lines[0].endswith(" beam has rigid walls: the bound is unsafe; take a shell")


@pytest.mark.slow
def test_changes_are_those_of_closed_forms(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: analytic, powers of the numbers in q L⁴/(8 E J) and √(E J/m)/L²; q is negative."""
    Path("case.toml").write_text(edited(CANTILEVER, ("load = ", "load = -")), encoding="utf-8")
    assert sweep("--sensitivity", "--out", "out") == 0
    table = pd.read_csv("out/sensitivity.csv", index_col="key")
    powers = {
        "segment[1].length": (4.0, -2.0),
        "segment[1].load": (1.0, 0.0),
        "material.youngs_modulus": (-1.0, 0.5),
        "segment[1].second_moment_of_area": (-1.0, 0.5),
        "segment[1].mass_per_length": (0.0, -0.5),
    }
    for key, of in powers.items():
        for name, power in zip(("tip_at_rest", "first_frequency"), of, strict=True):
            change = 50.0 * (1.01**power - 0.99**power)
            # A longer beam has an element more, which counts 2e-5.
            assert table.loc[key, name] == pytest.approx(change, rel=1e-4, abs=1e-9)
    assert table.index[0] == "segment[1].length"
    assert table.loc["damping.modal", "decay_time"] == pytest.approx(-1.0, rel=2e-4)
    assert "Change of results in % by 1 % of each number: beam" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "keys"),
    [
        ("crane", ["gravity.angle", "cylinder[1].ground[2]"]),
        ("drawn-out", ["segment[1].load", "joint[1].extension"]),
    ],
)
def test_changes_are_those_of_changed_cases(
    name: str, keys: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: other code path, runs of the case with 1 % less and more, if these are valid."""
    case = change(shipped(name), **{"time.duration": 0.05, "time.output_step": 0.01})
    Path("case.toml").write_text(toml.dumps(case), encoding="utf-8")
    chosen = [one for one in numbers(tables_of(case)) if one[0].name in keys]
    monkeypatch.setattr(sampling, "numbers", lambda tables: chosen)
    planned, changed = sampling.plan_changes("case.toml", None, None)
    found = sampling.changes(planned, changed, run(planned))
    (model,) = planned.coordinates["model"]
    base = run_case(case, [model]).measure(model)
    for (place, value), of in zip(chosen, changed, strict=True):
        sides = sorted(of.points if len(of.points) == 2 else [0, *of.points])
        low, high = (
            run_case(change(case, **{place.name: (1.0 + 0.01 * side) * value}), [model]).measure(
                model
            )
            if side
            else base
            for side in sides
        )
        for result in {*sampling.SHOWN} & {*found.columns}:
            difference = (high[result] - low[result]) / (sides[1] - sides[0])
            expected = pytest.approx(difference / abs(base[result]), rel=1e-6, abs=2e-7)
            assert found.loc[place.name, result] == expected, result


@pytest.mark.slow
def test_a_refused_side_is_named(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: analytic, g cos 89.1° of weight with 1 % less; 1 % more is refused. With 1 % less
    the beam would end before its mass; with 1 % more q L⁴/(8 E J) grows,
    and weight along the beam adds 0.6 % of that.
    """
    text = edited(CANTILEVER, ("[[segment]]", "[gravity]\nangle = 90.0\n[[segment]]"),
                  ("load =", "masses = [{ x = 4.0, mass = 1e-6 }]\nload ="))  # fmt: skip
    Path("case.toml").write_text(text, encoding="utf-8")
    assert sweep("--sensitivity", "--out", "out") == 0
    table = pd.read_csv("out/sensitivity.csv", index_col="key")
    weight = MASS * STANDARD_GRAVITY * np.sin(np.deg2rad(0.9))
    assert table.loc["gravity.angle", "tip_at_rest"] == pytest.approx(
        100.0 * weight / LOAD, rel=1e-3
    )
    assert table.loc["segment[1].load", "tip_at_rest"] == pytest.approx(1.0, rel=1e-6)
    longer = 100.0 * (1.01**4 - 1.0)
    assert table.loc["segment[1].length", "tip_at_rest"] == pytest.approx(longer, rel=0.01)
    told = " ".join(capsys.readouterr().out.split())
    for way, other, keys in (
        ("less", "more", "segment[1].length."),
        ("more", "less", "segment[1].masses[1].x and gravity.angle."),
    ):
        assert (
            f"Refused with 1 % {way}, so that the change is that with 1 % {other}: {keys}" in told
        )


SD = 5.0
SCATTERED = CANTILEVER.replace(f"load = {LOAD}", f"load = {{ mean = {LOAD}, sd = {SD} }}")


@pytest.mark.parametrize("dimensions", [1, 3, 12])
def test_points_are_normal(dimensions: int) -> None:
    """Reference: analytic, moments of first and second order exactly; quantiles of a normal."""
    points = normal_points(dimensions, 256)
    np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=1e-14)
    covariance = np.atleast_2d(np.cov(points, rowvar=False))
    np.testing.assert_allclose(covariance, np.eye(dimensions), atol=1e-13)
    found = np.quantile(points, QUANTILES, axis=0, method="hazen")
    np.testing.assert_allclose(found, norm.ppf(QUANTILES)[:, None] + 0.0 * found, atol=0.1)


@pytest.mark.slow
def test_a_linear_result_scatters_like_its_load(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: analytic, the tip q L⁴/(8 E J) of a normally distributed q."""
    Path("case.toml").write_text(SCATTERED, encoding="utf-8")
    assert reading.load("case.toml").segments[0].load == LOAD
    assert sweep("--samples", "32", "--out", "out") == 0
    table = pd.read_csv("out/sampling.csv", index_col="result").loc["tip_at_rest"]
    sd = static_tip() * SD / LOAD
    assert [table["mean"], table["sd"]] == pytest.approx([static_tip(), sd], rel=1e-6)
    for part in QUANTILES:
        expected = static_tip() + sd * norm.ppf(part)
        assert table[str(part)] == pytest.approx(expected, abs=0.08 * sd)
    samples = pd.read_csv("out/samples.csv")
    ratio = samples["tip_at_rest"] / samples["segment[1].load"]
    np.testing.assert_allclose(ratio, static_tip() / LOAD, rtol=1e-6)
    assert "Scatter of results over 32 samples: beam" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("text", "samples", "line"),
    [
        (SCATTERED, "48",
         "--samples: must be a power of 2 above 2 and at most 10000, such as 64, got 48"),
        (CANTILEVER, "64", "--samples: the case has no number with a mean and an sd; give one, for "
         "example { mean = 0.003, sd = 0.0005 }"),
        (SCATTERED.replace(f"sd = {SD}", "sd = 0"), "64",
         "segment[1].load: must have a finite mean and an sd above 0, got 100.0 and 0"),
        (CANTILEVER.replace(f"= {MASS}", f"= {{ mean = {MASS}, sd = 15.0 }}"), "64",
         "--samples: a sample is not valid, segment[1].mass_per_length: must be a"),
    ],
)  # fmt: skip
def test_bad_samples_are_refused(
    text: str, samples: str, line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("case.toml").write_text(text, encoding="utf-8")
    assert sweep("--samples", samples, "--out", "out") == 2
    found = capsys.readouterr().err
    assert found.startswith(f"protractile: case.toml: {line}")
    assert found.count("\n") == 1


def write(limits: str, text: str = CANTILEVER) -> str:
    Path("case.toml").write_text(text + f"\n[limits]\n{limits}\n", encoding="utf-8")
    return "case.toml"


def test_limits_decide_by_the_numbers_of_a_run() -> None:
    """Reference: analytic, q L⁴/(8 E J) and f = 1.8751² √(E J/m)/(2π L²) of a cantilever."""
    tip = static_tip()
    case = reading.load(write(f"tip_at_rest = {1.001 * tip}\nfirst_frequency = 3.4\ntip = {tip}"))
    results = run_case(case)
    checks = {check.limit.quantity.name: check for check in results.check_limits()}
    # A load that is suddenly there deflects twice as far.
    held = {name: check.holds for name, check in checks.items()}
    assert held == {"tip_at_rest": True, "tip": False, "first_frequency": True}
    assert checks["tip_at_rest"].values["beam"] == pytest.approx(tip, rel=1e-6)
    frequency = 1.875104**2 * np.sqrt(2.0e5 / 20.0) / (2.0 * np.pi * 16.0)
    assert checks["first_frequency"].values["beam"] == pytest.approx(frequency, rel=1e-4)
    limit = checks["first_frequency"].limit
    assert [limit.is_met_by(value) for value in (3.4, 3.39, np.nan)] == [True, False, False]
    measured = results.measure("beam")
    dying = np.log(10.0) / (0.02 * 2.0 * np.pi * frequency)
    assert measured["decay_time"] == pytest.approx(dying, rel=1e-4)
    assert decay_time(0.0, 2.0) is None
    assert [row[1] for row in limit_table(results).rows] == ["✓", "✗", "✓"]
    (fault,) = limit_faults(results)
    far = f"{1e3 * measured['tip']:.4g}"
    assert fault == f"limits.tip: {far} mm in beam; the case demands tip deflection ≤ 16 mm"


def test_check_compares_limits_with_the_tip_at_rest() -> None:
    """Reference: analytic, q L⁴/(8 E J) = 16 mm; exact words."""
    rests = "the static tip deflection (maximum load) is 16 mm"
    told = {
        "tip_at_rest = 0.02\ntip = 0.02\nfirst_frequency = 3.4": [
            "Limit static tip deflection (maximum load) ≤ 20 mm: met in this case, 16 mm.",
            f"Limit tip deflection ≤ 20 mm: {rests}, and the motion adds to it; a run decides.",
            "Limit first frequency ≥ 3.4 Hz: a run decides.",
        ],
        "tip_at_rest = 0.01\ntip = 0.015": [
            f"caution: the limit static tip deflection (maximum load) ≤ 10 mm is exceeded: {rests}",
            f"caution: the limit tip deflection ≤ 15 mm is exceeded: {rests}",
        ],
    }
    for limits, lines in told.items():
        checked = check_case(CheckedCase(reading.load(write(limits)))).lines
        assert [line for line in checked if "imit " in line] == lines


def test_check_leaves_the_tip_of_a_boom_that_telescopes_to_a_run() -> None:
    """Reference: by construction; a run takes the static tip at the largest extension, too."""
    case = shipped("crane-telescopes")
    limits = LimitsTable.model_validate({"tip_at_rest": 9.0})
    checked = check_case(CheckedCase(case.model_copy(update={"limits": limits}))).lines
    (line,) = (line for line in checked if line.startswith("Limit "))
    assert line.endswith(" mm at the extension at t = 0; a run decides.")


SERVICE = table("[[load_case]]", name="a") + table(
    "[[combination]]", name="service", factors={"dead": 15.0}, proofs=["deflection"]
)


@pytest.mark.parametrize(
    ("limit", "met", "told"),
    [
        ("0.25", True, "250 mm"),
        ("0.2", False, "200 mm"),
        ("'6.25 %'", True, "250 mm (6.25 % of the length)"),
        ("'5%'", False, "200 mm (5% of the length)"),
    ],
)
def test_views_agree_on_the_limit_of_the_tip_in_combinations(
    limit: str, met: bool, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Reference: analytic, 15 q L⁴/(8 E J) = 240 mm, 6 % of the length; exact words."""
    far = (
        "Under the loads of 'service, a' the tip is at 0.24 m, 6 % of the boom's length: small "
        "displacements make it about 0.4 % too large, and moments about 0.23 %, on the safe side."
    )
    of_limit = f"static tip deflection (maximum load) ≤ {told}"
    case = reading.load(write(f"tip_at_rest = {limit}", CANTILEVER + SERVICE))
    checked = check_case(CheckedCase(case))
    said = (
        f"Limit {of_limit}: met in this case, 16 mm, and in combinations that demand it, 240 mm "
        "at most."
        if met
        else f"caution: the limit {of_limit} is exceeded under the loads of 'service, a': 240 mm"
    )
    assert {said, far} < {*checked.lines}
    mark = "" if met else " ✗"
    ((_, tip, *_),) = checked.deciding[1].rows
    assert tip == f"240 mm*{mark}"
    results = run_case(case)
    assert far in cautions(Context.of_run(results))
    (row,) = limit_table(results).rows
    assert row[1:] == ("✓" if met else "✗", "16 mm", "240 mm")
    fault = f"limits.tip_at_rest: 240 mm in 'service, a'; the case demands {of_limit}"
    assert [*limit_faults(results)] == ([] if met else [fault])
    assert protractile("prove", "case.toml") == 1 - met
    assert f"240 mm*{mark}" in (out := capsys.readouterr().out)
    assert far in (flowing := " ".join(out.split()))
    demanded = told.rstrip(")").rpartition("(")[2]
    note = f"The limit of the static tip deflection, {demanded}, applies to service only"
    assert note in flowing


@pytest.mark.slow
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


@pytest.mark.slow
def test_a_sweep_draws_and_counts_limits(figures: list[Figure]) -> None:
    """Reference: analytic, static tips of q L⁴/(8 E J)."""
    limit = static_tip(4.5)
    planned = plan(write(f"tip_at_rest = {limit}"), ["segment[1].length=4,4.4,4.6,5"], None, None)
    assert all(point.case.limits is None for point in planned.points)
    data = output.write(planned, run(planned), Path("out"))
    assert data["tip_at_rest"].attrs["permitted"] == limit
    shown = f"beam: static tip deflection (maximum load) ≤ {1e3 * limit:.4g} mm at 2 of 4 points"
    assert shown in printed(output.print_ranges, data, planned, width=80).splitlines()
    chart = figures[0].chart
    (number,) = (i for i, title in enumerate(chart.panels) if title.endswith("dotted: limit"))
    *_, line = (curve for curve in chart.curves if curve.panel == number)
    assert line.values == pytest.approx(1e3 * limit)

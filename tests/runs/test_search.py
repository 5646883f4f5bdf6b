# SPDX-License-Identifier: LGPL-3.0-or-later
"""Values of a key at a bound, changes of results by those of each number, and their scatter."""

from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

from runs.case import reading
from runs.case.messages import BadInput
from runs.case.reading import load
from runs.sweep.sampling import QUANTILES, normal_points
from runs.sweep.search import rigid_wall_cautions
from tests.docs.conftest import toml_blocks
from tests.runs.cantilever import CANTILEVER, LOAD, MASS, static_tip
from tests.runs.case_texts import THIN, edited
from tests.system.run_folder import protractile

sweep = partial(protractile, "sweep", "case.toml")
LENGTHS = "segment[1].length=3:5:3"
ONE = "give one of --vary, --sensitivity and --samples"


@pytest.fixture(autouse=True)
def _folder(here: Path, in_this_process: None) -> None:
    Path("case.toml").write_text(CANTILEVER, encoding="utf-8")


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


def test_search_with_governing_walls_gives_a_caution() -> None:
    """Reference: exact words. Pads away from the webs on flanges of 2 mm bend these alone."""
    text = toml_blocks("tutorial.md")[0]
    Path("case.toml").write_text(text, encoding="utf-8")
    assert rigid_wall_cautions(load("case.toml"), "beam") == []
    Path("case.toml").write_text(edited(text, *THIN), encoding="utf-8")
    (caution,) = rigid_wall_cautions(load("case.toml"), "beam")
    assert caution.startswith("caution: walls bend under pads, which moves the tip by ")
    assert caution.endswith(" beam has rigid walls: the bound is unsafe; take a shell")


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        ((), f"--vary: missing; {ONE}"),
        (("--vary", LENGTHS, "--sensitivity"), f"--vary: does not go with --sensitivity; {ONE}"),
        (("--vary", LENGTHS, "--until", "tip=0.9"),
         "--until: 'tip=0.9' is not understood; give QUANTITY<NUMBER or QUANTITY>NUMBER"),
        (("--vary", LENGTHS, "--vary", "segment.load=1,2", "--until", "tip<0.9"),
         "--until: 2 keys vary; give one --vary"),
    ],
)  # fmt: skip
def test_a_search_without_an_aim_is_refused(
    arguments: tuple[str, ...], line: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert sweep(*arguments) == 2
    assert capsys.readouterr().err == f"protractile: case.toml: {line}\n"


def test_a_bound_on_no_side_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: analytic, static tips of lengths of 3 and 5 m."""
    assert sweep("--vary", LENGTHS, "--until", "tip_at_rest<0.5", "--out", "out") == 2
    assert capsys.readouterr().err == (
        "protractile: case.toml: --until: static tip deflection (maximum load) does not pass "
        "500 mm over segment[1].length, "
        f"where it is {1e3 * static_tip(3.0):.4g} mm to {1e3 * static_tip(5.0):.4g} mm; give "
        "values of segment[1].length around one place where it does\n"
    )


def test_changes_are_those_of_closed_forms(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: analytic, powers of the numbers in q L⁴/(8 E J) and √(E J/m)/L²."""
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


SD = 5.0
SPREAD = f"{{ mean = {LOAD}, sd = {SD} }}"
SCATTERED = CANTILEVER.replace(f"load = {LOAD}", f"load = {SPREAD}")


@pytest.mark.parametrize("dimensions", [1, 3, 12])
def test_points_are_normal(dimensions: int) -> None:
    """Reference: analytic, moments of first and second order exactly; quantiles of a normal."""
    points = normal_points(dimensions, 256)
    np.testing.assert_allclose(points.mean(axis=0), 0.0, atol=1e-14)
    covariance = np.atleast_2d(np.cov(points, rowvar=False))
    np.testing.assert_allclose(covariance, np.eye(dimensions), atol=1e-13)
    found = np.quantile(points, QUANTILES, axis=0, method="hazen")
    np.testing.assert_allclose(found, norm.ppf(QUANTILES)[:, None] + 0.0 * found, atol=0.1)


def test_a_linear_result_scatters_like_its_load(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: analytic, the tip q L⁴/(8 E J) of a normally distributed q."""
    Path("case.toml").write_text(SCATTERED, encoding="utf-8")
    assert sweep("--samples", "64", "--out", "out") == 0
    table = pd.read_csv("out/sampling.csv", index_col="result").loc["tip_at_rest"]
    assert table["mean"] == pytest.approx(static_tip(), rel=1e-6)
    sd = static_tip() * SD / LOAD
    assert table["sd"] == pytest.approx(sd, rel=1e-6)
    for part in QUANTILES:
        expected = static_tip() + sd * norm.ppf(part)
        assert table[str(part)] == pytest.approx(expected, abs=0.08 * sd)
    samples = pd.read_csv("out/samples.csv")
    assert samples["segment[1].load"].mean() == pytest.approx(LOAD, rel=1e-9)
    ratio = samples["tip_at_rest"] / samples["segment[1].load"]
    np.testing.assert_allclose(ratio, static_tip() / LOAD, rtol=1e-6)
    assert Path("out/sampling.png").is_file()
    assert "Scatter of results over 64 samples: beam" in capsys.readouterr().out


def test_a_run_takes_the_mean() -> None:
    Path("case.toml").write_text(SCATTERED, encoding="utf-8")
    assert reading.load("case.toml").segments[0].load == LOAD
    # A mean may be no text.
    Path("case.toml").write_text(SCATTERED.replace(f"mean = {LOAD}", "mean = 'a'"), "utf-8")
    with pytest.raises(BadInput, match=r"got 'a' and 5\.0"):
        reading.load("case.toml")


@pytest.mark.parametrize(
    ("text", "samples", "line"),
    [
        (SCATTERED, "48", "--samples: must be a power of 2 above 2, such as 64, got 48"),
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

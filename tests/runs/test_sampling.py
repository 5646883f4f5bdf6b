# SPDX-License-Identifier: LGPL-3.0-or-later
"""Scatter of results under normally distributed numbers of a case."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.stats import norm

from runs.case import reading
from runs.case.messages import BadInput
from runs.sweep.sampling import QUANTILES, normal_points
from tests.runs.cantilever import CANTILEVER, LOAD, MASS, static_tip
from tests.system.run_folder import protractile

SD = 5.0
SPREAD = f"{{ mean = {LOAD}, sd = {SD} }}"
SCATTERED = CANTILEVER.replace(f"load = {LOAD}", f"load = {SPREAD}")


@pytest.fixture(autouse=True)
def _folder(here: Path, in_this_process: None) -> None:
    Path("case.toml").write_text(SCATTERED, encoding="utf-8")


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
    assert protractile("sweep", "case.toml", "--samples", "64", "--out", "out") == 0
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
    assert reading.load("case.toml").segments[0].load == LOAD


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
    assert protractile("sweep", "case.toml", "--samples", samples, "--out", "out") == 2
    found = capsys.readouterr().err
    assert found.startswith(f"protractile: case.toml: {line}")
    assert found.count("\n") == 1


def test_a_mean_may_be_no_text() -> None:
    Path("case.toml").write_text(SCATTERED.replace(f"mean = {LOAD}", "mean = 'a'"), "utf-8")
    with pytest.raises(BadInput, match=r"got 'a' and 5\.0"):
        reading.load("case.toml")

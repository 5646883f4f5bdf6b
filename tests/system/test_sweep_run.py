# SPDX-License-Identifier: LGPL-3.0-or-later
"""Sweeps of which nothing is left; verdicts of the whole paper case for any round-off."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from protractile.cases import change
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.paper.rules import judge
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import run_case
from tests.runs.case_texts import shipped
from tests.system.run_folder import protractile, write_coarse

pytestmark = pytest.mark.slow


@pytest.mark.usefixtures("in_this_process")
def test_failures_are_lines_and_count_if_nothing_is_left(
    here: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    hard = "--vary", "time.step=2e-12,1e-11", "--models", "kantorovich-4", "--large"
    assert protractile("sweep", write_coarse(here, 0.2).name, *hard, "--out", "out") == 3
    first, second = capsys.readouterr().err.splitlines()
    opening = "protractile: case.toml: --vary time.step="
    assert first.startswith(f"{opening}2e-12: kantorovich-4: a step of 2e-12 s makes ")
    assert second.startswith(f"{opening}1e-11: kantorovich-4: a step of 1e-11 s makes ")


# Verdicts that every sample decides, and those that it decides alike if at all.
SURE = {"S1": "reproduced", "S5": "reproduced"}
SAMPLED = {"S2": "reproduced", "S3": "contradicted"}


def chaotic(modulus: float) -> Results:
    """Return results of the whole paper case, with fast models, for a factor of E."""
    names = ["kantorovich-4", "kantorovich-5", "kantorovich-5-linear", "beam-fe-bonded"]
    case = case_file.select(shipped("paper"), str(CASES / "paper.toml"), names, members=8)
    four, five, linear, without = case.models
    longer = linear.model_copy(update={"terms": (5, 5), "base": "complete"})
    models = {"models": (four, five, longer, without)}
    modulus *= case.material.youngs_modulus
    case = change(case.model_copy(update=models), **{"material.youngs_modulus": modulus})
    # Verdicts need no design results.
    return run_case(case, "", RunContext()).results


def test_verdicts_are_the_same_for_any_round_off() -> None:
    """Reference: the case. Of E, 1e-12 gives another sample of the chaotic motion."""
    one, other = (chaotic(factor) for factor in (1.0, 1.0 + 1.0e-12))
    for results in (one, other):
        found = {verdict.id: verdict.verdict for verdict in judge(results)}
        assert SURE.items() <= found.items()
        # Eight members may leave a verdict within three standard errors of its threshold.
        assert all(found[key] in ("undecided", SAMPLED[key]) for key in SAMPLED)
    tip, moved = (x.trajectories["tip"].sel(model="kantorovich-5").values for x in (one, other))
    assert np.abs(moved - tip).max() > 0.1 * np.ptp(tip)
    # The members of both samples together decide the mean; the share of S3 may take more.
    joined = xr.concat([one.ensembles, other.ensembles], "member")
    together = {verdict.id: verdict.verdict for verdict in judge(replace(one, ensembles=joined))}
    assert together["S2"] == SAMPLED["S2"]
    assert together["S3"] in ("undecided", SAMPLED["S3"])

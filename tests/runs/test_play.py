# SPDX-License-Identifier: LGPL-3.0-or-later
"""What play adds, and what is said of how far numbers can be trusted."""

from __future__ import annotations

from pathlib import Path

import pytest

from runs import CASES
from runs.case import reading as case_file
from runs.pipeline.answers import Answers
from runs.pipeline.run import run_case, silent
from runs.pipeline.trust import known
from tests.runs.summaries import model_summary, summary_of


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Answers:
    """Of the paper's boom by a series and by elements, with play and without."""
    case = case_file.load(str(CASES / "coarse.toml"))
    series, beam = (m for m in case.models if m.name in ("kantorovich-5", "timoshenko"))
    tied = beam.model_copy(update={"name": "tied", "tied": True, "contact": None})
    short = case.model_copy(update={"models": (series, beam, tied)})
    run = run_case(short, "", None, Path(tmp_path_factory.mktemp("meshes")), silent)
    assert run is not None
    assert run.results.summary.answers is not None
    return run.results.summary.answers


def test_play_adds_its_lever_at_rest_and_moves_in_motion(answers: Answers) -> None:
    """Reference: by hand, the tilt of 14 mrad and 5 µrad lifts the tip by 133 mm and 49 µm; other
    models, the trajectories' own largest deflections.
    """
    series, beam = answers.play
    assert (series.model, series.beside, series.alike) == ("kantorovich-5", "tied", False)
    assert (beam.model, beam.beside, beam.alike) == ("timoshenko", "tied", True)
    numbers = {(one.what, one.where): one for one in beam.numbers}
    at_rest = numbers["deflection at rest", "tip"]
    assert at_rest.added == pytest.approx(0.133 + 10.0 * 4.956e-6 - 2.2e-6, abs=1e-7)
    assert at_rest.share == pytest.approx(at_rest.added / 0.009916, rel=1e-3)
    moved = {name: answers.models[name].moved for name in ("timoshenko", "tied")}
    largest = [m.peaks[0].largest for m in moved.values() if m is not None]
    assert numbers["deflection", "tip"].added == pytest.approx(largest[0] - largest[1])
    assert ("stress", "inner") in numbers
    assert not any(one.what in ("stress", "bending moment") for one in series.numbers)


def test_models_agree_within_what_is_said(answers: Answers) -> None:
    """Reference: other numbers of the same run, the tips of both models at rest."""
    agreement = [known.line for known in answers.trust if known.what == "agreement"]
    series, beam = (answers.models[name].rests[0].tip for name in ("kantorovich-5", "timoshenko"))
    off = 100.0 * abs(series / beam - 1.0)
    (line,) = agreement
    assert line.startswith(f"kantorovich-5 is off timoshenko by {off:.2g} % in the tip at rest, ")


def test_chaos_is_told_of_what_is_chaotic_alone() -> None:
    """Reference: the ensembles, of which one parts at 3.2 s and the other not at all."""

    def ensemble(time: float | None) -> dict[str, object]:
        return {"horizons": {"0.2": time}, "energy_residual": 1e-6, "slow_peaks": None}

    summary = summary_of(
        {
            "wild": model_summary(ensemble=ensemble(3.2)),
            "calm": model_summary(ensemble=ensemble(None), energy_residual=2e-4),
        }
    )
    found = {one.what: [] for one in known(summary, Answers({}), 10.0)}
    for one in known(summary, Answers({}), 10.0):
        found[one.what].append(one.line)
    chaotic, regular = found["horizon"]
    assert "from here on: wild 3.20 s." in chaotic
    assert regular == "The motion of calm can be predicted over all 10 s."
    assert found["energy"] == [
        "Energy is accounted for within 0.0002 of the work done in every model; the least well in "
        "calm."
    ]
    none = summary_of({"plain": model_summary()})
    assert [one.what for one in known(none, Answers({}), 10.0)] == ["energy"]

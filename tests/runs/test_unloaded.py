# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms without loads, with initial velocities, or released, from case to report."""

from pathlib import Path

import numpy as np
import pytest

from protractile.runs.pipeline.results import Results
from tests.runs.case_texts import CLAMPED, REST, STEEL, box, elements, joint, refusal, table
from tests.system.run_folder import protractile

UNLOADED = f"""
title = "A boom that nothing loads"
time = {{ duration = 0.1, output_step = 1e-3 }}
{STEEL}
{table("[damping]", modal=0.01)}
{box("base", (0.0, 6.5), (0.300, 0.220, 0.006, 0.005), CLAMPED)}
{box("fly", (5.3, 11.3), (0.256, 0.180, 0.005, 0.004))}
{joint("fly", "base", 0.003, (5.3, 6.5))}
{elements("elements")}
{table("[[model]]", name="rigid", kind="rigid")}
{elements("bonded", bonded=True)}
"""


def load(**keys: object) -> str:
    return table("[[load]]", segment="fly", x="head", **keys)


# What is added, and whether the boom moves.
ADDED = {
    "nothing": ("", False),
    "at rest": (REST, False),
    "a load of nothing": (load(magnitude=0.0), False),
    "thrown": (table("[start]", velocity={"fly": 0.1}), True),
    "let go": (load(magnitude=-500.0, released=True), True),
}


pytestmark = pytest.mark.usefixtures("here")


@pytest.mark.slow
@pytest.mark.parametrize("kind", ADDED)
def test_a_boom_without_loads_is_run_and_reported(
    kind: str, request: pytest.FixtureRequest
) -> None:
    """Reference: analytic. Without loads the boom is straight, and at rest unless thrown."""
    added, moves = ADDED[kind]
    if kind not in {"nothing", "thrown"}:
        request.getfixturevalue("unprinted")
    Path("case.toml").write_text(UNLOADED + added, encoding="utf-8")
    assert protractile("check", "case.toml") == 0
    assert protractile("run", "case.toml", "--no-pictures", "--out", "out") == 0
    results = Results.load(Path("out"))
    rests = results.curves.where(model="elements", state="rest", play=True)
    ends = [curve.values["deflection"] for curve in rests.where(segment=rests[-1].segment)]
    assert not ends[-1].any()
    assert any(end.any() for end in ends) == (kind == "let go")
    tips = results.trajectories["tip"].values
    assert bool(np.abs(tips).max() > 1e-3) == moves
    assert Path("out/report.html").is_file()
    assert not Path("out/figures").exists()
    assert protractile("report", "--figures", "out") == 0
    assert Path("out/figures/at-rest.png").exists() == (kind == "let go")
    assert Path("out/figures/envelopes.png").exists() == moves


@pytest.mark.parametrize("kind", ADDED)
def test_members_need_a_load_to_change(kind: str, capsys: pytest.CaptureFixture[str]) -> None:
    text = UNLOADED + ADDED[kind][0]
    Path("plain.toml").write_text(text, encoding="utf-8")
    Path("case.toml").write_text(f"{text}[ensemble]\nmembers = 4\n", encoding="utf-8")
    for *command, file in (("check", "case.toml"), ("run", "--members", "4", "plain.toml")):
        assert protractile(*command, file) == 2
        assert capsys.readouterr().err == (
            f"protractile: {file}: ensemble.vary: no load acts from t = 0 on, of which members "
            "change a part; give vary = 'clearance', or leave the ensemble out\n"
        )


def test_members_need_a_play_to_change() -> None:
    text = UNLOADED.replace("play = 0.003", "play = 0.0")
    assert refusal(Path(), f'{text}[ensemble]\nmembers = 4\nvary = "clearance"\n') == (
        "ensemble.vary: there is no play, of which members change a part; give vary = 'load', or "
        "leave the ensemble out"
    )

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Captions of snapshots: instant, colours, and model."""

import os
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from multiprocessing import active_children
from pathlib import Path
from time import sleep

import numpy as np
import pytest
import xarray as xr

from runs.case import reading as case_file
from runs.pipeline.results import Results
from runs.report import opengl
from runs.report.opengl import RenderingUnavailable
from runs.report.snapshots import describe_one, start_rendering
from tests.runs.case_texts import shipped

TIME = np.arange(1001) / 1000


def results(*shells: str) -> Results:
    """Return shells whose tip vibrates by 100 mm, with a contact of 2 kN at 0.25 s."""
    case = case_file.select(shipped("lift"), "", ["shell"], None)
    models = tuple(case.models[0].model_copy(update={"name": name}) for name in shells)
    force = np.zeros((len(shells), TIME.size, 1))
    force[:, 250] = 2000.0
    tips = np.tile(0.05 * (1.0 - np.cos(2.0 * np.pi * TIME)), (len(shells), 1))
    sideways = np.tile(0.025 * (1.0 - np.cos(1.3 * np.pi * TIME)), (len(shells), 1))
    trajectories = xr.Dataset(
        {
            "tip": (("model", "time"), tips),
            "tip_lateral": (("model", "time"), sideways),
            "contact_force_peak": (("model", "time", "station"), force),
        },
        coords={"model": list(shells), "time": TIME, "station": [9.0]},
    )
    return Results(case.model_copy(update={"models": models}), trajectories, {})


@pytest.mark.parametrize(
    ("name", "title", "seen"),
    [
        ("boom-first-peak.png", "Boom: first peak of the tip at 0.500 s", "tip +100.0 mm"),
        ("boom-largest-force.png", "Boom: largest contact force at 0.250 s",
         "magnitude of deflection"),
        ("boom-0.25s.png", "Boom: 0.250 s", "tip +50.0 mm"),
        ("overlap-first-contact.png", "Overlap: first contact at 0.250 s", "cut open"),
        ("overlap-2-1s.png", "Overlap of joint 2: 1.000 s", "Blue: outer segment"),
        ("stress-largest-force.png", "Stress at the overlap: largest", "Von Mises"),
        ("stress-above-2-1s.png", "Stress at the overlap of joint 2, seen from above", "faces"),
        ("boom-above-first-peak.png", "Boom, seen from above: first peak of the tip at 0.769 s",
         "(0.769 s, lateral tip +50.0 mm)"),
        ("overlap-above-1s.png", "Overlap, seen from above: 1.000 s", "Blue: outer"),
        ("boom-largest-deflection.png", "Boom: largest deflection of the tip", "grey: undeformed"),
        ("motion.gif", "Boom in motion, first 1 s", "in 5 s"),
    ],
)  # fmt: skip
def test_caption_describes_the_picture(name: str, title: str, seen: str) -> None:
    """Reference: analytic, a tip of 50 mm (1 − cos 2πt)."""
    figure = describe_one(results("shell"), Path(name))
    assert figure.title.startswith(title)
    assert seen in figure.caption
    assert "'shell'" in figure.caption
    assert "magnif" in figure.caption


def test_a_deflection_down_has_a_minus_sign() -> None:
    """Reference: analytic, the tip of −100 mm; a hyphen is no sign."""
    above = results("shell")
    below = replace(above, trajectories=above.trajectories.assign(tip=-above.trajectories["tip"]))
    assert "tip −100.0 mm" in describe_one(below, Path("boom-0.5s.png")).caption


def test_arrows_over_a_surface_are_sums() -> None:
    lines = results("shell")
    table = lines.case.models[0].model_copy(update={"contact_line": "surface"})
    case = lines.case.model_copy(update={"models": (table,)})
    for name in ("overlap-first-peak.png", "stress-first-peak.png"):
        told = "each arrow is the sum of the forces at the points nearest to its station."
        assert describe_one(replace(lines, case=case), Path(name)).caption.endswith(told)
        assert told not in describe_one(lines, Path(name)).caption
    # Of several shells the right one is named.
    both = results("shell", "shell-fine")
    for name in ("shell", "shell-fine"):
        assert f"{name!r}" in describe_one(both, Path(f"{name}-boom-first-peak.png")).caption
        assert f"{name!r}" in describe_one(both, Path(f"{name}-motion.gif")).caption


@pytest.mark.slow
@pytest.mark.parametrize(
    ("work", "probe", "seconds", "error", "message"),
    [
        (os.abort, "import os; os.abort()", 60, RenderingUnavailable, "dies of SIGABRT; install"),
        (os.abort, "pass", 60, MemoryError, "the system has killed the process that draws"),
        (partial(sleep, 60), "pass", 0.1, RenderingUnavailable, "makes no picture within 0.1 s"),
    ],
    ids=["no OpenGL", "killed", "hangs"],
)
def test_failing_picture_process_is_reported(
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    work: Callable[[], None],
    probe: str,
    seconds: float,
    error: type[Exception],
    message: str,
) -> None:
    """Reference: processes that are killed, or do not end."""
    monkeypatch.setattr(opengl, "render_test_picture", work)
    monkeypatch.setattr(opengl, "PROBE", probe)
    monkeypatch.setattr(opengl, "PROBE_SECONDS", seconds)
    fields, motion = tmp_path / "fields.nc", tmp_path / "trajectories.nc"
    with (
        pytest.raises(error, match=message),
        start_rendering(results("a"), [fields], motion, tmp_path) as gather,
    ):
        gather()
    assert not list(tmp_path.iterdir())
    assert not active_children()

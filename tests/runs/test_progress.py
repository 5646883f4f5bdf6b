# SPDX-License-Identifier: LGPL-3.0-or-later
"""Off a terminal a line now and then tells how far a run is."""

from __future__ import annotations

import pytest

from runs.process import progress
from runs.process.progress import Lines

EVERY = 5.0


def test_tells_the_stage_and_what_is_left(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: by hand. Of 40 % in 12 s, 18 s are left; what follows within five seconds is not
    told, nor what has ended by then. What a stage took that is told of at its end is not known."""
    monkeypatch.setattr(progress, "EVERY", EVERY)
    said: list[str] = []
    times: list[float] = [0.0]
    lines = Lines(["beam", "shell"], said.append, lambda: times[-1])
    for time, model, stage, part in (
        (0.0, "beam", "build", 0.0),
        (0.1, "beam", "build", 1.0),
        (0.2, "shell", "reduction", 0.0),
        (12.2, "shell", "reduction", 0.4),
        (12.2 + 0.9 * EVERY, "shell", "reduction", 0.5),
        (30.2, "shell", "reduction", 1.0),
        (40.0, "shell", "motion", 0.0),
        (50.0, "shell", "fields", 1.0),
        (60.0, "report", "pictures", 0.0),
    ):
        times.append(time)
        lines(model, stage, part)
    assert said == [
        "shell (2 of 2): reduction 40 %, 18 s left",
        "shell (2 of 2): reduction took 30 s",
        "shell (2 of 2): motion begins",
        "shell (2 of 2): fields is done",
        "report: pictures begins",
    ]

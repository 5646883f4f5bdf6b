# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distances of beams from the shell in a sweep over play."""

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from runs import CASES
from runs.folder.cache import Cache
from runs.sweep import output
from runs.sweep import run as sweep
from runs.sweep.points import plan

pytestmark = pytest.mark.slow

CASE = CASES / "beam-or-shell.toml"


def test_better_beams_are_nearer_to_the_shell(here: Path) -> None:
    """Reference: other code, the shell. Each beam includes an effect the previous one lacks."""
    text = CASE.read_text(encoding="utf-8").replace("duration = 5.0", "duration = 1.0")
    assert text.count("acceleration = 1.0") == 1
    text = text.replace("acceleration = 1.0", "acceleration = 10.0")
    Path("case.toml").write_text(text, encoding="utf-8")
    keys = ["joint.play=0.004,0.014"]
    sweeping = plan("case.toml", keys, None, 0.4, "shell")
    cache, out = Cache(here / "cache"), here / "out"
    sweep.prepare(out, "case.toml")
    with ThreadPoolExecutor(2) as pool:
        outcomes = sweep.run_points(sweeping, out, pool, lambda *_: None, cache)
    # One shell for all points, and for the beams that it calibrates.
    assert len(list(cache.folder.glob("*.record"))) == 1
    data = output.gather(sweeping, outcomes)
    for distance in ("tip_off", "first_peak_off"):
        worst = data[distance].max("joint.play")
        euler, plain, sprung, fielded, _ = worst.values
        assert euler > 1.5 * plain > 3.0 * sprung > 3.0 * fielded, worst
        assert fielded < 0.01

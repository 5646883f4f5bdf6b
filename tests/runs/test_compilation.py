# SPDX-License-Identifier: LGPL-3.0-or-later
"""Announcement of a compilation of the time loop."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.kernels import march
from protractile.dynamics.motion import Motion
from protractile.runs.pipeline.models import MotionPlan
from tests.modal import oscillator


def test_only_the_first_compilation_is_announced(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """Reference: by construction, numba's folder of the real loop without and with its file."""
    plan = MotionPlan(Motion(oscillator(), 1.0, 0.1), FixedStep(0.1), None)
    plan.integrator(plan.motion)
    (compiled, *_) = Path(march.march.stats.cache_path).glob("march.march-*.nbc")
    loop = SimpleNamespace(signatures=[], stats=SimpleNamespace(cache_path=str(tmp_path)))
    monkeypatch.setattr("protractile.dynamics.kernels.march.march", loop)
    plan.warm()
    assert caplog.messages == [
        f"compiling the time loop (half a minute), for later runs too, into {tmp_path}"
    ]
    (tmp_path / compiled.name).touch()
    plan.warm()
    assert len(caplog.messages) == 1

# SPDX-License-Identifier: LGPL-3.0-or-later
"""A motion that rubs, told to the last bit, and whether a worker of the tests has compiled it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dynamics.contact import PowerContact
from dynamics.friction import DryFriction
from dynamics.gap_system import GapSystem, Observer
from dynamics.integrator import FixedStep
from dynamics.kernels.march import march
from dynamics.motion import Motion


def compiled_in(factory: pytest.TempPathFactory) -> Path:
    """Where a worker that has compiled the motion leaves what it tells, for all workers."""
    return factory.getbasetemp().parent / "compiled-rubbing"


def compile_loop(file: Path) -> None:
    """Leave in a file what the motion tells, unless some of its loop had been compiled before."""
    said = told()
    if march.stats.cache_misses:
        file.write_text(said, encoding="utf-8")


def told() -> str:
    """All numbers of the motion."""
    random = np.random.default_rng(3)
    rows = random.normal(size=(2, 12))
    system = GapSystem(
        omega2=np.linspace(0.0, 300.0, 12) ** 2,
        load=random.normal(size=12),
        rows=rows,
        laws=[PowerContact(1.0e6, 2.0, 1.0e-3)] * 2,
        station_of_row=np.array([0, 1]),
        stations=[0.0, 1.0],
        observers={"tip": Observer(rows[0])},
        friction_rows=random.normal(size=(2, 12)),
        frictions=[DryFriction(0.2, 0, 1.0, (0,)), DryFriction(0.2, 1, 2.0)],
    )
    data = FixedStep(1.0e-4)(Motion(system, 0.5, 0.01)).data
    return f"{ {name: values.values.tolist() for name, values in data.items()} }\n"


if __name__ == "__main__":
    print(told(), end="")

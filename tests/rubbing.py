# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motions with friction to the last bit, and a record of the worker that compiled the time loop."""

from pathlib import Path

import numpy as np
import pytest

from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.kernels.march import march
from protractile.dynamics.motion import Motion
from protractile.dynamics.motion_laws import SCurve
from tests.dynamics.test_telescoping import lossy, pressed_along
from tests.modal import modal_system


def compiled_in(factory: pytest.TempPathFactory) -> Path:
    """Return the file in which the worker that compiled the loop writes its motions."""
    return factory.getbasetemp().parent / "compiled-rubbing"


def compile_loop(file: Path) -> None:
    """Write the motions to a file, unless their loop was compiled before."""
    numbers = motion_numbers()
    if march.stats.cache_misses:
        file.write_text(numbers, encoding="utf-8")


def motion_numbers() -> str:
    """Return all numbers of motions with friction, telescoping and moving axial forces."""
    random = np.random.default_rng(3)
    rows = random.normal(size=(2, 12))
    system = modal_system(
        np.linspace(0.0, 300.0, 12) ** 2,
        random.normal(size=12),
        rows,
        [PowerContact(1.0e6, 2.0).with_clearance(1.0e-3)] * 2,
        tip=rows[0],
        friction_rows=random.normal(size=(2, 12)),
        frictions=[DryFriction(0.2, 0, 1.0, (0,)), DryFriction(0.2, 1, 2.0)],
    )
    drawn = lossy(SCurve(5.0, 0.4)), pressed_along(SCurve(2.0, 1.0))
    runs = [FixedStep(1.0e-4)(Motion(one, 0.2, 0.01)).data for one in (system, *drawn)]
    return f"{[[values.values.tolist() for values in run.values()] for run in runs]}\n"


if __name__ == "__main__":
    print(motion_numbers(), end="")

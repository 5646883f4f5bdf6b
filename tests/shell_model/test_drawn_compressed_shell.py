# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells that axial forces press while they are drawn out."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI
from scipy.linalg import eigh

from dynamics.arrays import Array
from dynamics.contact import PowerContact
from dynamics.drive.travel import Stroke
from dynamics.equilibrium import equilibrium
from dynamics.gap_system import GapSystem
from dynamics.integrator import FixedStep
from dynamics.motion import Motion
from geometry.axial import Thrust, with_compression
from geometry.boom import Boom
from geometry.joint import Drive
from shell_model.boom_shell import ShellOptions
from shell_model.reduced_shell import reduce_boom
from tests.shell_model.booms import flat_boom
from tests.touching import touching

LAW = PowerContact(1.0e8, 1.0).behind(7.0e-3)
DRAWN = Drive(Stroke(2.0, 4.0, 0.1), ("inner", "outer"))
SIZE = 0.3  # of which rings do not lie at round places


def telescope(way: float, drive: Drive | None = None) -> Boom:
    """The paper's boom with an overlap of 4 m less a way in m, its weight along it and a rope."""
    boom = flat_boom()
    outer, inner = boom.segments
    inner = replace(inner, start=6.0 + way, end=16.0 + way)
    stations = inner.start, outer.end
    joint = replace(boom.joints[0], stations=stations, drive=drive, contact_length=SIZE)
    ropes = [Thrust(1, inner.end, 1.0e5)]
    segments = with_compression((outer, inner), [joint], ropes, gravity=8.0)
    return replace(boom, segments=segments, joints=(joint,))


def reduced(way: float, drive: Drive | None = None) -> GapSystem:
    return reduce_boom(
        touching(telescope(way, drive), LAW), ShellOptions(SIZE), MPI.COMM_WORLD
    ).system


def told(system: GapSystem) -> Array:
    """(5,) what tip and head read at rest, and the lowest frequencies of contacts as springs."""
    rest = equilibrium(system, system.load)
    stiffness = system.stiffness + 1.0e8 * system.rows.T @ system.rows
    squares = eigh(stiffness, eigvals_only=True, subset_by_index=[0, 2])
    seen = [system.observers[name].row @ rest for name in ("tip", "head")]
    return np.array([*seen, *np.sqrt(squares)])


@pytest.mark.slow
def test_on_the_way_it_is_the_shell_that_rests_there() -> None:
    """Reference: other code path, the shell with its axial forces that is reduced where it rests;
    and analytic, the ledger of a motion.
    """
    system = reduced(0.0, DRAWN)
    (travel,) = system.travels
    times = np.linspace(0.0, 1.0, 20001)
    for way in (0.0, 2.0):
        time = float(np.interp(way, travel.history(times), times))
        here = system.standing(time)
        there = told(reduced(way))
        assert told(here) == pytest.approx(there, rel=1e-4)
    # Without the force that goes along it rests and swings by several times that elsewhere.
    plain = replace(here, softening=np.zeros((0, 0)))
    assert (np.abs(told(plain)[:4] / there[:4] - 1.0) > 5.0e-4).all()
    run = FixedStep(5.0e-6)(Motion(system, 0.7, 1.0e-2))
    assert run.energy_residual < 1.0e-4
    assert abs(float(run.data["drive_work"][-1])) > 0.01 * float(np.abs(run.data["work"]).max())

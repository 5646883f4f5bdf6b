# SPDX-License-Identifier: LGPL-3.0-or-later
"""Axial forces are in the stresses of shells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from geometry.boom import Boom, Collar
from shell_model.boom_shell import ShellOptions
from shell_model.reduced_shell import reduce_boom
from shell_model.stress.stresses import ShellStress, wall_forces
from studies.second_order import BOX, CLAMP, CRITICAL, LENGTH, STEEL, column
from studies.taper import arm


def stressed(boom: Boom) -> ShellStress:
    """Where it has not moved."""
    fields = reduce_boom(boom, ShellOptions(mesh_size=0.4), MPI.COMM_SELF).fields
    assert fields is not None
    still = np.zeros((1, fields.sizes["mode"]))
    moving = fields.assign(state=(("time", "mode"), still), time=("time", np.zeros(1)))
    return ShellStress.of(moving)


def carried(shell: ShellStress, x: float) -> float:
    """By all walls through a section, in N."""
    return sum(forces.axial for forces in wall_forces(shell, 0.0, 0, x).values())


def test_a_column_is_pressed_by_its_load_and_its_weight() -> None:
    """Reference: by hand, −P/A in every wall, with m̄ g (L − x) of weight at the middle of a row;
    a collar takes its share of the same force.
    """
    force, gravity = 0.1 * CRITICAL, 9.80665
    boom = column((CLAMP,), force)
    shell = stressed(boom)
    np.testing.assert_allclose(shell.at(0.0).membrane[:, 0], -force / BOX.area, rtol=1e-6)
    assert np.abs(shell.at(0.0).membrane[:, 1:]).max() == 0.0
    (segment,) = boom.segments
    doubled = replace(segment, collars=(Collar(3.0, 4.0, 0.006),))
    collared = stressed(replace(boom, segments=(doubled,)))
    assert collared.at(0.0).membrane[:, 0].max() == pytest.approx(-0.5 * force / BOX.area)
    assert carried(collared, 3.5) == pytest.approx(-force, rel=1e-6)
    weighing = stressed(column((CLAMP,), force, gravity))
    row = weighing.row(0, 2.0)
    middle = 0.5 * (weighing.spans[row, 0].min() + weighing.spans[row, 1].max())
    above = BOX.mass_per_length(STEEL.density) * gravity * (LENGTH - middle)
    assert carried(weighing, 2.0) == pytest.approx(-force - above, rel=1e-4)
    every = np.arange(weighing.segment.size)
    ((_, over_time),) = weighing.over_time(every)
    np.testing.assert_array_equal(over_time.membrane[0], weighing.at(0.0).membrane)


def test_a_taper_is_pressed_most_at_its_slender_end() -> None:
    """Reference: by hand, −P/A of the local section, four times as much at the head as at the tail,
    and the same force in each.
    """
    shell = stressed(arm(1000.0))
    stress, x = shell.at(0.0).membrane[:, 0], shell.centroids[:, 0]
    (segment,) = arm().segments
    local = np.array([segment.section_at(place).area for place in x.tolist()])
    np.testing.assert_allclose(stress, -1000.0 / local, rtol=1e-5)
    assert stress.min() / stress.max() > 3.0
    for place in (1.0, 4.0, 7.0):
        assert carried(shell, place) == pytest.approx(-1000.0, rel=2e-3)

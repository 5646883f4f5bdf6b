# SPDX-License-Identifier: LGPL-3.0-or-later
"""Output of a shell besides its trajectory."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from dynamics.contact import PowerContact
from dynamics.excitation import Step
from dynamics.trajectory import Trajectory
from geometry.boom import Boom, Cylinder, Load, PointMass, Stop
from runs.pipeline.model_output import ShellOutput
from shell_model.boom_shell import ShellOptions
from shell_model.reduced_shell import reduce_boom
from tests.shell_model.booms import LATERAL_LAW, LAW, boom_in_space
from tests.touching import touching

pytestmark = pytest.mark.slow


def output(boom: Boom) -> ShellOutput:
    """Return the output of a shell at rest for one second."""
    shell = reduce_boom(touching(boom, LAW, LATERAL_LAW), ShellOptions(0.5), MPI.COMM_SELF)
    time = np.array([0.0, 1.0])
    data = xr.Dataset(coords={"time": time})
    still = Trajectory(data, np.zeros((time.size, shell.system.omega2.size)))
    return ShellOutput.of(boom, "shell", shell, still)


def test_stresses_are_stored_beside_every_contact_and_support() -> None:
    """Reference: the boom. Supports, masses, a lug, stations, a stop inside the overlap, loads."""
    stop = Stop(1, 9.5, 0.04, PowerContact(1.0e9, 1.0).upper())
    cylinder = Cylinder(0, x=4.0, depth=0.25, ground=(1.0, -4.25), stiffness=1.0e7)
    boom = boom_in_space()
    outer = replace(boom.segments[0], masses=(PointMass(4.0, 50.0),))
    pushes = tuple(Load(1, "z", size, 19.0, Step()) for size in (-2.0, 5.0, 7.0))
    segments = (outer, boom.segments[1])
    left = output(
        replace(boom, segments=segments, stops=(stop,), cylinders=(cylinder,), loads=pushes)
    )
    assert left.stresses["place"].values.tolist() == [0.0, 2.0, 4.0, 9.0, 9.5, 10.0, 19.0]
    assert left.largest.von_mises == 0.0
    moved = np.tensordot(left.modes["state"].values, left.modes["modes"].values, axes=1)
    np.testing.assert_allclose(np.linalg.norm(moved, axis=2).max(axis=1), 1.0, rtol=1e-5)
    assert set(left.meshes) == {"outer", "inner"}

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the walls give way where segments touch, and how far meshes and reductions are off it."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from mpi4py import MPI

from dynamics.contact import PowerContact
from geometry.boom import Boom, Stop
from shell_model.boom_shell import ShellOptions
from shell_model.contact.local_compliance import SLOW, compliance
from shell_model.reduced_shell import ReducedShell, reduce_boom
from shell_model.reduction.segment import KrylovOptions
from tests.shell_model.booms import LAW, flat_boom, three_segments
from tests.touching import touching

pytestmark = pytest.mark.slow


SIZES = (0.8, 0.4, 0.2)


@cache
def _reduced(boom: Boom, size: float, moments: int = 2) -> ReducedShell:
    options = ShellOptions(size, krylov=KrylovOptions(moments=moments))
    return reduce_boom(touching(boom, LAW), options, MPI.COMM_WORLD)


def test_no_rigid_motion_fills_it() -> None:
    """Reference: analytic. A rigid motion opens no squeezed station: its rows above and below are
    the same in the rigid modes, and a hundredth of the shift, a hundred times the rigid compliance,
    leaves the local one.
    """
    reduced = _reduced(flat_boom(), 0.4)
    system = reduced.system
    rigid = system.rows[:, system.omega2 == 0.0]
    assert np.abs(rigid).max() > 0.01
    assert np.abs(rigid[::2] - rigid[1::2]).max() < 1.0e-12 * np.abs(rigid).max()
    slower = system.omega2 + (0.1 * 2.0 * np.pi * SLOW) ** 2
    whole = (system.rows / slower) @ system.rows.T
    assert whole[0, 0] > 200.0 * reduced.local_compliance[0]
    squeezed = 0.5 * (whole[0, 0] + whole[1, 1] - 2.0 * whole[0, 1])
    assert reduced.local_compliance[:2] == pytest.approx(2 * [squeezed], rel=1.0e-3)


def test_a_mesh_tells_how_far_the_next_finer_one_is() -> None:
    """Reference: other code, meshes of half and of a quarter the edge length. What a mesh says of
    itself is the change from its coarser companion, found without reducing it.
    """
    for coarse, fine in pairwise(_reduced(flat_boom(), size) for size in SIZES):
        change = 1.0 - coarse.local_compliance / fine.local_compliance
        assert fine.mesh_error == pytest.approx(change.max(), rel=1.0e-4)


def test_a_poor_reduction_is_told_on_the_same_scale() -> None:
    """Reference: other code, more moments."""
    rich, poor = (_reduced(flat_boom(), 0.4, moments) for moments in (3, 1))
    full, own = (np.diag(compliance(r.system.omega2, r.system.rows)) for r in (rich, poor))
    off = float(np.max((full - own) / rich.local_compliance))
    assert rich.errors["contact_compliance"] < 1.0e-3 * poor.errors["contact_compliance"]
    assert 0.0 < off < 2.0 * poor.errors["contact_compliance"]


def test_a_tied_joint_leaves_the_others_their_measure() -> None:
    boom = three_segments()
    tied = replace(boom, joints=(replace(boom.joints[0], tied=True), *boom.joints[1:]))
    free, held = _reduced(boom, 0.8, 1), _reduced(tied, 0.8, 1)
    assert held.local_compliance == pytest.approx(free.local_compliance[4:], rel=1.0e-3)
    assert held.mesh_error <= free.mesh_error * (1.0 + 1.0e-6)


def test_what_has_no_other_side_has_none() -> None:
    rest = Stop(1, 19.0, 0.2, PowerContact(0.0, 1.0, stiffness_below=1.0e7))
    boom = replace(flat_boom(), stops=(rest,))
    reduced = _reduced(boom, 0.8, 1)
    assert np.isnan(reduced.local_compliance).tolist() == [False] * 4 + [True]
    assert np.isfinite(reduced.mesh_error)
    tied = replace(boom, stops=(), joints=(replace(boom.joints[0], tied=True),))
    assert np.isnan(_reduced(tied, 0.8, 1).mesh_error)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Local compliance of walls: reduction, mesh error, estimate."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.calibration import Stiffness, effective_stiffness
from protractile.beam_model.wall_compliance import contact_compliance
from protractile.dynamics.contact import PowerContact
from protractile.geometry.boom import Boom, Collar, Pad, Stop, Support
from protractile.geometry.probe_responses import PROBE_FREQUENCY
from protractile.shell_model.boom_shell import ShellOptions, assemble_segments
from protractile.shell_model.contact.local_compliance import (
    SLOW,
    compliance,
    probe_loads,
    probe_responses,
    shell_compliance,
)
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from tests.shell_model.booms import (
    LAW,
    boom_in_space,
    box_segment,
    flat_boom,
    reduced,
    three_segments,
)
from tests.touching import touching

SIZES = (0.8, 0.4, 0.2)


@pytest.mark.slow
def test_no_rigid_motion_fills_it() -> None:
    """Reference: analytic. Rigid motions do not contribute, so that the shift has no effect."""
    shell = reduced(flat_boom(), 0.4, moments=2)
    system = shell.system
    rigid = system.rows[:, system.omega2 == 0.0]
    assert np.abs(rigid).max() > 0.01
    assert np.abs(rigid[::2] - rigid[1::2]).max() < 1.0e-12 * np.abs(rigid).max()
    slower = system.omega2 + (0.1 * 2.0 * np.pi * SLOW) ** 2
    whole = (system.rows / slower) @ system.rows.T
    assert whole[0, 0] > 200.0 * shell.local_compliance[0]
    squeezed = 0.5 * (whole[0, 0] + whole[1, 1] - 2.0 * whole[0, 1])
    assert shell.local_compliance[:2] == pytest.approx(2 * [squeezed], rel=1.0e-3)


@pytest.mark.slow
def test_mesh_error_predicts_the_next_finer_mesh() -> None:
    """Reference: other code, meshes of half and a quarter of the edge length."""
    for coarse, fine in pairwise(reduced(flat_boom(), size, moments=2) for size in SIZES):
        change = 1.0 - coarse.local_compliance / fine.local_compliance
        assert fine.mesh_error == pytest.approx(change.max(), rel=1.0e-4)


@pytest.mark.slow
def test_poor_reduction_has_a_large_error() -> None:
    """Reference: other code, more moments; non-regression of the estimate, which is far larger."""
    rich, poor = (reduced(flat_boom(), 0.4, moments=moments) for moments in (3, 1))
    full, own = (np.diag(compliance(r.system.omega2, r.system.rows)) for r in (rich, poor))
    off = float(np.max((full - own) / rich.local_compliance))
    assert off == pytest.approx(5.985e-5, rel=0.02)
    assert poor.errors["contact_compliance"] == pytest.approx(0.01394, rel=0.02)
    assert rich.errors["contact_compliance"] < 1.0e-5 * poor.errors["contact_compliance"]


@pytest.mark.slow
def test_a_bonded_joint_leaves_the_others_their_measure() -> None:
    boom = three_segments()
    bonded = replace(boom, joints=(replace(boom.joints[0], bonded=True), *boom.joints[1:]))
    free, held = reduced(boom, 0.8), reduced(bonded, 0.8)
    assert held.local_compliance == pytest.approx(free.local_compliance[4:], rel=1.0e-3)
    assert held.mesh_error <= free.mesh_error * (1.0 + 1.0e-6)


@pytest.mark.slow
def test_one_sided_contact_has_no_local_compliance() -> None:
    rest = Stop(1, 19.0, 0.2, PowerContact(0.0, 1.0, stiffness_below=1.0e7))
    boom = replace(flat_boom(), stops=(rest,))
    shell = reduced(boom, 0.8)
    assert np.isnan(shell.local_compliance).tolist() == [False] * 4 + [True]
    assert np.isfinite(shell.mesh_error)
    bonded = replace(boom, stops=(), joints=(replace(boom.joints[0], bonded=True),))
    assert np.isnan(reduced(bonded, 0.8).mesh_error)


def stiffness(boom: Boom, contact_tolerance: float | None = None) -> list[Stiffness]:
    options = ShellOptions(0.25, contact_tolerance=contact_tolerance)
    shells = assemble_segments(boom, options, MPI.COMM_WORLD)
    found = []
    for number, (segment, shell) in enumerate(zip(boom.segments, shells, strict=True)):
        moved = shell_compliance(
            SymmetryReduction(shell), probe_loads(boom, number, shell), PROBE_FREQUENCY
        )
        found.append(effective_stiffness(segment, probe_responses(boom, number, moved)))
    return found


@pytest.mark.slow
@pytest.mark.parametrize("boom", [flat_boom(), boom_in_space()])
def test_plates_are_nearly_the_beam_of_their_section(boom: Boom) -> None:
    """Reference: analytic, E J, G A_s of the shear flow, and Bredt's G J_t."""
    for segment, found in zip(boom.segments, stiffness(boom), strict=True):
        planes = (segment, segment.turned())[: len(found.bending)]
        for plane, bending, shear in zip(planes, found.bending, found.shear, strict=True):
            assert plane.shear_stiffness is not None
            assert bending == pytest.approx(plane.bending_stiffness, rel=5e-3)
            assert shear == pytest.approx(plane.shear_stiffness, rel=0.3)
        if boom.spatial:
            bredt = segment.material.shear_modulus * segment.lateral.torsion_constant
            assert found.torsion == pytest.approx(bredt, rel=0.01)


@pytest.mark.slow
def test_graded_mesh_equals_a_uniform_mesh() -> None:
    """Reference: other code, a uniform mesh; unit responses are far from contacts."""
    for coarse, fine in zip(stiffness(flat_boom()), stiffness(flat_boom(), 0.01), strict=True):
        assert coarse.bending == pytest.approx(fine.bending, rel=2e-3)
        assert coarse.shear == pytest.approx(fine.shear, rel=0.02)


SUPPORTS = (Support(7.0), Support(8.0))


def short_boom(pad: Pad | None) -> Boom:
    """Return the paper's sections with 3 m of each segment at the overlap, and pads, if any."""
    boom = touching(flat_boom(), LAW)
    spans = (7.0, 10.0), (9.0, 12.0)
    outer, inner = (
        box_segment(one.name, *span, one.section, supports=held)
        for one, span, held in zip(boom.segments, spans, (SUPPORTS, ()), strict=True)
        if one.section is not None
    )
    return replace(boom, segments=(outer, inner), joints=(replace(boom.joints[0], pad=pad),))


@pytest.mark.slow
def test_a_tolerance_is_kept() -> None:
    """Reference: a mesh for a quarter of the tolerance, extrapolated (Richardson 1911)."""
    uniform, coarse, fine = (
        reduced(short_boom(None), 0.1, contact_tolerance=tolerance).local_compliance[0]
        for tolerance in (None, 0.16, 0.04)
    )
    limit = fine + (fine - coarse) / 3.0
    assert fine == pytest.approx(limit, rel=0.04)
    assert coarse == pytest.approx(limit, rel=0.16)
    assert uniform < 0.95 * limit


def with_collar(boom: Boom) -> Boom:
    """Return the boom with a collar at the head of the outer segment."""
    collared = replace(boom.segments[0], collars=(Collar((9.6, 10.0), 0.008),))
    return replace(boom, segments=(collared, boom.segments[1]))


def with_strips(boom: Boom) -> Boom:
    """Return the boom with doublers on the outer halves of the flanges at the head."""
    strips = Collar((9.6, 10.0), 0.008, walls=("top", "bottom"), across=(0.06, 0.14))
    return replace(boom, segments=(replace(boom.segments[0], collars=(strips,)), boom.segments[1]))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pad", "change"),
    [
        (Pad(0.2, 0.04, offset=0.03), lambda boom: boom),
        (Pad(0.1, 0.06), with_collar),
        (Pad(0.1, 0.06), with_strips),
    ],
    ids=["away from the webs", "under a collar", "under strips"],
)
def test_estimated_compliance_follows_shell(pad: Pad, change: Callable[[Boom], Boom]) -> None:
    """Reference: other code, the shell, whose own error of the local compliance is 2 %."""
    boom = change(short_boom(pad))
    shell = reduced(boom, 0.2, contact_tolerance=0.02)
    walls = contact_compliance(boom)
    opening = walls[::2, ::2] + walls[1::2, 1::2] - walls[::2, 1::2] - walls[1::2, ::2]
    estimated = 0.5 * np.diag(opening)
    assert estimated == pytest.approx(shell.local_compliance[::2], rel=0.03)


@pytest.mark.slow
def test_a_pad_on_the_corners_bends_no_wall() -> None:
    """Reference: other code path, stations at pad centres; narrow pads are a bit softer."""

    def local(boom: Boom) -> float:
        return float(reduced(boom, 0.2, contact_tolerance=0.05).local_compliance.max())

    boom = short_boom(Pad(0.1, 0.06, bears="corner"))
    stations = replace(boom.joints[0], stations=(9.05, 9.95), pad=None, contact_length=0.1)
    on_corners = local(boom)
    of_stations = local(replace(boom, joints=(stations,)))
    assert on_corners == pytest.approx(of_stations, rel=5.0e-4, abs=0.0)
    wide, narrow = (local(short_boom(Pad(0.1, width))) for width in (0.06, 0.01))
    assert on_corners < narrow < wide
    assert on_corners < 0.1 * wide
    assert not contact_compliance(boom).any()

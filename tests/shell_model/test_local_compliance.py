# SPDX-License-Identifier: LGPL-3.0-or-later
"""Local compliance of walls and distortion of sections at contacts, with the estimates of beams."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.calibration import effective_stiffness, residual_compliance
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.statics import static_state
from protractile.beam_model.wall_compliance import contact_compliance, station_compliance
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.excitation import Step
from protractile.geometry.boom import Boom, Collar, Pad, Stop, Support
from protractile.geometry.load import Load
from protractile.geometry.probe_responses import PROBE_FREQUENCY
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import EACH_SIDE
from protractile.shell_model.boom_shell import ShellOptions, assemble_segments
from protractile.shell_model.contact.local_compliance import (
    SLOW,
    probe_loads,
    probe_responses,
    shell_compliance,
)
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from studies.polygon_distortion import CASES, Case, of_beam, of_shell, opening
from tests.shell_model.booms import (
    LATERAL_LAW,
    LAW,
    boom_in_space,
    box_segment,
    flat_boom,
    reduce_quickly,
    reduced,
    three_segments,
)
from tests.touching import touching


@pytest.mark.slow
def test_no_rigid_motion_fills_it_and_its_mesh_error_is_known() -> None:
    """Reference: analytic, the shift has no effect; other code, the mesh of twice the edges."""
    coarse, shell = (reduced(flat_boom(), size, moments=2, whole=True) for size in (0.8, 0.4))
    change = 1.0 - coarse.local_compliance / shell.local_compliance
    assert shell.mesh_error == pytest.approx(change.max(), rel=1.0e-4)
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
def test_bonded_joints_and_stops_have_no_measure() -> None:
    """Reference: the boom without them; one side alone has no local compliance."""
    boom = three_segments()
    bonded = replace(boom.joints[0], bonded=True)
    stop = Stop(2, 21.0, 0.2, PowerContact(0.0, 1.0, stiffness_below=1.0e7))
    held = replace(boom, joints=(bonded, boom.joints[1]), stops=(stop,))
    found, expected = (reduced(one, 0.8, whole=True) for one in (held, boom))
    *of_joint, of_stop = found.local_compliance
    assert of_joint == pytest.approx(expected.local_compliance[4:], rel=1.0e-3)
    assert np.isnan(of_stop)
    assert found.mesh_error <= expected.mesh_error * (1.0 + 1.0e-6)
    alone = replace(flat_boom(), joints=(replace(flat_boom().joints[0], bonded=True),))
    assert np.isnan(reduced(alone, 0.8, whole=True).mesh_error)


@pytest.mark.slow
def test_plates_are_nearly_the_beam_of_their_section() -> None:
    """Reference: analytic, E J, G A_s of the shear flow, and Bredt's G J_t."""
    boom = boom_in_space()
    shells = assemble_segments(boom, ShellOptions(0.25), MPI.COMM_WORLD)
    for number, (segment, shell) in enumerate(zip(boom.segments, shells, strict=True)):
        loads = probe_loads(boom, number, shell)
        moved = shell_compliance(SymmetryReduction(shell), loads, PROBE_FREQUENCY)
        found = effective_stiffness(segment, probe_responses(boom, number, moved))
        planes = segment, segment.turned()
        for plane, bending, shear in zip(planes, found.bending, found.shear, strict=True):
            assert bending == pytest.approx(plane.bending_stiffness, rel=5e-3)
            assert shear == pytest.approx(plane.shear_stiffness, rel=0.3)
        bredt = segment.material.shear_modulus * segment.lateral.torsion_constant
        assert found.torsion == pytest.approx(bredt, rel=0.01)


SUPPORTS = (Support(7.0), Support(8.0))
CORNER_PAD = Pad(0.15, 0.05, bears="corner")


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
        reduced(short_boom(None), 0.2, contact_tolerance=tolerance).local_compliance[0]
        for tolerance in (None, 0.2, 0.05)
    )
    limit = fine + (fine - coarse) / 3.0
    assert fine == pytest.approx(limit, rel=0.05)
    assert coarse == pytest.approx(limit, rel=0.2)
    assert uniform < 0.9 * limit


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pad", "collars"),
    [
        (Pad(0.2, 0.04, offset=0.03), ()),
        (Pad(0.1, 0.06), (Collar((9.6, 10.0), 0.008, ("top", "bottom"), (0.06, 0.14)),)),
    ],
    ids=["away from the webs", "under strips"],
)
def test_estimated_compliance_follows_shell(pad: Pad, collars: tuple[Collar, ...]) -> None:
    """Reference: other code, the shell, whose own error of the local compliance is 5 %."""
    boom = short_boom(pad)
    outer, inner = boom.segments
    boom = replace(boom, segments=(replace(outer, collars=collars), inner))
    shell = reduced(boom, 0.2, contact_tolerance=0.05)
    estimated = opening(contact_compliance(boom))
    assert estimated == pytest.approx(shell.local_compliance[::2], rel=0.03)


@pytest.mark.slow
def test_a_pad_on_the_corners_bends_no_wall() -> None:
    """Reference: other code path, stations at pad centres; on walls a pad is far softer."""
    boom = short_boom(Pad(0.1, 0.06, bears="corner"))
    stations = replace(boom.joints[0], stations=(9.05, 9.95), pad=None, contact_length=0.1)
    on_corners, of_stations, on_walls = (
        reduced(one, 0.2, contact_tolerance=0.2).local_compliance.max()
        for one in (boom, replace(boom, joints=(stations,)), short_boom(Pad(0.1, 0.06)))
    )
    assert on_corners == pytest.approx(of_stations, rel=5.0e-3, abs=0.0)
    assert on_corners < 0.1 * on_walls
    assert not contact_compliance(boom).any()


@pytest.mark.slow
def test_an_octagonal_mast_distorts_in_both_planes() -> None:
    """Reference: other code, a shell. Rigid sections give a quarter less along z."""
    outer = octagon(0.5, 0.5, 0.14, 0.005, 0.005, 0.005)
    case = Case(outer, octagon(0.44, 0.44, 0.125, *3 * [0.004]), CORNER_PAD, 1.1, 6.0)
    law = PowerContact(stiffness=1.9e9 * 0.15 * 0.05 / 0.02, exponent=1.0)
    joint = replace(case.boom.joints[0], lateral_play=0.004, contact=law, lateral_contact=law)
    loads = Load(1, "z", -5000.0, 10.9, Step()), Load(1, "y", 1500.0, 10.9, Step())
    boom = replace(case.boom, joints=(joint,), loads=loads)
    shell = reduce_quickly(boom, ShellOptions(0.25)).system.gather_loads()
    state, rigid = static_state(boom), static_state(boom, walls=0.0)
    states = [(shell, equilibrium_at(shell, 0.0))]
    states += [(one.system, one.position) for one in (state, rigid)]
    for name in ("tip", "tip_lateral"):
        expected, found, undistorted = (
            float(system.observers[name].row @ position) for system, position in states
        )
        assert found == pytest.approx(expected, rel=0.1), name
        assert abs(undistorted - expected) > 0.2 * abs(expected)
    expected, found, undistorted = (closed_contact_modes(*one)[0][0] for one in states)
    assert found == pytest.approx(expected, rel=0.05)
    assert undistorted > 1.1 * expected


@pytest.mark.slow
@pytest.mark.parametrize("shape", ["folded bottom", "taper"])
def test_other_sections_distort_as_their_shells(
    shape: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: other code, a shell. Rigid sections make the tip at least a quarter too stiff."""
    monkeypatch.setattr("studies.polygon_distortion.reduce_boom", reduce_quickly)
    if shape == "folded bottom":
        outer = u_section(0.50, 0.34, 0.15, 3, top=0.008, bottom=0.006, web=0.006)
        inner = u_section(0.44, 0.28, 0.12, 3, top=0.006, bottom=0.005, web=0.005)
        boom = Case(outer, inner, Pad(0.2, 0.04, bears="corner")).boom
    else:
        boom = CASES["hexagons, pads on corners"].boom
        head = hexagon(0.37, 0.25, 0.16, 0.007, 0.009, 0.006)
        inner = replace(boom.segments[1], head_section=head)
        boom = replace(boom, segments=(boom.segments[0], inner))
    shell, beam = of_shell(boom, 0.15 if shape == "folded bottom" else 0.12), of_beam(boom)
    assert beam.stations == pytest.approx(shell.stations, rel=0.08)
    assert beam.tip == pytest.approx(shell.tip, rel=0.03)
    assert abs(static_state(boom, walls=0.0).tip) < 0.75 * abs(shell.tip)


@pytest.mark.slow
def test_a_box_racks_under_forces_on_single_corners_as_its_shell() -> None:
    """Reference: other code, a shell. Equal forces on both corners of a side rack no box."""
    boom = touching(boom_in_space(), LAW, LATERAL_LAW)
    elements = finite_element_segments(boom, 0.25, "timoshenko", True)
    shell = reduce_quickly(boom, ShellOptions(0.15)).system.gather_loads()
    contacts = slice(len(shell.laws))
    residual = residual_compliance(gap_system(boom, elements, EACH_SIDE), shell)
    expected = np.diag(residual[contacts, contacts])
    assert np.diag(contact_compliance(boom)) == pytest.approx(expected, rel=0.06)
    closed = station_compliance(boom, np.full(len(expected), 1e9))
    pads = len(expected) / len(closed.places)
    np.testing.assert_allclose(
        closed.compliance, 1e-9 / pads * np.eye(len(closed.places)), atol=1e-15
    )

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact over the whole overlap, pads as patches, and rows that read a wall anywhere."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Pad, SlidePad
from protractile.geometry.contact_places import ContactLine
from protractile.geometry.contact_places import pads as places_of_pads
from protractile.geometry.joint import POLYAMIDE, PadSide
from protractile.shell_model.boom_shell import ShellOptions, assemble_segments
from protractile.shell_model.contact.rows import ShellContacts
from protractile.shell_model.contact.surface import SurfaceOptions, without_stiff_modes
from protractile.shell_model.contact.wall_rows import Wall, WallPoints
from protractile.shell_model.reduction.segment import ReducedSegment
from protractile.shell_model.segment.cross_section import COMPONENT
from tests.shell_model.booms import (
    LAW,
    boom_in_space,
    contact_forces,
    flat_boom,
    reduced,
    rigid_state,
)
from tests.shell_model.conftest import BOX, box_shell
from tests.touching import touching

FEW = SurfaceOptions(points=(4, 2))


def _system(
    boom: Boom,
    line: ContactLine = "surface",
    surface: SurfaceOptions = FEW,
    law: PowerContact = LAW,
) -> GapSystem:
    return reduced(boom, 0.5, line, law=law, surface=surface).system


def _with_pads(boom: Boom) -> Boom:
    return replace(boom, joints=(replace(boom.joints[0], pad=Pad(length=0.1, width=0.06)),))


@pytest.mark.parametrize("wall", [Wall("y", 1), Wall("z", -1)], ids=str)
def test_a_row_reads_a_quadratic_field_anywhere_on_a_wall(wall: Wall) -> None:
    """Reference: analytic, the polynomial at nodes, on edges and between them; NaN elsewhere."""
    shell = box_shell(0.5)
    half = 0.5 * (BOX.width if wall.normal == "z" else BOX.height)
    places = np.array(
        [[3.21, 0.3 * half], [0.0, -half], [10.0, half], [5.0, 0.0], [7.77, -0.9 * half]]
    )

    def polynomial(x: Array, s: Array) -> Array:
        return 1.0 + 2.0 * x - x * s + 3.0 * s**2 + 0.1 * x**2

    on_wall = np.sign(shell.nodes[:, COMPONENT[wall.normal]]) == wall.side
    given = np.where(on_wall, polynomial(shell.nodes[:, 0], shell.nodes[:, wall.across]), np.nan)
    field = np.full(shell.num_dofs, np.nan)
    for component, factor in (("y", 1.0), ("z", -2.0)):
        field[shell.node_dofs[:, COMPONENT[component]]] = factor * given
        found = [
            sum(weight * field[dof] for dof, weight in row.items())
            for row in WallPoints(shell).rows(wall, places, component)
        ]
        assert found == pytest.approx(factor * polynomial(*places.T), rel=1.0e-11)


@pytest.mark.slow
def test_a_uniform_approach_presses_as_the_stations_do() -> None:
    """Reference: analytic, (4) at both stations. The resultant is at the centre of the overlap."""
    law = replace(LAW.law, stiffness_below=0.5e13).with_clearance(LAW.above)
    system = _system(flat_boom(), law=law)
    depth = 2.0e-3
    # A turn about the middle of the overlap, whose ends are at 9, 10 and 19 m.
    turn = rigid_state(system, {"tip": 9.5, "tail": -0.5})
    for side, stiffness in ((1.0, 2.0e13), (-1.0, 1.0e13)):
        heave = side * (LAW.above + depth)
        force = contact_forces(system, rigid_state(system, {"tip": heave, "tail": heave}))
        assert np.bincount(system.station_of_row, force != 0.0).tolist() == [4, 4]
        assert force.sum() == pytest.approx(side * stiffness * depth**2, rel=1.0e-6)
        assert abs(force @ (system.rows @ turn)) < 1.0e-6 * abs(force.sum())


@pytest.mark.slow
def test_a_tilted_approach_presses_as_its_integral() -> None:
    """Reference: analytic, ∫ k_A b (θ x)² dx = k_A b θ² L³/3 over the overlap, k_A given."""
    given = 3.0e14
    system = _system(flat_boom(), surface=SurfaceOptions((4, 2), stiffness=given))
    tilt = 1.0e-3
    state = rigid_state(system, {"tip": LAW.above + 10.0 * tilt, "tail": LAW.above})
    section = flat_boom().segments[1].section
    expected = given * section.width * tilt**2 / 3.0
    assert contact_forces(system, state).sum() == pytest.approx(expected, rel=1.0e-6)


@pytest.mark.slow
def test_in_space_each_point_presses_one_corner() -> None:
    """Reference: analytic. Each flange resists roll with ∫ k_A y² dA = k_A L b³/12."""
    system = _system(boom_in_space(friction=0.2))
    pressing = sorted(row for friction in system.frictions for row in friction.normal_rows)
    assert pressing == list(range(len(system.laws))) == list(range(4 * 16))
    assert len(system.frictions) == 16
    along_z = np.array(system.station_directions)[system.station_of_row] == "z"
    still = dict.fromkeys(("tip", "tail", "tip_lateral", "tail_lateral"), 0.0)
    state = rigid_state(system, still | {"tip_twist": 1.0})
    arms = system.rows @ state
    section = flat_boom().segments[1].section
    for walls, size in ((along_z, section.width), (~along_z, section.height)):
        sides, stiffnesses = np.array([w.terms[0][:2] for w in system.laws])[walls].T
        above = np.where(sides > 0.0, stiffnesses, 0.0)
        assert above.sum() == pytest.approx(2.0e13)
        assert above @ arms[walls] ** 2 == pytest.approx(2.0e13 * size**2 / 12.0, rel=1.0e-6)


@pytest.mark.slow
def test_pads_take_the_place_of_points_one_by_one() -> None:
    """Reference: analytic. A rigid motion is read at the middle of the patch."""
    boom = boom_in_space(0.2)
    plain, padded = _system(boom, "near webs"), _system(_with_pads(boom), "near webs")
    assert padded.laws == plain.laws
    assert padded.frictions == plain.frictions
    still = {"tip_lateral": 0.0, "tail_lateral": 0.0, "tip_twist": 0.0}
    along_z = np.array(padded.station_directions)[padded.station_of_row] == "z"
    turned, lifted = (
        (padded.rows @ rigid_state(padded, still | {"tip": tip, "tail": tail})).round(9)
        for tip, tail in ((10.0, 0.0), (1.0, 1.0))
    )
    assert set(np.abs(turned[along_z])) == {0.05, 0.95}
    assert set(np.abs(lifted[along_z])) == {1.0}
    assert not turned[~along_z].any()


def test_several_pads_are_rows_of_their_own() -> None:
    """Reference: by hand, the mean (b³ − a³)/3(b − a) per pad; weights as stiffnesses."""
    boom = boom_in_space()
    sides: tuple[PadSide, ...] = ("above", "below", "left", "right")
    pads = tuple(
        SlidePad(0.1, width, offset, side=side, thickness=POLYAMIDE * 0.1 * width / stiffness)
        for side in sides
        for width, offset, stiffness in ((0.03, 0.0, 3e8), (0.02, 0.05, 1e8))
    )
    boom = replace(boom, joints=(replace(boom.joints[0], pads=pads),))
    shells = assemble_segments(boom, ShellOptions(mesh_size=0.4), MPI.COMM_SELF)
    seen = touching(boom, LAW, LAW)
    rows = ShellContacts.from_shells(seen, shells, "near webs", SurfaceOptions()).rows({})
    inner, places = shells[1], places_of_pads(boom)
    assert len(rows.contacts) == 4 * len(pads)
    for contact, pad in zip(rows.contacts, places, strict=True):
        across = COMPONENT["y" if pad.station.direction == "z" else "z"]
        moved = np.zeros(inner.free.size)
        moved[inner.node_dofs[:, COMPONENT[pad.station.direction]]] = inner.nodes[:, across] ** 2
        near, far = pad.patch.across(inner.segment.section.face(pad.station.direction, pad.side))
        mean = (far**3 - near**3) / (3.0 * (far - near))
        assert inner.row(contact.operator[1]) @ moved == pytest.approx(mean, rel=1e-9)
        share = 0.375 if pad.patch.offset == 0.0 else 0.125
        assert contact.law.terms[0].stiffness == pytest.approx(share * LAW.law.stiffness)


def test_modes_without_compliance_are_left_out() -> None:
    """Reference: by hand, rows of 1 in each mode. The second row reads no stiff mode."""
    omega2, none = np.array([0.0, 1.0, 100.0, 1.0e6, 1.0e8]), np.zeros(0)
    square = np.eye(5)
    whole = ReducedSegment(
        omega2, square, 0.0, 0.0, np.ones(3), np.diag(omega2), square[:, :4], none, 9.0
    )
    rows = np.array([np.ones(5), [1.0, 1.0, 1.0, 0.0, 0.0]]).T
    kept = without_stiff_modes(MPI.COMM_SELF, whole, rows)
    assert kept.omega2.tolist() == [0.0, 1.0, 100.0]
    assert kept.shapes.shape == (5, 3)
    np.testing.assert_array_equal(kept.geometric, np.diag(kept.omega2))
    np.testing.assert_allclose(np.abs(kept.coarser), np.eye(3), atol=1e-15)
    np.testing.assert_allclose(kept.lost_compliance, [1.0 + 1.01e-6, 1.0, 1.0], rtol=1e-12)
    assert kept.compliance_error == pytest.approx(1.01e-6 / 1.01000101, rel=1e-9)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The shell of a segment, of boxes and of polygons, and its supports."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.finite_element import finite_element_segment
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import PointMass, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.contact_places import ContactInterval
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.section import Section
from protractile.shell_model.contact.wall_rows import CornerLines, Wall, WallPoints
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from protractile.shell_model.segment.cross_section import Row
from studies import sections
from tests.beam_model.exact import frequencies
from tests.shell_model.booms import (
    HELD,
    STEEL,
    assert_rests_as_beams,
    box_segment,
    flat_boom,
    reduce_segment,
    reduced,
    two_segments,
)
from tests.shell_model.conftest import BOX, UNEQUAL, box_shell, compliance

YOUNG, SHEAR = STEEL.youngs_modulus, STEEL.shear_modulus


@pytest.mark.slow
def test_a_clamped_box_bends_and_twists_as_a_cantilever() -> None:
    """Reference: analytic, L³/3EJ + L/GA along z and y, Bredt's L/GJ_t; shear is 0.5 %."""
    shell = box_shell(0.25, supports=(Support(0.0, "clamped"),))
    end = shell.outline(10.0)
    bending = 10.0**3 / (3.0 * YOUNG)
    expected = [
        bending / BOX.second_moment_of_area + 10.0 / (SHEAR * BOX.shear_area),
        bending / BOX.lateral_second_moment_of_area + 10.0 / (SHEAR * BOX.lateral_shear_area),
        10.0 / (SHEAR * BOX.torsion_constant),
    ]
    rows = end.wall_deflection("z"), end.wall_deflection("y"), end.twist()
    assert [compliance(shell, row) for row in rows] == pytest.approx(expected, rel=2.5e-3)


@pytest.mark.slow
def test_elastic_supports_give_way_by_their_reactions() -> None:
    """Reference: analytic, (4² + 5²)/k beyond rigid supports; Bredt's twist from 2 m to the end."""
    springs = tuple(Support(x, stiffness=1.0e6) for x in (0.0, 2.0))
    shells = [box_shell(0.25, supports=one) for one in (HELD, springs)]
    ends = [shell.outline(10.0) for shell in shells]
    rigid, elastic = (
        np.array([compliance(shell, row) for row in (*map(end.wall_deflection, "zy"), end.twist())])
        for shell, end in zip(shells, ends, strict=True)
    )
    assert (elastic - rigid)[:2] == pytest.approx(41.0e-6, rel=1.0e-3)
    bredt = 8.0 / (SHEAR * BOX.torsion_constant)
    assert [rigid[2], elastic[2]] == pytest.approx([bredt, bredt], rel=2.0e-3)


def test_supports_leave_unheld_rigid_motions_free() -> None:
    """Reference: analytic, sliding along x but for a clamp, both rotations of one pin."""
    left = {
        (): 6, (Support(0.0),): 3, (Support(0.0, stiffness=10.0),): 3, HELD: 1,
        (Support(0.0, stiffness=10.0), Support(2.0)): 1, (Support(2.0, "clamped"),): 0,
    }  # fmt: skip
    for supports, count in left.items():
        assert box_shell(0.5, supports=supports).rigid_motions().shape[1] == count


@pytest.mark.slow
def test_frequencies_with_a_tip_mass_are_the_beams_in_each_plane() -> None:
    """Reference: other code, Timoshenko elements; 0.2 %, the second mode 1.3 %."""
    masses = (PointMass(10.0, 200.0),)
    shell = box_shell(0.25, supports=HELD, masses=masses)
    beam = replace(box_segment("beam", 0.0, 10.0, BOX, supports=HELD), masses=masses)
    elements = finite_element_segment(beam, 0.25, (), "timoshenko", rotary_inertia=True)
    for direction in ("z", "y"):
        push = shell.row(shell.outline(10.0).wall_deflection(direction))[:, None]
        reduced = reduce_segment(SymmetryReduction(shell), push, KrylovOptions(moments=2))
        expected = frequencies(elements.components[direction])
        assert np.sqrt(reduced.omega2[0]) == pytest.approx(expected[0], rel=4.0e-3)
        assert np.sqrt(reduced.omega2[1]) == pytest.approx(expected[1], rel=2.0e-2)


LINEAR = sections.LAW
(HEXAGON, _), (OCTAGON, _), (U, INNER_U) = sections.SHAPES.values()
UNEQUAL_BOXES = UNEQUAL, BoxSection(0.46, 0.28, flange=0.008, web=0.005, bottom_flange=0.005)
SECTIONS = pytest.mark.parametrize(
    "section", [HEXAGON, OCTAGON, U, UNEQUAL], ids=["hexagon", "octagon", "u", "unequal box"]
)


def _read(row: Row, field: Array) -> float:
    return sum(weight * field[dof] for dof, weight in row.items())


@pytest.mark.slow
@SECTIONS
def test_rows_read_rigid_motions(section: Section) -> None:
    """Reference: analytic, 1 m along y and z, twist and pitch of 1 rad about the end."""
    shell = box_shell(0.5, section=section)
    outline = shell.outline(10.0)
    rows = (
        outline.wall_deflection("y"), outline.wall_deflection("z"), outline.twist(),
        outline.rotation(), outline.mean_deflection(), outline.distortion(),
    )  # fmt: skip
    x, y, z = shell.nodes.T
    for motion, expected in (
        ((0 * x, 1 + 0 * x, 0 * x), [1, 0, 0, 0, 0, 0]),
        ((0 * x, 0 * x, 1 + 0 * x), [0, 1, 0, 0, 1, 0]),
        ((0 * x, -z, y), [0, 0, 1, 0, 0, 0]),
        ((-z, 0 * x, x - 10.0), [0, 0, 0, 1, 0, 0]),
    ):
        field = np.zeros(shell.num_dofs)
        field[shell.node_dofs] = np.transpose(motion)
        assert [_read(row, field) for row in rows] == pytest.approx(expected, abs=1e-9)


@pytest.mark.slow
@SECTIONS
def test_contacts_read_the_true_faces(section: Section) -> None:
    """Reference: analytic. Displacements u_z = z and u_y = y give the position of each face."""
    shell = box_shell(0.5, section=section)
    field = np.zeros(shell.num_dofs)
    field[shell.node_dofs[:, 1:]] = shell.nodes[:, 1:]
    corners, walls = CornerLines(shell), WallPoints(shell)
    stretch = ContactInterval.from_station(shell.segment, 5.0, 0.7)
    for face in section.faces:
        offsets = (0.0, face.side) if face.direction == "z" else (face.side, 0.0)
        row = corners.deflection(stretch, face.direction, *offsets)
        assert _read(row, field) == pytest.approx(face.offset, rel=1.0e-9)
        place = np.array([[5.03, 0.5 * (face.low + face.high) + 0.011]])
        (row,) = walls.rows(Wall(face.direction, face.side), place, face.direction)
        assert _read(row, field) == pytest.approx(face.offset, rel=1.0e-9)


@pytest.mark.slow
def test_a_box_written_as_a_polygon_is_the_box() -> None:
    """Reference: other code, the box: frequencies and compliances of rows."""
    boxes = BoxSection(0.50, 0.32, 0.008, 0.006), BoxSection(0.46, 0.28, 0.006, 0.005)
    polygons = [
        PolygonSection(
            tuple(plate.start for plate in box.plates),
            tuple(plate.thickness for plate in box.plates),
        )
        for box in boxes
    ]
    assert polygons[0].shear_area != boxes[0].shear_area
    box, polygon = (
        replace(flat_boom(), segments=two_segments(*pair)) for pair in (boxes, polygons)
    )
    first, second = (reduced(boom, 0.5, law=LINEAR).system for boom in (box, polygon))
    assert second.omega2 == pytest.approx(first.omega2, rel=1e-9, abs=1e-6)
    assert _compliance(second) == pytest.approx(_compliance(first), rel=1e-9)


def _compliance(system: GapSystem) -> Array:
    """Return the compliance of rows and tip at σ = 1e4 rad²/s²."""
    rows = np.vstack([system.rows, system.observers["tip"].row])
    return np.asarray(rows / (system.omega2 + 1.0e4) @ rows.T)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pair", "rel"),
    [((U, INNER_U), 1.5e-2), (UNEQUAL_BOXES, 5.0e-3)],
    ids=["u", "unequal box"],
)
def test_a_pressed_boom_rests_as_its_beams_do(pair: tuple[Section, Section], rel: float) -> None:
    """Reference: other code, bonded Timoshenko elements; boxes are 0.25 % apart without collars."""
    plain = sections.boom_of(*pair)
    assert_rests_as_beams(reduced(plain, 0.25, law=LINEAR).system, plain, rel)

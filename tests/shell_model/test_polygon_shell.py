# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells of polygons: folds, inclined walls, stations and stiffeners on them."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import (
    Boom,
    Collar,
    Diaphragm,
    Direction,
    Pad,
    PointMass,
    Stop,
    Support,
)
from protractile.geometry.box import BoxSection
from protractile.geometry.contact_places import ContactInterval, ContactLine
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.section import Section
from protractile.shell_model.contact.wall_rows import CornerLines, Wall, WallPoints
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from protractile.shell_model.segment.cross_section import Row
from studies import sections
from tests.shell_model.booms import (
    STEEL,
    assert_rests_as_beams,
    flat_boom,
    frequencies_off,
    reduce_segment,
    reduced,
    two_segments,
)
from tests.shell_model.conftest import BOX, UNEQUAL, box_shell

LINEAR = sections.LAW
(HEXAGON, INNER_HEXAGON), (OCTAGON, INNER_OCTAGON), (U, INNER_U) = sections.SHAPES.values()
SECTIONS = {"hexagon": HEXAGON, "octagon": OCTAGON, "u": U}
UNEQUAL_BOXES = UNEQUAL, BoxSection(0.46, 0.28, flange=0.008, web=0.005, bottom_flange=0.005)


def _read(row: Row, field: Array) -> float:
    return sum(weight * field[dof] for dof, weight in row.items())


@pytest.mark.slow
@pytest.mark.parametrize("name", SECTIONS)
def test_rows_read_rigid_motions(name: str) -> None:
    """Reference: analytic. Translations give their own size, a rotation φ gives the twist φ."""
    section = SECTIONS[name]
    shell = box_shell(0.5, section=section)
    outline = shell.outline(10.0)
    y, z = shell.nodes[:, 1], shell.nodes[:, 2]
    motions = {"y": (np.ones_like(y), 0 * y), "z": (0 * y, np.ones_like(y)), "twist": (-z, y)}
    expected = {
        "y": {"y": 1.0, "z": 0.0, "twist": 0.0},
        "z": {"y": 0.0, "z": 1.0, "twist": 0.0},
        "twist": {"y": 0.0, "z": 0.0, "twist": 1.0},
    }
    for motion, (u_y, u_z) in motions.items():
        field = np.zeros(shell.num_dofs)
        field[shell.node_dofs[:, 1]], field[shell.node_dofs[:, 2]] = u_y, u_z
        found = {axis: _read(outline.wall_deflection(axis), field) for axis in ("y", "z")}
        found["twist"] = _read(outline.twist(), field)
        assert found == pytest.approx(expected[motion], abs=1e-9)
        assert _read(outline.distortion(), field) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.slow
@pytest.mark.parametrize("section", [*SECTIONS.values(), UNEQUAL], ids=[*SECTIONS, "unequal box"])
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
@pytest.mark.parametrize(
    ("section", "direction"),
    [(HEXAGON, "z"), (OCTAGON, "y"), (U, "z"), (UNEQUAL, "z")],
    ids=["hexagon", "octagon on its side", "u", "unequal box"],
)
def test_a_free_segment_vibrates_as_its_beam(section: Section, direction: Direction) -> None:
    """Reference: other code, Timoshenko elements, within 0.3 %. A tenth of J would change 5 %."""
    off = frequencies_off(box_shell(0.25, section=section), direction)
    assert off == pytest.approx(0, abs=6e-3)


@pytest.mark.slow
def test_a_segment_on_its_side_vibrates_along_y_as_upright_along_z() -> None:
    """Reference: symmetry. The mesh lies on its side, too: only round-off differs."""
    upright, lying = (box_shell(0.5, section=one) for one in (HEXAGON, HEXAGON.turned()))
    found = []
    for shell, direction in ((upright, "z"), (lying, "y")):
        inputs = shell.unit_loads[direction][:, None]
        found.append(reduce_segment(SymmetryReduction(shell), inputs, KrylovOptions()).omega2)
    assert found[1] == pytest.approx(found[0], rel=1e-6, abs=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", SECTIONS)
def test_pressed_ring_deforms_as_a_frame(name: str) -> None:
    """Reference: other code, a plane frame of bars; a ring of 80 mm is 3 % stiffer."""
    section = SECTIONS[name]
    expected = sections.ring_of_bars(section, 0.02)
    assert sections.ring_of_shell(section, 0.02, 0.01) == pytest.approx(expected, rel=2e-3)
    assert sections.ring_of_shell(section, 0.08, 0.02) < 0.98 * sections.ring_of_bars(section, 0.08)


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
    """Return the compliance of rows, tip and, if any, its twist at σ = 1e4 rad²/s²."""
    tips = [system.observers[name].row for name in ("tip", "tip_twist") if name in system.observers]
    rows = np.vstack([system.rows, *tips])
    return np.asarray(rows / (system.omega2 + 1.0e4) @ rows.T)


def _upside_down(section: PolygonSection) -> PolygonSection:
    return PolygonSection(tuple((y, -z) for y, z in section.corners), section.thicknesses)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pair", "rel"),
    [((HEXAGON, INNER_HEXAGON), 1.5e-2), ((U, INNER_U), 1.5e-2), (UNEQUAL_BOXES, 5.0e-3)],
    ids=["hexagon", "u", "unequal box"],
)
def test_a_pressed_boom_rests_as_its_beams_do(pair: tuple[Section, Section], rel: float) -> None:
    """Reference: other code, bonded Timoshenko elements; boxes are 0.25 % apart without collars."""
    plain = sections.boom_of(*pair)
    assert_rests_as_beams(reduced(plain, 0.25, law=LINEAR).system, plain, rel)


@pytest.mark.slow
def test_thicker_flanges_give_way_less() -> None:
    """Reference: analytic, by order: thicker upper flanges; equal flanges give way alike."""
    compliances = []
    for pair in ((BOX, replace(BOX, height=0.46, width=0.28)), UNEQUAL_BOXES):
        boom = _laden(sections.boom_of(*pair), "near webs")
        found = reduced(boom, 0.5, law=LINEAR, contact_tolerance=1.0)
        assert np.isfinite(found.local_compliance).all()
        rows, squares = found.system.rows[:2], found.system.omega2
        # At 9 m up and down, beyond slow motion of the segments.
        compliances.append((rows**2 / (squares + 1e6)).sum(axis=1))
    (equal_above, equal_below), (above, below) = compliances
    assert equal_above == pytest.approx(equal_below, rel=1.0e-6)
    assert above < 0.99 * below


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pair", "line"),
    [
        ((OCTAGON, INNER_OCTAGON), "near webs"),
        *(((U, INNER_U), line) for line in ("across", "surface")),
    ],
    ids=["octagon", "u-across", "u-surface"],
)
def test_polygon_segment_with_attachments(pair: tuple[Section, Section], line: ContactLine) -> None:
    """Reference: analytic, the masses of a rigid motion along z, on any outline."""
    boom = _laden(sections.boom_of(*pair), line)
    found = reduced(boom, 0.5, line, law=LINEAR, contact_tolerance=1.0)
    assert np.isfinite(found.local_compliance[:-2]).all() or line == "surface"
    inner = boom.segments[1]
    section = inner.section
    mass = STEEL.density * (
        section.area * 10.0 + section.perimeter * 0.004 * 0.5 + section.enclosed_area * 0.005
    )
    rigid = np.flatnonzero(found.system.omega2 == 0.0)
    rows = [found.system.observers[name].row[rigid] for name in ("tip", "tail")]
    motion = np.linalg.solve(rows, [1.0, 1.0])
    assert motion @ motion == pytest.approx(mass + 50.0, rel=1e-6)


def _laden(boom: Boom, line: ContactLine) -> Boom:
    outer, inner = boom.segments
    outer = replace(outer, supports=(Support(0.0), Support(2.0, stiffness=1.0e8)))
    inner = replace(
        inner,
        collars=(Collar((9.0, 9.5), 0.004),),
        masses=(PointMass(19.0, 50.0),),
        diaphragms=(Diaphragm(18.5, 0.005),),
    )
    pads = Pad(0.1, 0.03, 0.01) if line == "near webs" else None
    joints = (replace(boom.joints[0], pad=pads),)
    stops = (Stop(1, 18.0, 0.02, PowerContact(1.0e8, 1.0, stiffness_below=1.0e8)),)
    return replace(boom, segments=(outer, inner), joints=joints, stops=stops)

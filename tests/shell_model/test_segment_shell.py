# SPDX-License-Identifier: LGPL-3.0-or-later
"""The shell of a segment, of boxes and of polygons, and its supports."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.finite_element import Theory, finite_element_segment
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
from protractile.shell_model.segment.solver import times
from studies import sections
from studies.reference_models.shell_readings import flange_deflection
from studies.reference_models.single_segment import natural_frequencies
from tests.beam_model.exact import frequencies
from tests.shell_model.booms import (
    HELD,
    STEEL,
    assert_rests_as_beams,
    box_segment,
    flat_boom,
    frequencies_off,
    reduce_segment,
    reduced,
    two_segments,
)
from tests.shell_model.conftest import BOX, UNEQUAL, box_shell, compliance


def test_rigid_motions_carry_the_mass_of_the_box() -> None:
    """Reference: analytic, ρ A L and ρ (J_y + J_z) L, except for the effect (t/h)² of corners."""
    shell = box_shell(0.25)
    motions = shell.rigid_motions()
    masses = (motions.T @ times(shell.mass, motions)).diagonal()
    mass = STEEL.density * BOX.area * 10.0
    polar = BOX.second_moment_of_area + BOX.lateral_second_moment_of_area
    assert masses[:3] == pytest.approx([mass] * 3, rel=1.0e-12)
    assert masses[3] == pytest.approx(STEEL.density * polar * 10.0, rel=5.0e-4)


@pytest.mark.slow
def test_free_box_vibrates_as_a_timoshenko_beam_at_long_wavelength() -> None:
    """Reference: other code, Timoshenko elements; errors fall with the square of the wavelength."""
    differences = []
    for length in (10.0, 20.0):
        measured = natural_frequencies(box_shell(0.2, length=length), 10)
        assert measured[:6] == pytest.approx(np.zeros(6), abs=1.0e-3)
        euler, timoshenko = (
            _free_beam_frequency(length, theory) for theory in ("euler-bernoulli", "timoshenko")
        )
        bending = measured[6:][np.argmin(np.abs(measured[6:] - timoshenko))]
        difference = abs(bending / timoshenko - 1.0)
        assert difference < 0.2 * (1.0 - timoshenko / euler)
        differences.append(difference)
    assert differences[1] < 1.0e-3
    assert np.log2(differences[0] / differences[1]) > 1.5


def _free_beam_frequency(length: float, theory: Theory) -> float:
    beam = box_segment("beam", 0.0, length, BOX)
    segment = finite_element_segment(beam, 0.05 * length, (), theory, theory == "timoshenko")
    return float(frequencies(segment.components["z"])[0] / (2.0 * np.pi))


def _overhang_compliance(size: float) -> float:
    shell = box_shell(size, supports=HELD)
    return compliance(shell, shell.outline(10.0).wall_deflection("z"))


@pytest.mark.slow
def test_static_compliance_is_timoshenkos() -> None:
    """Reference: analytic, a² (l + a) / 3EJ + (a + a²/l) / G A_web, l = 2 m, a = 8 m, within 0.1 %,
    a third of the effect of shear in the flanges.
    """
    bending = 64.0 * 10.0 / (3.0 * STEEL.youngs_modulus * BOX.second_moment_of_area)
    shear = (8.0 + 32.0) / (STEEL.shear_modulus * BOX.shear_area)
    assert shear > 0.02 * bending  # the tolerance is smaller than the effect
    coarse, fine = (_overhang_compliance(size) for size in (0.2, 0.1))
    assert fine == pytest.approx(bending + shear, rel=2.0e-3)
    assert abs(fine - coarse) < 2.0e-3 * fine
    assert fine > coarse  # refinement softens a conforming displacement model


def test_outline_rows_read_rigid_motions_exactly() -> None:
    """Reference: analytic, vertical translation and pitch; lateral translation, yaw and roll. In
    roll, (y, z) moves by φ (−z, y).
    """
    shell = box_shell(0.25)
    outline, corners = shell.outline(10.0), CornerLines(shell)
    at_end, within = (ContactInterval.from_station(shell.segment, x, 0.1) for x in (10.0, 7.3))
    in_plane = np.array([0.0, 0.0, 0.03, 0.0, -0.002, 0.0])
    lifted = 0.03 + 0.002 * 5.0
    rows = (
        outline.mean_deflection(), outline.wall_deflection("z"), outline.rotation(),
        outline.distortion(), flange_deflection(outline, 1.0, 0.1),
        flange_deflection(outline, -1.0, 0.5 * BOX.width), outline.twist(),
    )  # fmt: skip
    readings = [shell.row(row) @ shell.rigid_motions() @ in_plane for row in rows]
    expected = [lifted, lifted, 0.002, 0.0, lifted, lifted, 0.0]
    assert readings == pytest.approx(expected, abs=1.0e-12)

    sideways = np.array([0.0, 0.01, 0.0, 0.004, 0.0, 0.003])
    shifted = 0.01 + 0.003 * 5.0
    rows = (
        outline.mean_deflection("y"), outline.wall_deflection("y"), outline.twist(),
        outline.mean_deflection(), corners.deflection(at_end, "z", 0.1, -0.3),
        corners.deflection(at_end, "y", -0.1, 0.3), corners.deflection(within, "y", 0.1, 0.1),
    )  # fmt: skip
    readings = [shell.row(row) @ shell.rigid_motions() @ sideways for row in rows]
    within_shifted = 0.01 + 0.003 * 2.3
    expected = [shifted, shifted, 0.004, 0.0, 4.0e-4, shifted - 1.2e-3, within_shifted - 4.0e-4]
    assert readings == pytest.approx(expected, abs=1.0e-12)


@pytest.mark.slow
def test_a_length_of_a_corner_gives_way_alike_on_any_mesh() -> None:
    """Reference: analytic. With halved edges, changes decrease to a third for a force along a
    length, and stay equal for a point force.
    """
    section = BoxSection(0.2, 0.2, 0.006, 0.006)

    def local(size: float, length: float) -> float:
        shell = box_shell(size, 0.4, section=section)
        stretch = ContactInterval.from_station(shell.segment, 0.2, length)
        pressed = CornerLines(shell).deflection(stretch, "z", 0.0, 1.0)
        spread = shell.outline(0.4).wall_deflection("z"), shell.outline(0.0).wall_deflection("z")
        return compliance(shell, pressed - 0.5 * spread[0] - 0.5 * spread[1])

    lengths = {}
    for length in (0.1, 1.0e-4):
        values = [local(size, length) for size in (0.1, 0.05, 0.025, 0.0125)]
        lengths[length] = np.diff(values)
    assert (lengths[0.1][1:] < lengths[0.1][:-1] / 3.0).all()
    assert (lengths[1.0e-4][1:] > 0.7 * lengths[1.0e-4][:-1]).all()


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
@pytest.mark.parametrize("direction", ["z", "y"])
def test_elastic_supports_give_way_by_their_reactions(direction: Direction) -> None:
    """Reference: analytic, (4² + 5²) / k beyond rigid supports, from −4 and 5 times the force."""
    springs = tuple(Support(x, stiffness=1.0e6) for x in (0.0, 2.0))
    rigid, elastic = (
        compliance(shell, shell.outline(10.0).wall_deflection(direction))
        for shell in (box_shell(0.25, supports=HELD), box_shell(0.25, supports=springs))
    )
    assert elastic - rigid == pytest.approx(41.0e-6, rel=1.0e-3)


@pytest.mark.slow
def test_every_support_holds_the_twist() -> None:
    """Reference: analytic, Bredt, from the support at 2 m to the end."""
    springs = tuple(Support(x, stiffness=1.0e6) for x in (0.0, 2.0))
    for supports in (HELD, springs):
        shell = box_shell(0.25, supports=supports)
        expected = 8.0 / (SHEAR * BOX.torsion_constant)
        assert compliance(shell, shell.outline(10.0).twist()) == pytest.approx(expected, rel=2.0e-3)


def test_supports_leave_unheld_rigid_motions_free() -> None:
    """Reference: analytic, sliding along x but for a clamp, both rotations of one pin."""
    left = {
        (): 6, (Support(0.0),): 3, (Support(0.0, stiffness=10.0),): 3, HELD: 1,
        (Support(0.0, stiffness=10.0), Support(2.0)): 1, (Support(2.0, "clamped"),): 0,
    }  # fmt: skip
    for supports, count in left.items():
        assert box_shell(0.5, supports=supports).rigid_motions().shape[1] == count


def test_point_masses_have_mass_and_no_rotary_inertia() -> None:
    """Reference: analytic: 100 kg translated, 70·3² + 30·5² kg·m² pitch, yaw; no roll."""
    masses = (PointMass(2.0, 70.0), PointMass(10.0, 30.0))
    bare, loaded = (
        np.array([motion @ times(shell.mass, motion[:, None])[:, 0] for motion in motions.T])
        for shell, motions in (
            (shell, shell.rigid_motions())
            for shell in (box_shell(0.5), box_shell(0.5, masses=masses))
        )
    )
    turned = 70.0 * 9.0 + 30.0 * 25.0
    expected = [100.0, 100.0, 100.0, 0.0, turned, turned]
    assert loaded - bare == pytest.approx(expected, rel=1.0e-9, abs=1.0e-9)


@pytest.mark.slow
@pytest.mark.parametrize("direction", ["z", "y"])
@pytest.mark.parametrize("masses", [(), (PointMass(10.0, 200.0),)], ids=["bare", "tip mass"])
def test_lowest_frequency_is_the_beams_in_each_plane(
    direction: Direction, masses: tuple[PointMass, ...]
) -> None:
    """Reference: other code, Timoshenko elements; 0.2 %, the second mode 1.3 %."""
    shell = box_shell(0.25, supports=HELD, masses=masses)
    push = shell.row(shell.outline(10.0).wall_deflection(direction))[:, None]
    found = np.sqrt(reduce_segment(SymmetryReduction(shell), push, KrylovOptions(moments=2)).omega2)
    beam = replace(box_segment("beam", 0.0, 10.0, BOX, supports=HELD), masses=masses)
    elements = finite_element_segment(beam, 0.25, (), "timoshenko", rotary_inertia=True)
    expected = frequencies(elements.components[direction])
    assert found[0] == pytest.approx(expected[0], rel=4.0e-3)
    assert found[1] == pytest.approx(expected[1], rel=2.0e-2)


@pytest.mark.slow
def test_twisting_frequency_is_bredts() -> None:
    """Reference: analytic, √(G J_t / ρ I_p) / 4l for 18 m; 0.3 % of distortion."""
    box = BoxSection(height=0.4, width=0.3, flange=0.02, web=0.02)
    shell = box_shell(0.25, length=20.0, supports=HELD, section=box)
    push = shell.row(shell.outline(20.0).twist())[:, None]
    found = np.sqrt(
        reduce_segment(SymmetryReduction(shell), push, KrylovOptions(moments=2)).omega2[0]
    )
    inertia = STEEL.density * box.polar_second_moment_of_area
    expected = np.sqrt(SHEAR * box.torsion_constant / inertia) * 2.0 * np.pi / (4.0 * 18.0)
    assert found == pytest.approx(expected, rel=0.01)
    # Bredt's torsion is not that of the four plates by themselves.
    plates = 2.0 / 3.0 * (box.height + box.width) * box.web**3
    assert plates < 0.02 * box.torsion_constant


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

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The shell of a segment, of boxes, polygons and tapers, and its supports."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.finite_element import finite_element_segment, finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.excitation import Step
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Diaphragm, Joint, Pad, PointMass, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.contact_places import ContactInterval
from protractile.geometry.load import Load
from protractile.geometry.polygon import bent
from protractile.geometry.profiles import hexagon, u_section
from protractile.geometry.section import COMPONENT, Section
from protractile.geometry.taper import mean_area
from protractile.shell_model.boom_shell import ShellOptions, assemble_segments
from protractile.shell_model.contact.rows import ShellContacts
from protractile.shell_model.contact.surface import SurfaceOptions
from protractile.shell_model.contact.wall_rows import CornerLines, Wall, WallPoints
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from protractile.shell_model.segment.cross_section import Row
from protractile.shell_model.stress.lines import lines
from studies import sections
from studies.reference_models.statics import static_response
from tests.beam_model.exact import frequencies
from tests.shell_model.booms import HELD, STEEL, box_segment, reduce_quickly, reduce_segment
from tests.shell_model.conftest import BOX, UNEQUAL, box_shell, compliance
from tests.touching import touching

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
HEXAGON, OCTAGON, U = (outer for outer, _ in sections.SHAPES.values())
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


ENDS: Mapping[str, tuple[Section, Section]] = {
    "box": (BoxSection(0.4, 0.3, 0.008, 0.006), BoxSection(0.25, 0.2, 0.006, 0.006)),
    "unequal box": (
        BoxSection(0.4, 0.3, 0.006, 0.006, bottom_flange=0.010),
        BoxSection(0.22, 0.25, 0.006, 0.005, bottom_flange=0.008),
    ),
    "bends": (
        bent(hexagon(0.40, 0.36, 0.2, 0.006, 0.006, 0.006), 0.03),
        bent(hexagon(0.25, 0.26, 0.15, 0.006, 0.006, 0.006), 0.02),
    ),
    "U": (
        u_section(0.40, 0.34, 0.12, 3, top=0.008, bottom=0.006, web=0.006),
        u_section(0.25, 0.24, 0.08, 3, top=0.006, bottom=0.005, web=0.005),
    ),
}
CLAMP = Support(0.0, "clamped")


def cantilever(shape: str) -> Boom:
    tail, head = ENDS[shape]
    more = {"supports": (CLAMP,), "diaphragms": (Diaphragm(8.0, 0.006),)}
    arm = Segment.of_section("arm", 0.0, 8.0, STEEL, tail, head_section=head, **more)
    return Boom((arm,), (), (Load(0, "z", 1.0, 8.0, Step()),))


@pytest.mark.slow
def test_a_taper_bends_as_its_beam_and_its_section_forces_are_those_of_statics() -> None:
    """Reference: other code, Timoshenko elements; by hand, M = −1000 s and V = 1000 N.

    Inclined flanges carry 40 % across.
    """
    boom = cantilever("unequal box")
    models = finite_element_segments(boom, 0.25, "timoshenko", rotary_inertia=True)
    beam, shell = gap_system(boom, models), reduce_quickly(boom, ShellOptions(0.1), fields=True)
    expected, rest = (
        static_response(system, system.excitations[0].load) for system in (beam, shell.system)
    )
    tip = beam.observers["tip"].row @ expected
    assert shell.system.observers["tip"].row @ rest == pytest.approx(tip, rel=1.0e-2)
    (line,) = lines(shell.fields, boom)
    found = line.read(1000.0 * rest)
    inside = (line.x > 0.8) & (line.x < 7.2)
    s = 8.0 - line.x[inside]
    np.testing.assert_allclose(found["moment"][inside], -1000.0 * s, rtol=0.01)
    np.testing.assert_allclose(found["shear"][inside], 1000.0, rtol=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ENDS)
def test_walls_of_a_taper_are_on_the_local_section(shape: str) -> None:
    """Reference: by hand. Nodes on the local section; the beam's mass; halves have 1 N/m."""
    boom = cantilever(shape)
    (shell,) = assemble_segments(boom, ShellOptions(mesh_size=0.2), MPI.COMM_SELF)
    segment, mesh = boom.segments[0], shell.mesh
    points = mesh.points[np.unique(mesh.triangles[mesh.on_walls])]
    for x in np.unique(points[:, 0]):
        assert segment.section_at(x).on_plates(points[points[:, 0] == x, 1:]).all()

    def felt(load: Array, beyond: float) -> float:
        moved = np.zeros_like(load)
        moved[shell.node_dofs[shell.nodes[:, 0] > beyond, 2]] = 1.0
        return float(load @ moved)

    # What acts on the clamped outline is not there.
    assert 2.9 < felt(shell.uniform("z", (0.0, 3.0)), -1.0) < 3.0
    assert felt(shell.uniform("z", (3.0, 8.0)), -1.0) == pytest.approx(5.0, rel=1e-3)
    weight = STEEL.density * 4.0 * mean_area(segment.section_at(4.0), segment.section_at(8.0))
    found = segment.mass_per_length * felt(shell.plain_loads["z"], 4.0)
    assert found == pytest.approx(weight, rel=2e-2)


def test_pads_lie_on_tapered_walls() -> None:
    """Reference: by hand. A translation of 1 m gives 1 m, a rotation of 1 rad the pad's x."""
    tails = ENDS["box"][0], BoxSection(0.30, 0.22, 0.006, 0.005)
    heads = BoxSection(0.34, 0.26, 0.008, 0.006), BoxSection(0.18, 0.14, 0.004, 0.004)
    outer = Segment.of_section("outer", 0.0, 6.0, STEEL, tails[0], head_section=heads[0])
    inner = Segment.of_section("inner", 5.0, 10.0, STEEL, tails[1], head_section=heads[1])
    joint = Joint(0, 1, (5.0, 6.0), play=0.008, pad=Pad(0.12, 0.05), lateral_play=0.01)
    boom = Boom((replace(outer, supports=(CLAMP,)), inner), (joint,))
    shells = assemble_segments(boom, ShellOptions(mesh_size=0.3), MPI.COMM_SELF)
    seen, shell = touching(boom, LINEAR, LINEAR), shells[1]
    made = ShellContacts.from_shells(seen, shells, "near webs", SurfaceOptions())
    contacts = made.rows({}).contacts
    assert len(contacts) == 16
    for contact in contacts:
        station = boom.stations[contact.station]
        moved, turned = np.zeros((2, shell.free.size))
        column = shell.node_dofs[:, COMPONENT[station.direction]]
        moved[column], turned[column] = 1.0, shell.nodes[:, 0]
        row = shell.row(contact.operator[1])
        place = 5.06 if station.x == 5.0 else 5.94
        assert [row @ moved, row @ turned] == pytest.approx([1.0, place], rel=1e-9)

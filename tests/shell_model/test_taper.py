# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tapered shells agree with tapered beams."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.excitation import Step
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Diaphragm, Joint, Pad, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.load import Load
from protractile.geometry.polygon import bent
from protractile.geometry.profiles import hexagon, u_section
from protractile.geometry.section import COMPONENT, Section
from protractile.geometry.taper import mean_area
from protractile.shell_model.boom_shell import ShellOptions, assemble_segments
from protractile.shell_model.contact.rows import ShellContacts
from protractile.shell_model.contact.surface import SurfaceOptions
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.stress.lines import lines
from studies.reference_models.statics import static_response
from studies.sections import LAW, STEEL
from tests.touching import touching

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
def test_it_bends_as_its_beam() -> None:
    """Reference: other code, Timoshenko elements: the tip within 1 %."""
    boom = cantilever("unequal box")
    models = finite_element_segments(boom, 0.25, "timoshenko", rotary_inertia=True)
    shell = reduce_boom(boom, ShellOptions(mesh_size=0.15), MPI.COMM_SELF).system
    expected, found = (
        system.observers["tip"].row @ static_response(system, system.excitations[0].load)
        for system in (gap_system(boom, models), shell)
    )
    assert found == pytest.approx(expected, rel=1.0e-2)


@pytest.mark.slow
@pytest.mark.parametrize("shape", ENDS)
def test_walls_of_a_taper_are_on_the_local_section(shape: str) -> None:
    """Reference: by hand. Nodes on the local section; the beam's mass; halves have 1 N/m."""
    boom = cantilever(shape)
    (shell,) = assemble_segments(boom, ShellOptions(mesh_size=0.2), MPI.COMM_SELF)
    segment, mesh = boom.segments[0], shell.mesh
    points, walls = mesh.points, np.unique(mesh.triangles[mesh.on_walls])
    for point in points[walls]:
        assert segment.section_at(point[0]).on_plates(point[None, 1:]).all()

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


def tapered_boom(pad: Pad | None, lateral: float | None) -> Boom:
    ends = (BoxSection(0.34, 0.26, 0.008, 0.006), BoxSection(0.18, 0.14, 0.004, 0.004))
    spans = ("outer", 0.0, 6.0, STEEL, ENDS["box"][0]), (
        "inner", 5.0, 10.0, STEEL, BoxSection(0.30, 0.22, 0.006, 0.005)
    )  # fmt: skip
    outer, inner = (
        Segment.of_section(*span, head_section=end) for span, end in zip(spans, ends, strict=True)
    )
    joint = Joint(0, 1, (5.0, 6.0), play=0.008, pad=pad, lateral_play=lateral and 2.0 * lateral)
    return Boom((replace(outer, supports=(CLAMP,)), inner), (joint,))


@pytest.mark.slow
def test_its_section_forces_are_those_of_statics() -> None:
    """Reference: by hand, M = −1000 s and V = 1000 N; inclined flanges carry 40 % across."""
    boom = cantilever("box")
    shell = reduce_boom(boom, ShellOptions(mesh_size=0.1), MPI.COMM_SELF)
    (line,) = lines(shell.fields, boom)
    (load,) = shell.system.excitations
    found = line.read(1000.0 * static_response(shell.system, load.load))
    inside = (line.x > 0.8) & (line.x < 7.2)
    s = 8.0 - line.x[inside]
    np.testing.assert_allclose(found["moment"][inside], -1000.0 * s, rtol=0.01)
    np.testing.assert_allclose(found["shear"][inside], 1000.0, rtol=0.02)


@pytest.mark.parametrize(("pad", "lateral"), [(None, None), (Pad(0.12, 0.05), 5e-3)])
def test_pads_lie_on_tapered_walls(pad: Pad | None, lateral: float | None) -> None:
    """Reference: by hand. A translation of 1 m gives 1 m, a rotation of 1 rad the pad's x."""
    boom = tapered_boom(pad, lateral)
    shells = assemble_segments(boom, ShellOptions(mesh_size=0.3), MPI.COMM_SELF)
    seen, inner = touching(boom, LAW, LAW), shells[1]
    made = ShellContacts.from_shells(seen, shells, "near webs", SurfaceOptions())
    contacts = made.rows({}).contacts
    assert len(contacts) == (4 if lateral is None else 16)
    reach = 0.06 if pad else 0.0
    for contact in contacts:
        station = boom.stations[contact.station]
        moved, turned = np.zeros((2, inner.free.size))
        column = inner.node_dofs[:, COMPONENT[station.direction]]
        moved[column], turned[column] = 1.0, inner.nodes[:, 0]
        row = inner.row(contact.operator[1])
        place = station.x + (reach if station.x == 5.0 else -reach)
        assert [row @ moved, row @ turned] == pytest.approx([1.0, place], rel=1e-9)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Polygonal sections of flat plates: section properties, compliance of rings, motion of booms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from mpi4py import MPI

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.boom import Boom, Collar, Joint, Segment, Support
from protractile.geometry.contact_places import ContactInterval
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import Direction, Section
from protractile.runs.report.tables import Table
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.contact.wall_rows import CornerLines
from protractile.shell_model.reduced_shell import reduce_boom
from studies.reference_models.plates import STEEL
from studies.reference_models.single_segment import compliances, shell_alone
from studies.reference_models.statics import shear_centre
from studies.study import Criterion, Piece, Progress, Verification, define_study

LAW = PowerContact(stiffness=1.0e9, exponent=1.0)

# Outer and inner sections that replace the boxes of the paper, with the sharp folds of shells.
SHAPES: Mapping[str, tuple[PolygonSection, PolygonSection]] = {
    "hexagon": (
        hexagon(0.50, 0.45, 0.25, 0.0065, 0.0065, 0.0065),
        hexagon(0.46, 0.40, 0.22, 0.005, 0.005, 0.005),
    ),
    "octagon": (
        octagon(0.50, 0.36, 0.08, 0.008, 0.008, 0.006),
        octagon(0.46, 0.31, 0.07, 0.006, 0.006, 0.005),
    ),
    "U": (
        replace(u_section(0.50, 0.34, 0.15, 3, top=0.008, bottom=0.006, web=0.006), radii=()),
        replace(u_section(0.46, 0.29, 0.125, 3, top=0.006, bottom=0.005, web=0.005), radii=()),
    ),
}

# Properties of the outer sections by the program sectionproperties 3.10.2, in m⁴ and m². All but
# the second moments are extrapolated to thin walls, from half and a quarter of the thickness
# (tests/geometry/test_sections_elsewhere.py).
PROPERTIES = (
    "second_moment_of_area", "lateral_second_moment_of_area", "torsion_constant", "shear_area",
    "lateral_shear_area",
)  # fmt: skip
ELSEWHERE: Mapping[str, Sequence[float]] = {
    "hexagon": (3.4904e-4, 2.37213e-4, 5.04895e-4, 5.55004e-3, 3.77946e-3),
    "octagon": (3.60563e-4, 1.97568e-4, 4.68346e-4, 5.24576e-3, 3.83017e-3),
    "U": (3.54044e-4, 1.92474e-4, 4.21478e-4, 5.2764e-3, 3.5089e-3),
}
CENTRE_OF_U = -8.64726e-3

# Length and edge length of a ring in m; a short ring bends like bars.
RING, RING_MESH = 0.02, 0.01
# Length and edge length of the rotated cantilevers in m.
ARM, ARM_MESH = 4.0, 0.2
# Thickness in m of the collars around each station.
COLLAR = 0.010
MESH_SIZE, TOLERANCE = 0.1, 0.01
# Time step in s. A step of 1e-5 s changes the first peak by 0.03 %.
STEP = 5.0e-7
# Permitted deviations of first peaks of shells with collars from those of beams.
ALLOWED = {"hexagon": 0.015, "octagon": 0.015, "U": 0.02}
# Duration of the motion in s, longer than the time of the first peak.
DURATION = 0.8

NOTE = (
    "First peak of the tip of two segments in the place of the paper's, with linear contact near "
    "the webs, against Timoshenko elements. Collars of 10 mm reach 0.15 m to both sides of the "
    "stations; beams do not know of them. Pressed between its flats, a folded section unfolds: "
    "it needs them where a box does not."
)


def boom_of(outer: Section, inner: Section) -> Boom:
    """Return a boom with the paper's spans, supports and play, under its weight at 1 m/s²."""
    loads = [STEEL.density * one.area for one in (outer, inner)]
    held = Support(0.0), Support(2.0)
    return Boom(
        (
            Segment.of_section("outer", 0.0, 10.0, STEEL, outer, load=loads[0], supports=held),
            Segment.of_section("inner", 9.0, 19.0, STEEL, inner, load=loads[1]),
        ),
        (Joint(outer=0, inner=1, stations=(9.0, 10.0), play=0.014, contact=LAW),),
    )


def add_collars(boom: Boom, thickness: float) -> Boom:
    """Return the boom with collars around both segments at both stations."""
    spans = ((8.85, 9.15), (9.85, 10.0)), ((9.0, 9.15), (9.85, 10.15))
    segments = (
        replace(segment, collars=tuple(Collar(span, thickness) for span in own))
        for segment, own in zip(boom.segments, spans, strict=True)
    )
    return replace(boom, segments=tuple(segments))


def first_peak(system: GapSystem) -> float:
    """Return the largest deflection of the tip in m."""
    tip = FixedStep(STEP)(Motion(system, DURATION, output_step=1.0e-3)).data["tip"].values
    return float(np.abs(tip).max())


def beam_peak(boom: Boom) -> float:
    """Return the first peak of Timoshenko elements in m."""
    elements = finite_element_segments(boom, 0.25, "timoshenko", True)
    return first_peak(gap_system(boom, elements))


def shell_peak(boom: Boom) -> float:
    """Return the first peak of a shell in m."""
    options = ShellOptions(MESH_SIZE, contact_tolerance=TOLERANCE)
    return first_peak(reduce_boom(boom, options, MPI.COMM_WORLD).system)


def ring_of_bars(section: Section, length: float) -> float:
    """Return the compliance in m/N between top and bottom of a ring under forces on its corners.

    Plates are rigidly joined bars with axial and bending stiffness, without shear (Przemieniecki
    1968). Top and bottom are flat; the length of the ring is in m.
    """
    count = len(section.plates)
    stiffness = np.zeros((3 * count, 3 * count))
    for n, plate in enumerate(section.plates):
        stretch = STEEL.youngs_modulus * length * plate.thickness / plate.length
        bend = stretch * plate.thickness**2 / 12.0
        y, z = plate.tangent
        # Rows of the bar's elongation, and of the rotations of both ends relative to the chord.
        chord = np.array([-z, y]) / plate.length
        strains = np.array(
            [
                [-y, -z, 0.0, y, z, 0.0],
                [*chord, 1.0, *-chord, 0.0],
                [*chord, 0.0, *-chord, 1.0],
            ]
        )
        own = np.diag([stretch, 4.0 * bend, 4.0 * bend])
        own[1, 2] = own[2, 1] = 2.0 * bend
        dofs = np.concatenate([3 * n + np.arange(3), 3 * ((n + 1) % count) + np.arange(3)])
        stiffness[np.ix_(dofs, dofs)] += strains.T @ own @ strains
    force = np.zeros(3 * count)
    for side in (1, -1):
        plate_number = section.face("z", side).plate
        force[[3 * plate_number + 1, 3 * ((plate_number + 1) % count) + 1]] = 0.5 * side
    return float(force @ np.linalg.lstsq(stiffness, force, rcond=1.0e-12)[0])


def ring_of_shell(section: Section, length: float, size: float) -> float:
    """Return the compliance of :func:`ring_of_bars` by a shell with edges of a size in m."""
    segment = Segment.of_section("ring", 0.0, length, STEEL, section)
    shell, stretch = (
        shell_alone(segment, size),
        ContactInterval.from_station(segment, 0.5 * length, length),
    )
    corners = CornerLines(shell)
    top, bottom = (corners.deflection(stretch, "z", 0.0, side) for side in (1, -1))
    return compliances(shell, top - bottom)[0]


def tip_of_shell(section: Section, direction: Direction, size: float) -> float:
    """Return the tip compliance of a shell cantilever along a direction, in m/N."""
    clamp = Support(0.0, "clamped")
    segment = Segment.of_section("arm", 0.0, ARM, STEEL, section, supports=(clamp,))
    shell = shell_alone(segment, size)
    return compliances(shell, shell.outline(ARM).wall_deflection(direction))[0]


@define_study("sections", "Polygons of flat plates")
def study(progress: Progress) -> Iterator[Piece]:
    """Study properties of sections, rings, and first peaks of booms."""
    yield from _numbers()
    rows: list[tuple[str | float, ...]] = []
    frame: Criterion = ("other code", "plane frame, Przemieniecki 1968", 3.0e-3)
    for name, (outer, inner) in SHAPES.items():
        progress(f"{name}: a ring, and booms with and without collars")
        bars, shell = ring_of_bars(outer, RING), ring_of_shell(outer, RING, RING_MESH)
        what = f"{name}, ring of {1e3 * RING:g} mm pressed between its flats: compliance"
        yield Verification(what, 1e6 * shell, 1e6 * bars, "1e-6 m/N", *frame)
        plain = boom_of(outer, inner)
        beam = 1e3 * beam_peak(plain)
        peaks = [1e3 * shell_peak(boom) for boom in (plain, add_collars(plain, COLLAR))]
        over = [part for peak in peaks for part in (peak, 100.0 * (peak / beam - 1.0))]
        rows.append((name, beam, *over))
        elements: Criterion = ("other code", "Timoshenko elements", ALLOWED[name])
        yield Verification(
            f"{name}s with collars: first peak of the tip", peaks[1], beam, "mm", *elements
        )
    progress("turned sections")
    yield from _turned()
    columns = {
        "sections": "", "beam\nmm": ".4g", "shell\nmm": ".4g", "off the\nbeam (%)": ".2f",
        "with collars\nmm": ".4g", "so off the\nbeam (%)": ".2f",
    }  # fmt: skip
    yield Table.of_rows("sections", "Folded booms and their beams", columns, rows, (NOTE,))


def _numbers() -> Iterator[Verification]:
    """Compare section properties with finite elements over the section."""
    program = "finite elements, sectionproperties 3.10.2"
    for name, known in ELSEWHERE.items():
        for key, reference in zip(PROPERTIES, known, strict=True):
            what, value = f"{name}: {key.replace('_', ' ')}", getattr(SHAPES[name][0], key)
            unit = "m²" if key.endswith("shear_area") else "m⁴"
            yield Verification(what, value, reference, unit, "external", program, 1.0e-3)
    _, height = shear_centre(SHAPES["U"][0].plates)
    what = "U: shear centre above the centroid"
    yield Verification(what, 1e3 * height, 1e3 * CENTRE_OF_U, "mm", "external", program, 1.0e-2)


def _turned() -> Iterator[Verification]:
    """Check that rotations of sections by 90° or 180° do not change the motion."""
    for name, (section, _) in SHAPES.items():
        upright = tip_of_shell(section, "z", ARM_MESH)
        over = PolygonSection(tuple((y, -z) for y, z in section.corners), section.thicknesses)
        turned: tuple[tuple[str, Section, Direction], ...] = (
            ("rolled by 90°: tip to the side", section.turned(), "y"),
            ("upside down: tip", over, "z"),
        )
        for how, other, direction in turned:
            moved = tip_of_shell(other, direction, ARM_MESH)
            what = f"{name} {how} of a cantilever of shell"
            yield Verification(
                what, 1e6 * moved, 1e6 * upright, "1e-6 m/N", "other code", "upright", 1e-6
            )

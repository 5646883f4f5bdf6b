# SPDX-License-Identifier: LGPL-3.0-or-later
"""Effect of collars and diaphragms on the flexibility at the contacts of the boom's segments.

A collar is at the head of the outer segment or at the tail of the inner segment. A diaphragm is
possible only at the tail, since the inner segment slides through the head. Flexibilities are
static, so that the mass of stiffeners has no effect. The outer segment has its supports, the inner
segment has two pins far from the joint. The flexibility of the Timoshenko beam on the same supports
is subtracted.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Collar, Diaphragm, Material, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.runs.case.build import build_boom
from protractile.runs.report.tables import Cell, Table
from protractile.shell_model.segment.cross_section import Row, SectionNodes
from studies.motions import friction_case
from studies.reference_models.shell_readings import flange_deflection, quadratic_form
from studies.reference_models.single_segment import compliances, natural_frequencies, shell_alone
from studies.study import Criterion, Piece, Progress, Verification, define_study

# Permitted errors: of the mesh, of walls beside a plate, and of a force on a short thick ring.
ALLOWED = 0.01


class Sizes(NamedTuple):
    """Parameters of the study."""

    mesh: float = 0.05  #: edge length in m on the boom
    collar: float = 0.3  #: length of a collar in m
    #: Thicknesses of both in m, rising.
    collars: Sequence[float] = (0.005, 0.010, 0.020)
    diaphragms: Sequence[float] = (0.004, 0.008, 0.016)
    #: x in m of the inner segment's supports for its static flexibility.
    pins: tuple[float, float] = (14.0, 19.0)
    frequencies: int = 3  #: number of the lowest frequencies
    #: Edge lengths in m where an analytic value is the reference.
    plate_mesh: float = 0.04
    ring_mesh: float = 0.0125


class Variant(NamedTuple):
    """A segment with one set of stiffeners."""

    what: str  #: segment and its stiffeners
    mass: float  #: mass of all plates in kg
    #: (num_stations,) compliance in nm/N less that of a Timoshenko beam, with half of the force on
    #: each flange above and below the webs.
    together: Array
    one_more: Array  #: (num_stations,) further compliance in nm/N with all of the force on a flange
    frequencies: Array  #: lowest elastic frequencies in Hz

    @property
    def row(self) -> list[Cell]:
        """Row of the table."""
        flexibilities = np.column_stack([self.together, self.one_more]).ravel()
        return [self.what, self.mass, *flexibilities, *self.frequencies]


def stiffened_segments(boom: Boom, sizes: Sizes) -> tuple[dict[str, Segment], dict[str, Segment]]:
    """Return both segments with each set of stiffeners, from none to all."""
    outer, inner = boom.segments
    head, tail = (outer.end - sizes.collar, outer.end), (inner.start, inner.start + sizes.collar)
    outers, inners = {"nothing": outer}, {"nothing": inner}
    for t in sizes.collars:
        what = f"{1e3 * t:g} mm"
        outers[f"collar at the head, {what}"] = replace(outer, collars=(Collar(head, t),))
        inners[f"collar at the tail, {what}"] = replace(inner, collars=(Collar(tail, t),))
    for t in sizes.diaphragms:
        plates = (Diaphragm(inner.start, t),)
        inners[f"diaphragm in the tail, {1e3 * t:g} mm"] = replace(inner, diaphragms=plates)
    # Collar and diaphragm together, both with their largest thickness.
    both = replace(inner, collars=(Collar(tail, sizes.collars[-1]),), diaphragms=plates)
    return outers, inners | {"the thickest of both": both}


def measure(segment: Segment, what: str, stations: Sequence[float], sizes: Sizes) -> Variant:
    """Return mass, flexibility at stations x in m, and lowest frequencies of a segment."""
    shell = shell_alone(segment, sizes.mesh, stations)
    held, standing = segment, shell
    if not segment.supports:
        held = replace(segment, supports=tuple(Support(x) for x in sizes.pins))
        standing = shell_alone(held, sizes.mesh, stations)
    tops, bottoms = (
        # Points above the webs, where pads near the webs press.
        [
            flange_deflection(outline, side, 0.5 * outline.section.size("y"))
            for outline in map(standing.outline, stations)
        ]
        for side in (1.0, -1.0)
    )
    both = [0.5 * top + 0.5 * bottom for top, bottom in zip(tops, bottoms, strict=True)]
    together, alone = 1.0e9 * np.reshape(compliances(standing, *both, *tops), (2, -1))
    beam = 1.0e9 * np.array([_timoshenko(held, x) for x in stations])
    free = shell.rigid_motions().shape[1]
    frequencies = natural_frequencies(shell, free + sizes.frequencies)[free:]
    name = f"{segment.name}, {what}"
    # The translation of all nodes along x, of which the mass is measured.
    slide = np.zeros(shell.free.size)
    slide[shell.node_dofs[:, 0]] = 1.0
    mass = quadratic_form(shell.mass, slide)
    return Variant(name, mass, together - beam, alone - together, frequencies)


def _timoshenko(segment: Segment, x: float) -> float:
    """Return the deflection in m of an overhanging beam on two pins under 1 N at x."""
    section, material = segment.section, segment.material
    assert section is not None
    near, far = sorted((support.x for support in segment.supports), key=lambda pin: abs(pin - x))
    a, span = abs(x - near), abs(far - near)
    bending = a**2 * (span + a) / (3.0 * material.youngs_modulus * section.second_moment_of_area)
    return bending + (a + a**2 / span) / (material.shear_modulus * section.shear_area)


def racking(outline: SectionNodes) -> Row:
    """Return the row of the racking of a section: rotation of webs less rotation of flanges.

    It is twice the row of the twist, with reversed signs at the flanges.
    """
    along_y = set(outline.dofs[:, 1].tolist())
    return Row({dof: (-2.0 if dof in along_y else 2.0) * w for dof, w in outline.twist().items()})


def racking_stiffness(
    section: BoxSection, material: Material, thickness: float, size: float
) -> float:
    """Return the racking stiffness in N·m/rad that a diaphragm in the middle adds to a box of 1 m.

    ``thickness`` of the diaphragm and ``size`` of the mesh are in m.
    """
    stiffness = []
    for plates in ((), (Diaphragm(0.5, thickness),)):
        shell = shell_alone(_piece(material, section, 1.0, diaphragms=plates), size, (0.5,))
        (compliance,) = compliances(shell, racking(shell.outline(0.5)))
        stiffness.append(1.0 / compliance)
    return stiffness[1] - stiffness[0]


def ring_flexibility(section: BoxSection, young: float, collar: float, size: float) -> float:
    """Return the compliance in m²/N of a ring of a box under opposite forces on its flanges.

    The length is a twentieth of the perimeter. Poisson's ratio is 0, so that plates bend like
    beams. ``young`` is in Pa, the thickness of the collar and the size of the mesh in m.
    """
    length = 0.1 * (section.width + section.height)
    collars = (Collar((0.0, length), collar),) if collar else ()
    ring = _piece(Material(young, 0.0, 7850.0), section, length, collars=collars)
    shell = shell_alone(ring, size, (0.5 * length,))
    across = ((0.0, 1.0 / 6.0), (0.5 * length, 4.0 / 6.0), (length, 1.0 / 6.0))
    forces = (
        weight * side * flange_deflection(shell.outline(x), side, 0.0)
        for x, weight in across
        for side in (1.0, -1.0)
    )
    return compliances(shell, sum(forces, Row()))[0] * length


def frame_flexibility(section: BoxSection, young: float, collar: float) -> float:
    """Return the compliance of :func:`ring_flexibility` by Timoshenko beams as thick as the plates.

    A flange is a shear-flexible beam of span b under P at midspan. At the corners the moment
    P b² / 8 (b + h) gives flange and web the same slope. Each web shortens under P / 2.
    """
    b, h, t = section.width, section.height, section.flange + collar
    bending = 24.0 * (b**3 / 48.0 - b**4 / (64.0 * (b + h))) / t**3
    # Shear deflection of both flanges, twice b / (4 κ G t), with κ = 5/6 and G = E/2.
    shear = 1.2 * b / t
    return (bending + shear + 0.5 * h / t) / young


def _piece(
    material: Material, section: BoxSection, length: float, **stiffeners: tuple[object, ...]
) -> Segment:
    """Return a box segment without supports."""
    return Segment.of_section("piece", 0.0, length, material, section, **stiffeners)


def table(found: Sequence[Variant], stations: Sequence[float], sizes: Sizes) -> Table:
    """Return a table with one row per variant."""
    flexibility = "both flanges (nm/N)", "one flange more (nm/N)"
    columns = {
        "segment, with": "", "mass (kg)": ".1f",
        **{f"{x:g} m: {what}": ".2f" for x in stations for what in flexibility},
        **{f"f{k} (Hz)": ".2f" for k in range(1, sizes.frequencies + 1)},
    }  # fmt: skip
    return Table.of_rows(
        "variants",
        "Collars and diaphragms on the paper's boom",
        columns,
        [one.row for one in found],
        (
            f"Collars are {sizes.collar:g} m long. Static flexibility above the webs, beyond that "
            "of Timoshenko's beam of the plain box: of half the force on each flange, and what all "
            "of it on one flange adds. Frequencies are the lowest elastic ones of a segment alone, "
            "the outer one on its supports, the inner one free. Flexibility to a corner's force "
            f"grows as the mesh refines: compare on one mesh, here {sizes.mesh:g} m.",
        ),
    )


def verifications(boom: Boom, sizes: Sizes) -> Iterator[Verification]:
    """Compare stiffened boxes with formulas."""
    inner = boom.segments[1]
    section, material = inner.section, inner.material
    assert isinstance(section, BoxSection)
    t, collar = sizes.diaphragms[len(sizes.diaphragms) // 2], sizes.collars[0]
    what = f"resistance of a diaphragm of {1e3 * t:g} mm to racking"
    value = racking_stiffness(section, material, t, sizes.plate_mesh)
    shear = material.shear_modulus * t * section.width * section.height
    plate: Criterion = ("analytic", "G t b h of a plate in pure shear", ALLOWED)
    yield Verification(what, value, shear, "N m", *plate)
    if section.flange != section.web:
        return
    young = material.youngs_modulus
    beams: Criterion = ("analytic", "frame of Timoshenko beams", ALLOWED)
    for thickness, has in (
        (0.0, "without a collar"),
        (collar, f"with a collar of {1e3 * collar:g} mm"),
    ):
        value = ring_flexibility(section, young, thickness, sizes.ring_mesh)
        frame = frame_flexibility(section, young, thickness)
        yield Verification(f"flexibility of a ring {has}, per length", value, frame, "m²/N", *beams)


@define_study("stiffeners", "Collars and diaphragms")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Study collars and diaphragms at the joint of the paper's boom."""
    sizes = sizes or Sizes()
    boom = build_boom(friction_case())
    stations = boom.joints[0].stations
    found = []
    for variants in stiffened_segments(boom, sizes):
        for what, segment in variants.items():
            progress(f"{segment.name}: {what}")
            found.append(measure(segment, what, stations, sizes))
    yield table(found, stations, sizes)
    progress("a diaphragm in pure shear, and rings")
    yield from verifications(boom, sizes)

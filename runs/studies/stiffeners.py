# SPDX-License-Identifier: LGPL-3.0-or-later
"""What collars and diaphragms make of the flexibility where the boom's segments touch.

A collar goes around the head of the outer segment or the tail of the inner one, a diaphragm closes
the tail alone: the inner segment slides through the head. Flexibility is static, so that the mass
of a stiffener has no part in it: the outer segment stands on its own supports, the inner one on two
pins far from the joint, and Timoshenko's beam on the same is taken off.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, replace

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from geometry.boom import Boom, Collar, Diaphragm, Material, Segment, Support
from geometry.mesh import collar_breaks, diaphragm_breaks, mesh_segment
from geometry.section import BoxSection
from runs.case.build import build_boom
from runs.report.tables import TextTable
from runs.report.theme import fixed
from runs.studies.motions import friction_case
from runs.studies.study import Proof, Study
from shell_model.cross_section import Outline, Row, combine
from shell_model.reduction.products import gram, times
from shell_model.reduction.solver import ShiftedSolver
from shell_model.segment_shell import SegmentShell, assemble_segment
from shell_model.verification.eigenmodes import natural_frequencies

Array = npt.NDArray[np.float64]

COMM = MPI.COMM_SELF
# In Hz, in place of zero: nothing holds a segment along x. Far below all elastic modes.
STATIC = 0.01

# The error of the mesh; what the walls beside a plate, and the force on a short thick ring, add.
ALLOWED = 0.01


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured.

    Args:
        mesh: edge length in m on the boom.
        collar: length of a collar in m.
        collars, diaphragms: their thicknesses in m.
        pins: x in m at which the inner segment is held for its static flexibility.
        frequencies: how many of the lowest ones.
        plate_mesh, ring_mesh: edge lengths in m where an analytic value is the reference.
    """

    mesh: float = 0.05
    collar: float = 0.3
    collars: Sequence[float] = (0.005, 0.010, 0.020)
    diaphragms: Sequence[float] = (0.004, 0.008, 0.016)
    pins: tuple[float, float] = (14.0, 19.0)
    frequencies: int = 3
    plate_mesh: float = 0.04
    ring_mesh: float = 0.0125


@dataclass(frozen=True, slots=True)
class Flexibility:
    """Of one segment at one station, in m/N, beyond Timoshenko's beam.

    Args:
        x: of the station in m.
        together: half the force on each flange, above and below its webs.
        one_more: what one flange with all of the force gives way beyond that.
    """

    x: float
    together: float
    one_more: float

    @property
    def alone(self) -> float:
        """Of one flange with all of the force."""
        return self.together + self.one_more


@dataclass(frozen=True, slots=True)
class Variant:
    """One segment with its stiffeners.

    Args:
        segment: its name.
        what: it has.
        mass: of all its plates in kg.
        flexibilities: at every station.
        frequencies: the lowest ones in Hz, rigid motions left out.
    """

    segment: str
    what: str
    mass: float
    flexibilities: Sequence[Flexibility]
    frequencies: Sequence[float]


def variants(boom: Boom, sizes: Sizes, tell: Callable[[str], None]) -> list[Variant]:
    """Measure the two segments of a boom, plain and stiffened.

    Args:
        boom: of two segments with box sections in one joint.
        sizes: what is measured.
        tell: told which variant.
    """
    outer, inner = boom.segments
    head, tail = (outer.end - sizes.collar, outer.end), (inner.start, inner.start + sizes.collar)
    strongest = max(sizes.collars), max(sizes.diaphragms)

    def plate(thickness: float) -> tuple[Diaphragm]:
        return (Diaphragm(inner.start, thickness),)

    stiffened: list[tuple[str, Segment]] = [("nothing", outer)]
    for t in sizes.collars:
        collared = replace(outer, collars=(Collar(*head, t),))
        stiffened.append((f"collar at the head, {1e3 * t:g} mm", collared))
    stiffened.append(("nothing", inner))
    for t in sizes.collars:
        collared = replace(inner, collars=(Collar(*tail, t),))
        stiffened.append((f"collar at the tail, {1e3 * t:g} mm", collared))
    for t in sizes.diaphragms:
        what = f"diaphragm in the tail, {1e3 * t:g} mm"
        stiffened.append((what, replace(inner, diaphragms=plate(t))))
    both = replace(inner, collars=(Collar(*tail, strongest[0]),), diaphragms=plate(strongest[1]))
    stiffened.append(("the thickest of both", both))
    stations = boom.joints[0].stations
    found = []
    for what, segment in stiffened:
        tell(f"{segment.name}: {what}")
        found.append(_measure(segment, what, stations, sizes))
    return found


def _measure(segment: Segment, what: str, stations: Sequence[float], sizes: Sizes) -> Variant:
    shell = _shell(segment, sizes.mesh, stations)
    held, standing = segment, shell
    if not segment.supports:
        held = replace(segment, supports=tuple(Support(x) for x in sizes.pins))
        standing = _shell(held, sizes.mesh, stations)
    solve = ShiftedSolver(standing, STATIC)
    flexibilities = []
    for x in stations:
        top, bottom = (_corners(standing.outline(x), side) for side in (1.0, -1.0))
        rigid = _timoshenko(held, x)
        both = _compliance(standing, solve, combine((0.5, top), (0.5, bottom)))
        one = _compliance(standing, solve, top)
        flexibilities.append(Flexibility(x, both - rigid, one - both))
    solve.destroy()
    free = shell.rigid_motions().shape[1]
    frequencies = natural_frequencies(shell, free + sizes.frequencies)[free:]
    return Variant(segment.name, what, _mass(shell), flexibilities, [float(f) for f in frequencies])


def _shell(segment: Segment, size: float, lines: Sequence[float] = ()) -> SegmentShell:
    """A segment with mesh lines at its supports, its stiffeners and some more places."""
    assert segment.section is not None
    plates = diaphragm_breaks(segment)
    breaks = {"start": segment.start, "end": segment.end} | plates | collar_breaks(segment)
    places = [*lines, *(support.x for support in segment.supports)]
    breaks |= {f"place-{k}": x for k, x in enumerate(places, start=1)}
    mesh = mesh_segment(segment.section, breaks, size, closed=tuple(plates))
    return assemble_segment(COMM, segment, mesh)


def _corners(outline: Outline, side: float) -> Row:
    """A flange's deflection above its webs, where pads near the webs press."""
    return outline.flange_deflection(side, 0.5 * outline.section.size("y"))


def _timoshenko(segment: Segment, x: float) -> float:
    """Deflection in m of an overhanging beam under 1 N at x, beside its two pins."""
    section, material = segment.section, segment.material
    assert section is not None
    near, far = sorted((support.x for support in segment.supports), key=lambda pin: abs(pin - x))
    a, span = abs(x - near), abs(far - near)
    bending = a**2 * (span + a) / (3.0 * material.youngs_modulus * section.second_moment_of_area)
    return bending + (a + a**2 / span) / (material.shear_modulus * section.shear_area)


def _compliance(shell: SegmentShell, solve: ShiftedSolver, row: Row) -> float:
    """What a unit force moves its own reading by, in m/N."""
    force = shell.row(row)[:, None]
    return float(gram(shell.comm, force, solve(force))[0, 0])


def _mass(shell: SegmentShell) -> float:
    """What a slide along x carries, in kg."""
    slide = np.zeros((shell.free.size, 1))
    slide[shell.node_dofs[:, 0] - shell.owned[0]] = 1.0
    return float(gram(shell.comm, slide, times(shell.mass, slide))[0, 0])


def racking(outline: Outline) -> Row:
    """How far the section leans into a parallelogram: turn of the webs less that of the flanges.

    Twice the twist, with its flanges the other way round.
    """
    along_y = set(outline.dofs[:, 1].tolist())
    return {dof: (-2.0 if dof in along_y else 2.0) * w for dof, w in outline.twist().items()}


def racking_stiffness(
    section: BoxSection, material: Material, thickness: float, size: float
) -> float:
    """What a diaphragm adds to the moment in N m that leans a section by one radian.

    Args:
        section: of a box one metre long, with the plate in its middle.
        material: of both.
        thickness: of the plate in m.
        size: of the mesh in m.
    """
    stiffness = []
    for plates in ((), (Diaphragm(0.5, thickness),)):
        shell = _shell(replace(_piece(section, material, 1.0), diaphragms=plates), size, (0.5,))
        solve = ShiftedSolver(shell, STATIC)
        stiffness.append(1.0 / _compliance(shell, solve, racking(shell.outline(0.5))))
        solve.destroy()
    return stiffness[1] - stiffness[0]


def ring_flexibility(section: BoxSection, young: float, collar: float, size: float) -> float:
    """How a ring of box gives way to opposite forces on the middles of its flanges, in m²/N.

    Args:
        section: of a ring whose length is a twentieth of its perimeter.
        young: Young's modulus in Pa; without Poisson's ratio plates bend as beams do.
        collar: thickness in m that is added all around.
        size: of the mesh in m.
    """
    plain = _piece(section, Material(young, 0.0, 7850.0), 0.1 * (section.width + section.height))
    ring = replace(plain, collars=(Collar(0.0, plain.end, collar),)) if collar else plain
    shell = _shell(ring, size, (0.5 * plain.end,))
    across = ((0.0, 1.0 / 6.0), (0.5 * plain.end, 4.0 / 6.0), (plain.end, 1.0 / 6.0))
    row = combine(
        *(
            (weight * side, shell.outline(x).flange_deflection(side, 0.0))
            for x, weight in across
            for side in (1.0, -1.0)
        )
    )
    solve = ShiftedSolver(shell, STATIC)
    found = _compliance(shell, solve, row)
    solve.destroy()
    return found * plain.end


def frame_flexibility(section: BoxSection, young: float, collar: float) -> float:
    """The same of a frame of Timoshenko beams of the thickness t without Poisson's ratio.

    A flange is a beam of span b that bears P in its middle, and whose ends the corner moment
    P b² / 8 (b + h) turns back until flange and web have one slope there; it bends, and gives way
    to shear. The webs shorten under P / 2 each.
    """
    b, h, t = section.width, section.height, section.flange + collar
    bending = 24.0 * (b**3 / 48.0 - b**4 / (64.0 * (b + h))) / t**3
    # Twice b / (4 κ G t), with κ = 5/6 and G = E/2.
    shear = 1.2 * b / t
    return (bending + shear + 0.5 * h / t) / young


def _piece(section: BoxSection, material: Material, length: float) -> Segment:
    """A free piece of box."""
    mass, second_moment = material.density * section.area, section.second_moment_of_area
    rotary = material.density * second_moment
    return Segment("piece", 0.0, length, material, mass, second_moment, rotary, section)


def table(found: Sequence[Variant], sizes: Sizes) -> TextTable:
    """One row a variant."""
    stations = [f"{one.x:g}" for one in found[0].flexibilities]
    rows = [
        (
            f"{one.segment}, {one.what}",
            f"{one.mass:.1f}",
            *(
                fixed(1.0e9 * value, 2)
                for station in one.flexibilities
                for value in (station.together, station.one_more)
            ),
            *(f"{frequency:.2f}" for frequency in one.frequencies),
        )
        for one in found
    ]
    return TextTable(
        "Collars and diaphragms on the paper's boom",
        (
            "segment, with",
            "mass (kg)",
            *(
                heading
                for x in stations
                for heading in (f"{x} m: both flanges (nm/N)", f"{x} m: one flange more (nm/N)")
            ),
            *(f"f{k} (Hz)" for k in range(1, sizes.frequencies + 1)),
        ),
        rows,
        (
            f"Collars are {sizes.collar:g} m long. Static flexibility above the webs, beyond that "
            "of Timoshenko's beam of the plain box: of half the force on each flange, and what all "
            "of it on one flange adds. Frequencies are the lowest elastic ones of a segment alone, "
            "the outer one on its supports, the inner one free. Flexibility to a corner's force "
            f"grows as the mesh refines: compare on one mesh, here {sizes.mesh:g} m.",
        ),
        name="stiffeners",
    )


def sums(found: Sequence[Variant], outer: str, inner: str) -> TextTable:
    """What both segments of a joint give way together, for some pairs of variants.

    Args:
        found: measured.
        outer, inner: names of the segments.
    """
    mine = [[one for one in found if one.segment == name] for name in (outer, inner)]
    collared = [[one for one in some if one.what.startswith("collar")][-1] for some in mine]
    closed = [one for one in mine[1] if one.what.startswith("diaphragm")][-1]
    pairs: list[tuple[str, Variant, Variant]] = [
        ("nothing", mine[0][0], mine[1][0]),
        ("a collar at the head", collared[0], mine[1][0]),
        ("a collar at the tail", mine[0][0], collared[1]),
        ("collars at both", collared[0], collared[1]),
        ("a diaphragm in the tail", mine[0][0], closed),
        ("collars at both and the diaphragm", collared[0], mine[1][-1]),
    ]
    rows = []
    for what, one, other in pairs:
        stations = zip(one.flexibilities, other.flexibilities, strict=True)
        rows.append((what, *(fixed(1.0e9 * (a.alone + b.alone), 2) for a, b in stations)))
    return TextTable(
        "Flexibility of a contact, both segments together",
        ("with", *(f"at {one.x:g} m (nm/N)" for one in found[0].flexibilities)),
        rows,
        ("Of one flange of each, with the thickest stiffeners of the table above.",),
        name="stiffened-stations",
    )


def proofs(boom: Boom, sizes: Sizes, tell: Callable[[str], None]) -> list[Proof]:
    """Stiffeners that are simple enough for a formula."""
    inner = boom.segments[1]
    section, material = inner.section, inner.material
    assert isinstance(section, BoxSection)
    t, collar = sizes.diaphragms[len(sizes.diaphragms) // 2], sizes.collars[0]
    tell("a diaphragm in pure shear")
    shear = material.shear_modulus * t * section.width * section.height
    found = [
        Proof(
            what=f"resistance of a diaphragm of {1e3 * t:g} mm to racking",
            value=racking_stiffness(section, material, t, sizes.plate_mesh),
            reference=shear,
            unit="N m",
            kind="analytic",
            source="G t b h of a plate in pure shear",
            allowed=ALLOWED,
        )
    ]
    for thickness in (0.0, collar) if section.flange == section.web else ():
        what = f"with a collar of {1e3 * thickness:g} mm" if thickness else "without a collar"
        tell(f"a ring {what}")
        young = material.youngs_modulus
        found.append(
            Proof(
                what=f"flexibility of a ring {what}, per length",
                value=ring_flexibility(section, young, thickness, sizes.ring_mesh),
                reference=frame_flexibility(section, young, thickness),
                unit="m²/N",
                kind="analytic",
                source="frame of Timoshenko beams",
                allowed=ALLOWED,
            )
        )
    return found


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """Collars and diaphragms at the joint of the paper's boom."""
    sizes = sizes or Sizes()
    boom = build_boom(friction_case())
    outer, inner = (segment.name for segment in boom.segments)
    found = variants(boom, sizes, tell)
    return Study(
        name="stiffeners",
        title="Collars and diaphragms",
        tables=[table(found, sizes), sums(found, outer, inner)],
        proofs=proofs(boom, sizes, tell),
        data={"variants": [asdict(one) for one in found]},
    )

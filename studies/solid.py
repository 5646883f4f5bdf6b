# SPDX-License-Identifier: LGPL-3.0-or-later
"""Error of the shell relative to a solid for walls of increasing thickness.

A short pair of boxes has constant mid-lines and walls of increasing thickness. Quantities of both
models are extrapolated to infinitely fine meshes. So only the error of shell theory remains: walls
of a shell meet at mid-lines, but a solid has corners of finite size. Both models consist of a
quarter of each segment, and measure the same displacements.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Literal, NamedTuple, TypeVar

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Segment, Support
from protractile.geometry.box import BoxSection
from protractile.runs.report.tables import Table
from protractile.shell_model.contact.wall_rows import gauss
from protractile.shell_model.reduction.mirror import ALONG_Z, BREATHING, TWISTING, SymmetryClass
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from protractile.shell_model.segment.cross_section import Row, SectionNodes
from protractile.shell_model.segment.shell import ShellMatrices
from protractile.shell_model.segment.solver import ShiftedSolver
from studies.reference_models.plates import STEEL
from studies.reference_models.shell_readings import flange_deflection
from studies.reference_models.single_segment import natural_frequencies, shell_alone
from studies.reference_models.solid import assemble_solid, mesh_quarter
from studies.refined import Refined, refined_table
from studies.study import Criterion, Piece, Progress, Verification, define_study

# Height and width in m of the boxes between mid-lines, the same for all wall thicknesses.
OUTER = (0.40, 0.30)
INNER = (0.31, 0.21)
# Positions in m of the outer box's end, and of both ends of the inner one.
HEAD, TAIL, TIP = 2.0, 1.5, 3.5

# Pads of 0.1 m in the corners of the inner box at its tail, loaded at three x (Simpson's rule).
PAD_WIDTH = 0.06
PADDED = {TAIL: 1.0 / 6.0, TAIL + 0.05: 4.0 / 6.0, TAIL + 0.1: 1.0 / 6.0}

FREQUENCY = "frequency"
# Frequency in Hz for compliances: below all elastic modes, above rigid motions.
SLOW = 5.0


class Probe(NamedTuple):
    """Displacement of a segment, and the force with this work-conjugate displacement."""

    what: str  #: name of the displacement
    family: SymmetryClass  #: symmetry class of the motions
    places: Mapping[float, float]  #: weights of the displacements by x in m
    read: Callable[[SectionNodes], Row]  #: function that returns the row of a section

    def row(self, outline: Callable[[float], SectionNodes]) -> Row:
        """Return the sum of rows at all places; ``outline`` returns the outline at x in m."""
        return sum((weight * self.read(outline(x)) for x, weight in self.places.items()), Row())


def pad_squeeze(outline: SectionNodes) -> Row:
    """Return the row of the distance in m between the flanges, at pads in the corners."""
    half = 0.5 * outline.section.size("y")
    rows = (
        side * weight * flange_deflection(outline, side, y)
        for side in (1.0, -1.0)
        for y, weight in zip(*gauss(half - PAD_WIDTH, half, 4), strict=True)
    )
    return sum(rows, Row())


PROBES: tuple[Sequence[Probe], Sequence[Probe]] = (
    (
        Probe("head", ALONG_Z, {HEAD: 1.0}, partial(SectionNodes.wall_deflection, direction="z")),
        Probe("head twist", TWISTING, {HEAD: 1.0}, SectionNodes.twist),
    ),
    (
        Probe("tip", ALONG_Z, {TIP: 1.0}, partial(SectionNodes.wall_deflection, direction="z")),
        Probe("tip twist", TWISTING, {TIP: 1.0}, SectionNodes.twist),
        Probe("tail squeeze", BREATHING, {TAIL: 1.0}, SectionNodes.distortion),
        Probe("pad squeeze", BREATHING, PADDED, pad_squeeze),
    ),
)


class Quarter(NamedTuple):
    """Quarter of a segment, for one symmetry class of its motions."""

    model: (
        ShellMatrices  #: a quarter of a shell or of a solid, with the energies of the whole segment
    )
    rows: Mapping[str, Array]  #: name of a probe → (num_dofs,)

    def measure(self) -> dict[str, float]:
        """Return the lowest elastic frequency in Hz, and the compliance of each probe.

        Compliances at the frequency ``SLOW`` are in m/N or rad/(N·m).
        """
        rigid = self.model.rigid_motions().shape[1]
        frequency = float(natural_frequencies(self.model, rigid + 1)[-1])
        solve = ShiftedSolver(self.model, SLOW)
        moved = {what: float(row @ solve(row[:, None])[:, 0]) for what, row in self.rows.items()}
        solve.destroy()
        return {FREQUENCY: frequency, **moved}


def pair(wall: float) -> tuple[Segment, Segment]:
    """Return the outer box on two supports, and the free inner one, with a wall in m."""
    held = (Support(0.0), Support(0.5))
    return box("outer", 0.0, HEAD, OUTER, wall, held), box("inner", TAIL, TIP, INNER, wall)


def shell_parts(
    segment: Segment, probes: Sequence[Probe], size: float
) -> dict[SymmetryClass, Quarter]:
    """Return a segment's symmetry classes as shells, with triangles of a size in m."""
    whole = shell_alone(segment, size, [x for probe in probes for x in probe.places])
    rows = np.column_stack([whole.row(probe.row(whole.outline)) for probe in probes])
    symmetry = SymmetryReduction(whole)
    return {
        job.symmetry_class: Quarter(
            job.shell(symmetry.cell),
            {
                probe.what: force
                for probe, force in zip(probes, job.forces.T, strict=True)
                if probe.family == job.symmetry_class
            },
        )
        for job in symmetry.jobs(rows, rows[:, :0], rows[:, :0])
    }


def solid_parts(
    segment: Segment,
    probes: Sequence[Probe],
    along: tuple[float, float],
    around: float,
    splits: int,
    layers: int = 2,
) -> dict[SymmetryClass, Quarter]:
    """Return a segment's symmetry classes as solids; see :func:`mesh_quarter` for the sizes."""
    assert isinstance(segment.section, BoxSection)
    read = (x for probe in probes for x in probe.places)
    held = (support.x for support in segment.supports)
    places = sorted({segment.start, segment.end, *held, *read})
    mesh = mesh_quarter(segment.section, places, along, around, splits, layers)
    families = dict.fromkeys(probe.family for probe in probes)
    models = {family: assemble_solid(segment, mesh, family) for family in families}
    return {
        family: Quarter(
            model,
            {
                probe.what: model.row(probe.row(model.outline))
                for probe in probes
                if probe.family == family
            },
        )
        for family, model in models.items()
    }


def box(
    name: str,
    start: float,
    end: float,
    midpoints: tuple[float, float],
    wall: float,
    supports: tuple[Support, ...] = (),
) -> Segment:
    """Return a box of steel, with the distances in m of its mid-lines."""
    section = BoxSection(*midpoints, wall, wall)
    return Segment.of_section(name, start, end, STEEL, section, supports=supports)


# Permitted error of the thinnest walls; on a line at a free end, between the corners, a shell is
# least accurate.
ALLOWED, ALLOWED_OF_A_SQUEEZE = 0.01, 0.04


class Sizes(NamedTuple):
    """Parameters of the study."""

    #: Wall thicknesses in m, ascending.
    walls: Sequence[float] = tuple(np.geomspace(0.004, 0.04, 4).round(4).tolist())
    #: Edge lengths of the shells in m, each half the previous length.
    triangles: Sequence[float] = (0.05, 0.025, 0.0125)
    #: Numbers of parts of the solids' edges around the section, one for each of ``triangles``.
    splits: Sequence[int] = (1, 2, 4)
    #: See :func:`studies.reference_models.solid.mesh_quarter`.
    along: tuple[float, float] = (0.0125, 0.2)
    around: float = 0.1


class Quantity(NamedTuple):
    """Quantity of the pair."""

    what: str  #: name of the quantity
    unit: str  #: unit of the values
    segment: Literal[0, 1]  #: 0 for the outer box, 1 for the inner one
    family: SymmetryClass  #: symmetry class of the motions
    probe: str = FREQUENCY  #: probe of a compliance; ``FREQUENCY`` for the lowest frequency
    allowed: float = ALLOWED  #: permitted error of the thinnest walls

    def of(self, answers: Sequence[Mapping[SymmetryClass, Mapping[str, float]]]) -> float:
        """Return the value of the quantity from the measurements of both segments in a model."""
        return answers[self.segment][self.family][self.probe]


FREQUENCIES = (
    Quantity("free inner box, lowest frequency along z", "Hz", 1, ALONG_Z),
    Quantity("free inner box, lowest of twisting", "Hz", 1, TWISTING),
    Quantity("free inner box, lowest of breathing", "Hz", 1, BREATHING),
    Quantity("held outer box, lowest frequency along z", "Hz", 0, ALONG_Z),
    Quantity("held outer box, lowest of twisting", "Hz", 0, TWISTING),
)
COMPLIANCES = (
    Quantity("held outer box, deflection of its head", "m/N", 0, ALONG_Z, "head"),
    Quantity("held outer box, twist of its head", "rad/(N·m)", 0, TWISTING, "head twist"),
    Quantity("free inner box, squeeze of its tail", "m/N", 1, BREATHING, "tail squeeze",
             ALLOWED_OF_A_SQUEEZE),
    Quantity("free inner box, squeeze of its tail by pads", "m/N", 1, BREATHING, "pad squeeze",
             ALLOWED_OF_A_SQUEEZE),
)  # fmt: skip
EVERY = FREQUENCIES + COMPLIANCES


class Comparison(NamedTuple):
    """Pair of boxes of one wall thickness, as shells and as solids."""

    wall: float  #: wall thickness in m
    #: Values of each quantity on all meshes.
    shell: Mapping[Quantity, Refined]
    solid: Mapping[Quantity, Refined]

    @property
    def walls(self) -> str:
        """Label of the wall thickness."""
        return f"{1.0e3 * self.wall:g} mm"

    def error(self, what: Quantity) -> float:
        """Return the error of the shell, relative to the solid."""
        return self.shell[what].best / self.solid[what].best - 1.0

    def slenderness(self, what: Quantity) -> float:
        """Return the ratio of wall thickness to the width of the box."""
        section = pair(self.wall)[what.segment].section
        assert section is not None
        return self.wall / section.size("y")


def compare(sizes: Sizes, progress: Callable[[str], None]) -> list[Comparison]:
    """Measure the pair at every wall thickness; ``progress`` reports the progress."""

    def compared(wall: float) -> Comparison:
        boxes = pair(wall)
        progress(f"walls of {1.0e3 * wall:g} mm")

        def shells(number: int, size: float) -> Mapping[SymmetryClass, Quarter]:
            return shell_parts(boxes[number], PROBES[number], size)

        def solids(number: int, splits: int) -> Mapping[SymmetryClass, Quarter]:
            return solid_parts(boxes[number], PROBES[number], sizes.along, sizes.around, splits)

        shell = _refined(wall, "shell", sizes.triangles, shells)
        solid = _refined(wall, "solid", sizes.splits, solids)
        return Comparison(wall, shell, solid)

    return [compared(wall) for wall in sizes.walls]


_Size = TypeVar("_Size")


def _refined(
    wall: float,
    model: str,
    sizes: Sequence[_Size],
    parts_of: Callable[[int, _Size], Mapping[SymmetryClass, Quarter]],
) -> dict[Quantity, Refined]:
    """Return the values of each quantity on all meshes of a model."""
    values = [
        [
            {family: part.measure() for family, part in parts_of(number, size).items()}
            for number in (0, 1)
        ]
        for size in sizes
    ]
    halvings = [2.0**i for i in reversed(range(len(sizes)))]
    where = f"{1.0e3 * wall:g} mm, {model}"
    return {
        what: Refined(
            f"{where}: {what.what}", what.unit, halvings, [what.of(one) for one in values]
        )
        for what in EVERY
    }


def order(comparisons: Sequence[Comparison], what: Quantity) -> float:
    """Return the exponent p of the shell's error ~ thicknessᵖ, from the two thickest walls."""
    thin, thick = comparisons[-2:]
    growth = thick.error(what) / thin.error(what)
    return math.log(growth) / math.log(thick.wall / thin.wall) if growth > 0.0 else math.nan


def slenderness_at(comparisons: Sequence[Comparison], what: Quantity, limit: float) -> str:
    """Return the ratio of thickness to width at which the error is ``limit``, by interpolation."""
    errors = [abs(one.error(what)) for one in comparisons]
    ratios = [one.slenderness(what) for one in comparisons]
    above = [error > limit for error in errors]
    if not any(above):
        return f"> {ratios[-1]:.3f}"
    if above[0]:
        return f"< {ratios[0]:.3f}"
    # Take the last crossing, since an error that changes its sign is small where it does.
    last = max(i for i in range(1, len(above)) if above[i] and not above[i - 1])
    part = math.log(limit / errors[last - 1]) / math.log(errors[last] / errors[last - 1])
    return f"{ratios[last - 1] * (ratios[last] / ratios[last - 1]) ** part:.3f}"


# A slender box with thick walls, which behaves as a rod because its section hardly deforms.
BAR = box("bar", 0.0, 2.0, (0.10, 0.08), 0.03)


def rod_verification() -> Verification:
    """Compare the lowest frequency of a solid rod with a formula."""
    section, steel, length = BAR.section, BAR.material, BAR.length
    assert isinstance(section, BoxSection)
    mesh = mesh_quarter(section, (BAR.start, BAR.end), (0.1, 0.1), 0.1)
    found = float(natural_frequencies(assemble_solid(BAR, mesh, BREATHING), 2)[1])
    # A lateral inertia slows a rod's waves (Rayleigh 1877, section 157; Love 1927, section 278).
    polar = section.polar_second_moment_of_area / section.area
    slowed = np.sqrt(1.0 + steel.poissons_ratio**2 * polar * (np.pi / length) ** 2)
    rod = float(0.5 * np.sqrt(steel.youngs_modulus / steel.density) / length / slowed)
    criterion: Criterion = ("analytic", "c / 2L with lateral inertia (Love 1927)", 1.0e-4)
    return Verification("solid box: lowest frequency as a rod", found, rod, "Hz", *criterion)


# Errors for which the table gives the wall thickness.
LIMITS = (0.01, 0.02, 0.05)

NOTES = (
    "Two boxes of 2 m, mid-lines 0.40 m x 0.30 m and 0.31 m x 0.21 m, walls t, b the width of the "
    "box itself. Both models at Richardson's limit of three meshes. The order is between the two "
    "thickest walls.",
    "The lowest mode of a box with thin walls is bending of the walls; with thick walls it is "
    "bending of the box as a beam.",
    "Both have the same mass. The shell lacks t_web h t_flange²/2 of the second moment, which is "
    "of the order (t/h)²; and its walls bend from mid-line to mid-line. Walls of the solid "
    "bend from corner to corner, a difference of the order t/b.",
)


def error_table(comparisons: Sequence[Comparison]) -> Table:
    """Return a table of the shell's error by thickness, its order, and limits of thickness."""
    columns = {
        "quantity": "", **{f"{one.walls}\n(%)": ".2f" for one in comparisons}, "order in t": ".2f",
        **{f"{100.0 * limit:g} %\nat t/b": "" for limit in LIMITS},
    }  # fmt: skip
    return Table.of_rows(
        "solid-error",
        "Error of the shell against a solid",
        columns,
        [
            (
                what.what,
                *(100.0 * one.error(what) for one in comparisons),
                order(comparisons, what),
                *(slenderness_at(comparisons, what, limit) for limit in LIMITS),
            )
            for what in EVERY
        ],
        NOTES,
    )


def refinements(comparisons: Sequence[Comparison]) -> Table:
    """Return the table of the convergence of both models."""
    models = [model for one in comparisons for model in (one.shell, one.solid)]
    found = [model[what] for what in EVERY for model in models]
    return refined_table("solid-index", "Both models on ever finer meshes", found, "edges × {:g}")


def shell_verifications(thinnest: Comparison) -> Iterator[Verification]:
    """Return the verifications of the shell of the thinnest walls against the solid."""
    walls, source = f"walls of {thinnest.walls}", "elasticity in space"
    for of in EVERY:
        shell, solid = thinnest.shell[of].best, thinnest.solid[of].best
        criterion: Criterion = ("other code", source, of.allowed)
        yield Verification(f"{of.what}, {walls}", shell, solid, of.unit, *criterion)


@define_study("solid", "Shells against solids")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Compare the shell with a solid, and a solid rod with a closed form."""
    sizes = sizes or Sizes()
    progress("a solid rod")
    yield rod_verification()
    comparisons = compare(sizes, progress)
    yield from shell_verifications(comparisons[0])
    yield error_table(comparisons)
    yield refinements(comparisons)

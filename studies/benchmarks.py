# SPDX-License-Identifier: LGPL-3.0-or-later
"""Accuracy of the shell element on published benchmarks and on tests with exact results."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from runs.case.build import build_boom
from runs.report.formatting import scientific
from runs.report.tables import Cell, Table
from shell_model.segment.forms import DRILLING, DRILLING_OF_CURVED
from studies.motions import friction_case
from studies.reference_models import benchmarks
from studies.reference_models.benchmarks import PUBLISHED, SHEAR_RIGID
from studies.reference_models.plates import OBLIQUE, Patch, SupportedPlate, constant_strains
from studies.reference_models.prismatic import ANGLE, BOX, PlainBox
from studies.refined import Reference, Refined, refined_table
from studies.study import Criterion, Piece, Plot, Progress, Verification, define_study

# Thickness of the vibrating plates over their longer side.
THIN, THICK = 0.001, 0.1

NOTES = (
    "Edges along a side of the symmetric part that is computed, over the width of the twisted "
    "beam, over a wall of a section in torsion. Order, limit and index of the three finest values.",
    "The published dent of the cylinder belongs to a shell without shear strain; with shear it is "
    "3 % deeper, and has no limit under a force in a point. Facets near the force are smaller.",
    "Twisting moments fall to zero in a layer as wide as the wall is thick along free and simply "
    "held edges: the roof and the angle give way a little more as the mesh begins to see it.",
)
DRILLING_NOTE = (
    f"The default is {DRILLING:g} where plates are folded and {DRILLING_OF_CURVED:g} where facets "
    "approach a curved surface. A stiff tie resists the shear flow around a fold; a soft one lets "
    "a warped surface give way."
)


@dataclass(frozen=True, slots=True)
class Sizes:
    """Numbers of edges along a side on at least three meshes; each is twice the previous number."""

    roof: Sequence[int] = (4, 8, 16, 32, 64)
    cylinder: Sequence[int] = (12, 24, 48, 96)
    hemisphere: Sequence[int] = (8, 16, 32, 64)
    twisted: Sequence[int] = (1, 2, 4, 8, 16)
    plate: Sequence[int] = (4, 8, 16, 32, 64)
    torsion: Sequence[int] = (2, 4, 8)  #: edges over the width of each wall
    slenderness: int = 20  #: edges along a twisted member per edge over a wall
    box: float = 0.2  #: edge length of the boxes in m
    frequencies: int = 10  #: number of frequencies of a box or plate
    decades: int = 4  #: range of the drilling penalty in powers of ten


def refined(
    what: str, unit: str, edges: Sequence[int], values: Sequence[float], reference: Reference
) -> Refined:
    """Return the values of a benchmark on several meshes, with sizes relative to the finest one."""
    sizes = [edges[-1] / n for n in edges]
    return Refined(f"{what}, {edges[-1]} edges", unit, sizes, values, reference)


def published(sizes: Sizes) -> list[Refined]:
    """Return the values of benchmarks with published results, on all meshes."""
    stiff_in_shear = partial(benchmarks.pinched_cylinder, shear_correction=SHEAR_RIGID)
    twisted = [benchmarks.twisted_beam(n) for n in sizes.twisted]
    macneal, beam = "MacNeal and Harder 1985", PUBLISHED.twisted_beam
    rows: list[tuple[str, Sequence[int], Sequence[float], float, str, float]] = [
        ("Scordelis-Lo roof", sizes.roof, [benchmarks.scordelis_lo_roof(n) for n in sizes.roof],
         PUBLISHED.scordelis_lo_roof, "Scordelis and Lo 1964", 0.01),
        ("pinched cylinder", sizes.cylinder, [stiff_in_shear(n) for n in sizes.cylinder],
         PUBLISHED.pinched_cylinder, "Flügge 1960, no shear", 0.01),
        ("hemisphere", sizes.hemisphere, [benchmarks.hemisphere(n) for n in sizes.hemisphere],
         PUBLISHED.hemisphere, macneal, 0.02),
        ("twisted, in plane", sizes.twisted, [one.in_plane for one in twisted],
         beam.in_plane, macneal, 0.01),
        ("twisted, across", sizes.twisted, [one.out_of_plane for one in twisted],
         beam.out_of_plane, macneal, 0.01),
    ]  # fmt: skip
    return [
        refined(what, "", edges, values, Reference(value, "external", source, allowed))
        for what, edges, values, value, source, allowed in rows
    ]


def plates(sizes: Sizes) -> list[Refined]:
    """Return the first and fourth frequency of thin and moderately thick plates, on all meshes."""
    thin, thick = (SupportedPlate(1.0, 0.8, thickness) for thickness in (THIN, THICK))
    found = []
    for name, plate, exact, source in (
        ("thin", thin, thin.kirchhoff(4), f"Kirchhoff's plate, t/a = {THIN:g}, Navier 1823"),
        ("thick", thick, thick.mindlin(4), f"t/a = {THICK:g}, Mindlin 1951"),
    ):
        measured = np.array([plate.frequencies(n, 4) for n in sizes.plate])
        for mode in (1, 4):
            reference = Reference(float(exact[mode - 1]), "analytic", source, 0.01)
            what, values = f"{name} plate, mode {mode}", measured[:, mode - 1].tolist()
            found.append(refined(what, "Hz", sizes.plate, values, reference))
    return found


def torsion(sizes: Sizes) -> Iterator[Refined]:
    """Yield the torsion constants of an open and a closed section, on all meshes."""
    for name, member, source, allowed in (
        ("angle 100 × 100 × 1 mm", ANGLE, "Σ b t³/3, Saint-Venant 1855", 0.005),
        ("box 100 × 60 × 1 mm", BOX, "4 A² t/Σ b + Σ b t³/3, Bredt 1896", 0.001),
    ):
        found = [member.torsion_constant(n, sizes.slenderness * n) for n in sizes.torsion]
        reference = Reference(member.thin_walled_constant, "analytic", source, allowed)
        yield refined(f"torsion constant, {name}", "m⁴", sizes.torsion, found, reference)


def exactness(box: PlainBox, sizes: Sizes) -> Iterator[Verification]:
    """Compare patches under constant strain and a rotated box with exact results."""
    patch = Patch.of()
    criterion: Criterion = ("analytic", "the field that is held on its edges", 1.0e-11)
    for state in constant_strains():
        what = f"patch under constant {state.name} strain, oblique: largest error"
        yield Verification(what, patch.error(state), 0.0, "", *criterion)
    straight, turned = (
        box.free_frequencies(sizes.box, sizes.frequencies, turn=turn) for turn in (None, OBLIQUE)
    )
    worst = int(np.abs(turned / straight - 1.0).argmax())
    what = f"box turned in space: frequency {worst + 1}, which changes most"
    criterion = ("analytic", "the same box along x", 1.0e-8)
    yield Verification(what, float(turned[worst]), float(straight[worst]), "Hz", *criterion)


def drilling(box: PlainBox, y: float, sizes: Sizes) -> Iterator[Table | Verification]:
    """Vary the drilling penalty of boxes and of a twisted beam, up to 100 times its default.

    Args:
        box: an outer segment.
        y: lateral position in m of the contact with the inner segment.
        sizes: parameters of the study.
    """
    powers = 10.0 ** np.arange(sizes.decades + 1)
    soft, stiff = DRILLING * 1.0e-2 * powers, DRILLING_OF_CURVED * powers
    supports, station = (0.0, 0.2 * box.length), 0.9 * box.length
    rows: list[Sequence[Cell]] = []
    for what, default, ties, measure in (
        ("frequencies of the free box", DRILLING, soft,
         lambda tie: box.free_frequencies(sizes.box, sizes.frequencies, tie)),
        ("contact compliance of the box", DRILLING, soft,
         lambda tie: [box.compliance(sizes.box, supports, station, y, tie)]),
        ("twisted beam", DRILLING_OF_CURVED, stiff,
         lambda tie: benchmarks.twisted_beam(sizes.twisted[-2], tie)),
    ):  # fmt: skip
        values = np.array([measure(tie) for tie in ties])
        changes = values / values[np.isclose(ties, default)] - 1.0
        rows += [
            (what, tie, 100.0 * change[np.abs(change).argmax()])
            for tie, change in zip(ties, changes, strict=True)
        ]
        first, last = (scientific(tie) for tie in ties[[0, -1]])
        spread = float((np.ptp(values, axis=0) / np.abs(values[0])).max())
        criterion: Criterion = ("non-regression", f"the default tie, {scientific(default)}", 1.0e-3)
        what = f"{what}: spread over drilling ties from {first} to {last}"
        yield Verification(what, spread, 0.0, "", *criterion)
    columns = {"what": "", "tie / (G t)": ".1g", "largest change from the default (%)": ".4f"}
    title = "Effect of the drilling tie"
    yield Table.of_rows("drilling", title, columns, rows, (DRILLING_NOTE,))


@define_study("benchmarks", "The shell element")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Run benchmarks, patches, plates, torsion, a rotated box, and the drilling penalty."""
    sizes = sizes or Sizes()
    outer, inner = (segment.section for segment in build_boom(friction_case()).segments)
    assert outer is not None
    assert inner is not None
    box = PlainBox(outer, 10.0)
    progress("published benchmarks")
    known = published(sizes)
    progress("plates and torsion")
    found = [*known, *plates(sizes), *torsion(sizes)]
    yield from (one.verification for one in found)
    progress("pinched cylinder with shear")
    dents = [benchmarks.pinched_cylinder(n) for n in sizes.cylinder]
    sheared = Refined("pinched cylinder with shear", "", known[1].sizes, dents)
    title = "The shell against published and analytic values"
    yield refined_table("benchmarks", title, [*found, sheared], "edges × {:g}", NOTES)
    progress("patches and a turned box")
    yield from exactness(box, sizes)
    progress("drilling ties")
    yield from drilling(box, 0.5 * inner.size("y"), sizes)
    x = "length of an edge over the finest one's"
    title = "Flat facets close in on the published values"
    caption = (
        "Relative error against the published value. It levels off where the value itself is no "
        "more accurate."
    )
    curves = {one.what: (list(one.sizes), one.errors) for one in known}
    yield Plot("benchmarks", title, x, "relative error", curves, caption)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Accuracy of the shell element on published benchmarks and on plates with exact frequencies."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from studies.reference_models import benchmarks
from studies.reference_models.benchmarks import PUBLISHED, SHEAR_RIGID
from studies.reference_models.plates import SupportedPlate
from studies.refined import Reference, Refined, refined_table
from studies.study import Piece, Plot, Progress, define_study

# Thickness of the vibrating plates over their longer side.
THIN, THICK = 0.001, 0.1

NOTES = (
    "Edges along a side of the symmetric part that is computed, over the width of the twisted "
    "beam. Order, limit and index of the three finest values.",
    "The published dent of the cylinder belongs to a shell without shear strain; with shear it is "
    "3 % deeper, and has no limit under a force in a point. Facets near the force are smaller.",
    "Twisting moments fall to zero in a layer as wide as the wall is thick along free and simply "
    "held edges: the roof gives way a little more as the mesh begins to see it.",
)


class Sizes(NamedTuple):
    """Numbers of edges along a side on at least three meshes; each is twice the previous number."""

    roof: Sequence[int] = (4, 8, 16, 32, 64)
    cylinder: Sequence[int] = (12, 24, 48, 96)
    hemisphere: Sequence[int] = (8, 16, 32, 64)
    twisted: Sequence[int] = (1, 2, 4, 8, 16)
    plate: Sequence[int] = (4, 8, 16, 32, 64)


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
        Refined.by_edges(what, "", edges, values, Reference(value, "external", source, allowed))
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
            found.append(Refined.by_edges(what, "Hz", sizes.plate, values, reference))
    return found


@define_study("benchmarks", "The shell element")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Run published benchmarks and vibrating plates on finer and finer meshes."""
    sizes = sizes or Sizes()
    progress("published benchmarks")
    known = published(sizes)
    progress("plates")
    found = [*known, *plates(sizes)]
    yield from (one.verification for one in found)
    progress("pinched cylinder with shear")
    dents = [benchmarks.pinched_cylinder(n) for n in sizes.cylinder]
    sheared = Refined("pinched cylinder with shear", "", known[1].sizes, dents)
    title = "The shell against published and analytic values"
    yield refined_table("benchmarks", title, [*found, sheared], "edges × {:g}", NOTES)
    x = "length of an edge over the finest one's"
    title = "Flat facets close in on the published values"
    caption = (
        "Relative error against the published value. It levels off where the value itself is no "
        "more accurate."
    )
    curves = {one.what: (list(one.sizes), one.errors) for one in known}
    yield Plot("benchmarks", title, x, "relative error", curves, caption)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The shell element on the field's benchmarks, and on what it must do exactly."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from runs.case.build import build_boom
from runs.report.tables import TextTable
from runs.report.theme import fixed, scientific
from runs.studies.motions import friction_case
from runs.studies.refined import Refined, refined_plot, refined_table
from runs.studies.study import Proof, Study
from shell_model.forms import DRILLING, DRILLING_OF_CURVED
from shell_model.verification import benchmarks
from shell_model.verification.benchmarks import PUBLISHED, SHEAR_RIGID
from shell_model.verification.plates import OBLIQUE, Patch, SupportedPlate, constant_strains
from shell_model.verification.prismatic import ANGLE, BOX, PlainBox

Array = npt.NDArray[np.float64]

# Thickness of the plates that vibrate over their longer side.
THIN, THICK = 0.001, 0.1

NOTES = (
    "Edges along a side of the symmetric part that is computed, over the width of the twisted "
    "beam, over a wall of a section in torsion. Order of the three finest values.",
    "The published dent of the cylinder is that of a shell without shear strain; with shear it is "
    "3 % deeper, and has no limit under a force in a point. Facets near the force are smaller.",
    "Twisting moments fall to zero in a layer as wide as the wall is thick along free and simply "
    "held edges: the roof and the angle give way a little more as the mesh begins to see it.",
)


@dataclass(frozen=True, slots=True)
class Sizes:
    """Meshes as numbers of edges along a side, each twice the one before, three at least.

    Args:
        roof, cylinder, hemisphere, twisted, plate: of each.
        torsion: over the width of each wall, one or more.
        slenderness: edges along a twisted member for each one over a wall.
        box: edge length of the boxes in m.
        frequencies: how many of a box or plate.
        decades: how far the drilling tie varies, in powers of ten.
    """

    roof: Sequence[int] = (4, 8, 16, 32, 64)
    cylinder: Sequence[int] = (12, 24, 48, 96)
    hemisphere: Sequence[int] = (8, 16, 32, 64)
    twisted: Sequence[int] = (1, 2, 4, 8, 16)
    plate: Sequence[int] = (4, 8, 16, 32, 64)
    torsion: Sequence[int] = (2, 4, 8)
    slenderness: int = 20
    box: float = 0.2
    frequencies: int = 10
    decades: int = 4


def published(sizes: Sizes, tell: Callable[[str], None]) -> list[Refined]:
    """The benchmarks with published values."""
    tell("Scordelis-Lo roof")
    roof = [benchmarks.scordelis_lo_roof(n) for n in sizes.roof]
    tell("pinched cylinder")
    thin = [benchmarks.pinched_cylinder(n, shear_correction=SHEAR_RIGID) for n in sizes.cylinder]
    tell("hemisphere")
    half = [benchmarks.hemisphere(n) for n in sizes.hemisphere]
    tell("twisted beam")
    twisted = [benchmarks.twisted_beam(n) for n in sizes.twisted]
    macneal = "MacNeal and Harder 1985"
    beam = PUBLISHED.twisted_beam

    def refined(
        what: str,
        edges: Sequence[int],
        values: Sequence[float],
        reference: float,
        source: str,
        allowed: float,
    ) -> Refined:
        return Refined(what, "", edges, values, reference, "external", source, allowed)

    return [
        refined(
            "Scordelis-Lo roof",
            sizes.roof,
            roof,
            PUBLISHED.scordelis_lo_roof,
            "Scordelis and Lo 1964",
            0.01,
        ),
        refined(
            "pinched cylinder",
            sizes.cylinder,
            thin,
            PUBLISHED.pinched_cylinder,
            "Flügge 1960, no shear",
            0.01,
        ),
        refined(
            "hemisphere",
            sizes.hemisphere,
            half,
            PUBLISHED.hemisphere,
            macneal,
            0.02,
        ),
        refined(
            "twisted, in plane",
            sizes.twisted,
            [one.in_plane for one in twisted],
            beam.in_plane,
            macneal,
            0.01,
        ),
        refined(
            "twisted, across",
            sizes.twisted,
            [one.out_of_plane for one in twisted],
            beam.out_of_plane,
            macneal,
            0.01,
        ),
    ]


def plates(sizes: Sizes, tell: Callable[[str], None]) -> list[Refined]:
    """Lowest and fourth frequency of simply supported plates, thin and moderately thick."""
    found = []
    for name, thickness, source in (
        ("thin", THIN, f"Kirchhoff's plate, t/a = {THIN:g}, Navier 1823"),
        ("thick", THICK, f"t/a = {THICK:g}, Mindlin 1951"),
    ):
        tell(f"{name} plate")
        plate = SupportedPlate(1.0, 0.8, thickness)
        exact = (plate.kirchhoff if thickness == THIN else plate.mindlin)(4)
        measured = np.array([plate.frequencies(n, 4) for n in sizes.plate])
        found += [
            Refined(
                what=f"{name} plate, mode {mode}",
                unit="Hz",
                edges=sizes.plate,
                values=measured[:, mode - 1].tolist(),
                reference=float(exact[mode - 1]),
                kind="analytic",
                source=source,
                allowed=0.01,
            )
            for mode in (1, 4)
        ]
    return found


def torsion(sizes: Sizes, tell: Callable[[str], None]) -> list[Refined]:
    """Torsion constants of an open and of a closed section."""
    tell("torsion")
    return [
        Refined(
            what=f"torsion constant, {name}",
            unit="m⁴",
            edges=sizes.torsion,
            values=[member.torsion_constant(n, sizes.slenderness * n) for n in sizes.torsion],
            reference=member.thin_walled_constant,
            kind="analytic",
            source=source,
            allowed=allowed,
        )
        for name, member, source, allowed in (
            ("angle 100 × 100 × 1 mm", ANGLE, "Σ b t³/3, Saint-Venant 1855", 0.005),
            ("box 100 × 60 × 1 mm", BOX, "4 A² t/Σ b + Σ b t³/3, Bredt 1896", 0.001),
        )
    ]


def exactness(box: PlainBox, sizes: Sizes, tell: Callable[[str], None]) -> list[Proof]:
    """What holds to round-off: patches under constant strain, and a turned box."""
    tell("patches")
    patch = Patch.of()
    found = [
        Proof(
            what=f"patch under constant {state.name} strain, oblique: largest error",
            value=patch.error(state),
            reference=0.0,
            unit="",
            kind="analytic",
            source="the field that is held on its edges",
            allowed=1.0e-11,
        )
        for state in constant_strains()
    ]
    tell("turned box")
    straight, turned = (
        box.free_frequencies(sizes.box, sizes.frequencies, turn=turn) for turn in (None, OBLIQUE)
    )
    worst = int(np.abs(turned / straight - 1.0).argmax())
    found.append(
        Proof(
            what=f"box turned in space: frequency {worst + 1}, which changes most",
            value=float(turned[worst]),
            reference=float(straight[worst]),
            unit="Hz",
            kind="analytic",
            source="the same box along x",
            allowed=1.0e-8,
        )
    )
    return found


@dataclass(frozen=True, slots=True)
class Drilling:
    """Results under ever stiffer drilling ties.

    Args:
        what: is measured.
        default: tie.
        ties: from the softest on.
        values: (num_ties, num_values).
    """

    what: str
    default: float
    ties: Sequence[float]
    values: Array

    @property
    def spread(self) -> float:
        """Largest difference between any two ties, relative to the value itself."""
        return float((np.ptp(self.values, axis=0) / np.abs(self.values[0])).max())


def drilling(box: PlainBox, y: float, sizes: Sizes, tell: Callable[[str], None]) -> list[Drilling]:
    """Boxes under ties up to 100 times their default, a twisted beam from its own default on.

    Args:
        box: an outer segment.
        y: where the inner segment presses on it, in m from the middle.
        sizes: what is measured.
        tell: told that.
    """
    tell("drilling ties")
    powers = 10.0 ** np.arange(sizes.decades + 1)
    soft = (DRILLING * 1.0e-2 * powers).tolist()
    stiff = (DRILLING_OF_CURVED * powers).tolist()
    frequencies = [box.free_frequencies(sizes.box, sizes.frequencies, tie) for tie in soft]
    supports, station = (0.0, 0.2 * box.length), 0.9 * box.length
    flexible = [[box.compliance(sizes.box, supports, station, y, tie)] for tie in soft]
    twisted = [benchmarks.twisted_beam(sizes.twisted[-2], tie) for tie in stiff]
    return [
        Drilling("frequencies of the free box", DRILLING, soft, np.array(frequencies)),
        Drilling("contact compliance of the box", DRILLING, soft, np.array(flexible)),
        Drilling("twisted beam", DRILLING_OF_CURVED, stiff, np.array(twisted)),
    ]


def drilling_table(found: Sequence[Drilling]) -> TextTable:
    """One row a tie."""
    rows = []
    for one in found:
        for i, (tie, values) in enumerate(zip(one.ties, one.values, strict=True)):
            change = values / one.values[one.ties.index(one.default)] - 1.0
            rows.append(
                (
                    one.what if i == 0 else "",
                    scientific(tie),
                    fixed(float(change[np.abs(change).argmax()]), 4, 100.0),
                )
            )
    return TextTable(
        "What the drilling tie changes",
        ("what", "tie / (G t)", "largest change from the default (%)"),
        rows,
        (
            f"The default is {DRILLING:g} where plates are folded and {DRILLING_OF_CURVED:g} where "
            "facets approach a curved surface. A stiff tie resists the shear flow around a fold; "
            "a soft one lets a warped surface give way.",
        ),
        name="drilling",
    )


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """Benchmarks, patches, plates, torsion, a turned box, and the drilling tie."""
    sizes = sizes or Sizes()
    outer, inner = (segment.section for segment in build_boom(friction_case()).segments)
    assert outer is not None
    assert inner is not None
    box = PlainBox(outer, 10.0)
    known = published(sizes, tell)
    vibrating = plates(sizes, tell)
    twisting = torsion(sizes, tell)
    exact = exactness(box, sizes, tell)
    ties = drilling(box, 0.5 * inner.size("y"), sizes, tell)
    tell("pinched cylinder with shear")
    sheared = [benchmarks.pinched_cylinder(n) for n in sizes.cylinder]
    refined = [*known, *vibrating, *twisting]
    return Study(
        name="benchmarks",
        title="The shell element",
        tables=[
            refined_table(
                "benchmarks", "The shell against published and analytic values", refined, NOTES
            ),
            drilling_table(ties),
        ],
        proofs=[
            *(one.proof for one in refined),
            *exact,
            *(
                Proof(
                    what=f"{one.what}: spread over drilling ties from {scientific(one.ties[0])} to "
                    f"{scientific(one.ties[-1])}",
                    value=one.spread,
                    reference=0.0,
                    unit="",
                    kind="non-regression",
                    source=f"the default tie, {scientific(one.default)}",
                    allowed=1.0e-3,
                )
                for one in ties
            ),
        ],
        plots=[
            refined_plot(
                "benchmarks",
                "Flat facets close in on the published values",
                known,
                "Relative error against the published value. It levels off where the value itself "
                "is no more accurate.",
            ),
            refined_plot(
                "plates",
                "Simply supported plates close in on theory",
                vibrating,
                "Relative error of natural frequencies against Kirchhoff's and Mindlin's plates.",
            ),
        ],
        data={
            "refined": [
                {
                    "what": one.what,
                    "edges": list(one.edges),
                    "values": list(one.values),
                    "reference": one.reference,
                    "order": one.order,
                }
                for one in refined
            ],
            "pinched cylinder with shear": {"edges": list(sizes.cylinder), "values": sheared},
            "drilling": [
                {"what": one.what, "ties": list(one.ties), "values": one.values.tolist()}
                for one in ties
            ],
        },
    )

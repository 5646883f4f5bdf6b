# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact over the whole overlap, compared with contact at the stations, for the paper's boom.

Without friction the motion is chaotic after the first contacts: only the first peak is compared.
With friction the tip is compared over the whole run.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.typography import number
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.report.tables import Table
from studies.motions import (
    friction_case,
    gap_system,
    move,
    shell_of,
    with_pads,
    without_friction,
)
from studies.study import Progress, define_study

DEFAULT_POINTS = (8, 4)

NOTES = (
    "A surface has no pads: the corners of the inner box press on the outer flange beside its web, "
    "and the flange gives way there.",
    "Pads at the ends of the overlap have their midpoints half their length inside, which shortens "
    "the arm of the couple that holds the inner segment, and lets it tilt more within the play.",
)


class Sizes(NamedTuple):
    """Parameters of the study."""

    mesh: float = 0.1  #: edge length in m
    duration: float = 10.0  #: duration of the motions with friction in s
    peak: float = 0.9  #: time in s that includes the tip's first peak
    penalties: Sequence[float] = (0.1, 1.0, 10.0, 100.0)  #: parts of the default penalty per area
    #: Points along the overlap and across half a wall.
    points: Sequence[tuple[int, int]] = ((4, 4), (8, 2), DEFAULT_POINTS, (8, 6), (12, 4))
    #: Lengths and widths in m.
    pads: Sequence[tuple[float, float]] = ((0.1, 0.03), (0.1, 0.06), (0.2, 0.06))


class ContactModel(NamedTuple):
    """Type of contact: name, contacting parts, and a shell with this contact and friction."""

    name: str
    case: Case
    system: GapSystem


@define_study("surface-contact", "Contact over the whole overlap")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Table]:
    """Compare contact over surfaces and at stations, penalties, quadratures, and pad sizes."""
    sizes = sizes or Sizes()
    case = friction_case()
    shell = shell_of(case).model_copy(update={"mesh_size": sizes.mesh, "contact_tolerance": "any"})

    def touching(name: str, case: Case, **update: object) -> ContactModel:
        progress(f"contact {name}")
        system = gap_system(case, build_boom(case), shell.model_copy(update=update))
        return ContactModel(name, case, system)

    stations = [
        touching("near webs", case),
        touching("across", case, contact_line="across"),
        *(
            touching(f"pads of {length:g} m x {width:g} m", with_pads(case, length, width))
            for length, width in sizes.pads
        ),
    ]
    surfaces = {
        points: touching(
            "surface, {} x {} points".format(*points),
            case,
            contact_line="surface",
            surface_points=points,
        )
        for points in sizes.points
    }
    lines = stations[0]
    default = surfaces.get(DEFAULT_POINTS) or next(iter(surfaces.values()))
    softer = [
        ContactModel(
            f"{default.name}, {part:g} of the penalty",
            case,
            replace(default.system, laws=[law.with_weight(part) for law in default.system.laws]),
        )
        for part in sizes.penalties
    ]
    progress("motions with friction")
    tips = {
        contact.name: np.asarray(move(contact.system, sizes.duration).data["tip"].values)
        for contact in (lines, default)
    }
    apart = np.abs(tips[lines.name] - tips[default.name]).max() / np.ptp(tips[default.name])
    notes = (
        f"With friction, over {sizes.duration:g} s, the tip of the surface is up to "
        f"{100.0 * apart:.1f} % of its range from that of near webs.",
        f"Its default penalty of {number(_density(case, default.system))} N/m³ presses as both "
        "stations do when the segments approach each other alike. Points are along the overlap, "
        "and across half a wall.",
        *NOTES,
    )
    progress("first peaks")
    yield _peaks([*stations, *surfaces.values(), *softer], notes, sizes)


def _upper_stiffness(system: GapSystem) -> float:
    """Return the total stiffness in N/mⁿ of the contact rows below the inner segment."""
    return sum(term.stiffness for law in system.laws for term in law.terms if term.side > 0.0)


def _density(case: Case, system: GapSystem) -> float:
    """Return the default penalty per area in N/mⁿ⁺²."""
    boom = build_boom(case)
    (joint,) = boom.joints
    section = boom.segments[joint.inner].section
    assert section is not None
    start, end = boom.overlap(joint)
    return _upper_stiffness(system) / (section.size("y") * (end - start))


def _peaks(contacts: Sequence[ContactModel], notes: Sequence[str], sizes: Sizes) -> Table:
    """Return the table of the first tip peaks without and with friction, and their changes.

    The changes are relative to the first type of contact.
    """
    both = np.array(
        [
            [move(one, sizes.peak).first_peak()[1] for one in (without_friction(of), of)]
            for _, _, of in contacts
        ]
    )
    off = both / both[0] - 1.0
    columns = {"contact": "", "modes": ".0f", "rows": ".0f"}
    for how in ("without", "with"):
        columns[f"first tip peak\n{how} friction (mm)"] = ".1f"
        columns[f"off near webs\n{how} friction (%)"] = ".1f"
    numbers = np.stack([1.0e3 * both, 100.0 * off], axis=2).reshape(len(both), -1)
    rows = [
        (name, system.num_modes, len(system.laws), *row)
        for (name, _, system), row in zip(contacts, numbers, strict=True)
    ]
    return Table.of_rows("surface", "Where the segments touch", columns, rows, notes)

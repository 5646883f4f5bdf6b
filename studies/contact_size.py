# SPDX-License-Identifier: LGPL-3.0-or-later
"""Local compliance of walls under contacts of several sizes, on finer meshes.

The study uses the unreduced shells of the paper's boom with friction, under equal and opposite
forces at a station (:mod:`.shell_model.contact.local_compliance`). The first peak shows the effect
on the motion.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from mpi4py import MPI

from protractile.geometry.arrays import Array
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.report.tables import Table
from studies.motions import friction_case, gap_system, move, scale_mesh, shell_of, with_pads
from studies.refined import Refined, refined_table
from studies.study import Criterion, Piece, Progress, Verification, define_study

# Permitted error of the local compliance.
ALLOWED = 0.01
NANO = 1.0e9
UNIT = "1e-9 m/N"

# Stiffness in N/m of an elastic support, without effect on self-equilibrated forces.
SPRING = 1.0e6
# Distance beside a support at which its force is balanced, in m: beyond its fine mesh.
BESIDE = 0.33


class Sizes(NamedTuple):
    """Parameters of the study."""

    #: Edge lengths over the default ones, each half the one before.
    meshes: Sequence[float] = (1.0, 0.5, 0.25)
    default: float = 1.0  #: loads of the motions
    lengths: Sequence[float] = (0.05, 0.1, 0.2)  #: lengths of contacts at corners in m
    #: Lengths and widths in m.
    pads: Sequence[tuple[float, float]] = ((0.1, 0.03), (0.1, 0.06), (0.2, 0.06))
    peak: float = 0.9  #: time in s that includes the tip's first peak
    loads: Sequence[float] = (1.0, 10.0)  #: ratios to the paper's load


class Contact(NamedTuple):
    """Type of contact: name, case, and size of the loaded area (length, width) in m."""

    name: str
    case: Case
    length: float
    width: float | None


def contacts_of(case: Case, sizes: Sizes) -> list[Contact]:
    """Return the types of contact: at corners, and at pads of several sizes."""
    corners = []
    for length in sizes.lengths:
        joints = tuple(replace(joint, contact_length=length) for joint in case.joints)
        pressed = case.model_copy(update={"joints": joints})
        corners.append(Contact(f"corner of {length:g} m", pressed, length, None))
    return corners + [
        Contact(f"pad of {length:g} m x {width:g} m", with_pads(case, length, width), length, width)
        for length, width in sizes.pads
    ]


def station_compliances(contact: Contact, part: float) -> Array:
    """Return the local compliance (num_stations,) in m/N; ``part`` scales all edge lengths."""
    from protractile.shell_model.boom_shell import assemble_segments
    from protractile.shell_model.contact.local_compliance import full_compliance, local_compliance
    from protractile.shell_model.contact.rows import ShellContacts

    boom = build_boom(contact.case)
    model = scale_mesh(shell_of(contact.case), part)
    options = model.options()
    shells = assemble_segments(boom, options, MPI.COMM_SELF)
    seen = model.model_boom(boom).boom
    touching = ShellContacts.from_shells(seen, shells, options.contact_line, options.surface)
    rows = touching.rows({}).contacts
    stations = [row.station for row in rows]
    local = local_compliance(full_compliance(shells, rows), [row.law for row in rows], stations)
    _, first = np.unique(stations, return_index=True)
    return np.asarray(local[first])


def support_compliance(case: Case, parts: Sequence[float]) -> list[float]:
    """Return the local compliance of the outer segment at its last support in m/N for each mesh.

    The force of an elastic support acts on the walls. A mesh line on each side of the support, the
    same in all meshes, carries half of the opposite force. ``parts`` are ratios of the edge lengths
    to the default ones, descending.
    """
    from protractile.shell_model.boom_shell import assemble_segments
    from protractile.shell_model.contact.local_compliance import shell_compliance
    from protractile.shell_model.reduction.symmetry import SymmetryReduction

    boom = build_boom(case)
    outer = boom.segments[0]
    supports = tuple(replace(support, stiffness=SPRING) for support in outer.supports)
    elastic = replace(outer, supports=supports)
    x = max(support.x for support in supports)
    there, found = None, []
    for part in parts:
        options = scale_mesh(shell_of(case), part).options()
        held = replace(boom, segments=(elastic, *boom.segments[1:]))
        shell, *_ = assemble_segments(held, options, MPI.COMM_SELF)
        lines = np.unique(shell.nodes[:, 0])
        there = there or tuple(lines[np.abs(lines - x - far).argmin()] for far in (-BESIDE, BESIDE))
        before, at, after = (
            shell.row(shell.outline(line).wall_deflection("z")) for line in (there[0], x, there[1])
        )
        share = (there[1] - x) / (there[1] - there[0])
        squeeze = at - share * before - (1.0 - share) * after
        found.append(float(shell_compliance(SymmetryReduction(shell), squeeze[:, None])[0, 0]))
    return found


def first_peaks(contact: Contact, sizes: Sizes) -> list[float]:
    """Return the tip's first peak in m under each load, on the default mesh."""
    model = scale_mesh(shell_of(contact.case), sizes.default)
    system = gap_system(contact.case, build_boom(contact.case), model)
    loaded = (replace(system, load=load * system.load) for load in sizes.loads)
    return [move(one, sizes.peak).first_peak()[1] for one in loaded]


@define_study("contact-size", "Local compliance at contacts")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Study contacts at corners and pads of several sizes, and a support."""
    sizes = sizes or Sizes()
    default = sizes.meshes.index(sizes.default)
    criterion: Criterion = (
        "other code",
        f"edges {1.0 / sizes.meshes[-1]:g} times as short",
        ALLOWED,
    )
    progress("support")
    values = [NANO * value for value in support_compliance(friction_case(), sizes.meshes)]
    what = "local compliance, elastic support, at 2 m"
    yield Verification(what, values[default], values[-1], UNIT, *criterion)
    stations = [station.x for station in build_boom(friction_case()).stations]
    rows, found = [], [Refined("elastic support, 2 m", UNIT, sizes.meshes, values)]
    for contact in contacts_of(friction_case(), sizes):
        progress(contact.name)
        local = NANO * np.array([station_compliances(contact, part) for part in sizes.meshes])
        peaks = [1.0e3 * peak for peak in first_peaks(contact, sizes)]
        rows.append((contact.name, contact.length, contact.width, *local[default], *peaks))
        for x, values in zip(stations, local.T.tolist(), strict=True):
            found.append(Refined(f"{contact.name}, {x:g} m", UNIT, sizes.meshes, values))
            what = f"local compliance, {contact.name}, at {x:g} m"
            yield Verification(what, values[default], values[-1], UNIT, *criterion)
    columns = {
        "pressed": "", "along the boom\n(m)": ".3g", "across\n(m)": ".3g",
        **{f"local compliance\nat {x:g} m ({UNIT})": ".2f" for x in stations},
        **{f"first tip peak\nload × {load:g} (mm)": ".1f" for load in sizes.loads},
    }  # fmt: skip
    yield Table.of_rows(
        "contact-size",
        "Effect of the size of a contact",
        columns,
        rows,
        (
            "The paper's boom with its friction, default mesh. Corners are pressed where webs meet "
            "flanges; pads beside them, where the flanges bend. What the size changes of the peak "
            "is more than what any mesh does.",
        ),
    )
    title = "Local compliance on ever finer meshes"
    note = "All edges of the default mesh are longer or shorter by the same factor."
    yield refined_table("local-compliance", title, found, "edges × {:g}", (note,))

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the walls give way under contacts of every size, on ever finer meshes and by plate theory.

The paper's boom with friction, its stations squeezed
(:mod:`shell_model.contact.local_compliance`), without a reduction; and its first peak, which tells
what that is worth.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from dynamics.motion import Motion
from dynamics.splitting import integrate
from dynamics.step import contact_step
from runs.case.build import build_boom, contact_laws
from runs.case.schema import Case
from runs.report.tables import TextTable
from runs.report.theme import fixed, number
from runs.studies.grid_convergence import GridConvergence
from runs.studies.mesh import RATIO
from runs.studies.motions import finer, friction_case, gap_system, shell_of
from runs.studies.pads import with_pads
from runs.studies.study import Proof, Study
from runs.studies.working_load import OUTPUT_STEP, PHASE

Array = npt.NDArray[np.float64]

# Allowed of the local compliance and of a pressed wall.
ALLOWED = 0.01
NANO = 1.0e9


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured.

    Args:
        meshes: edge lengths over the default ones, each half the one before.
        default: of them, whose motion is taken.
        lengths: of corners that are pressed, in m.
        pads: lengths and widths in m.
        plate: edge lengths in m of the plate's mesh.
        peak: time in s within which the tip's first peak comes.
        loads: over the paper's.
    """

    meshes: Sequence[float] = (2.0, 1.0, 0.5)
    default: float = 1.0
    lengths: Sequence[float] = (0.05, 0.1, 0.2)
    pads: Sequence[tuple[float, float]] = ((0.1, 0.03), (0.1, 0.06), (0.2, 0.06))
    plate: Sequence[float] = (0.0125, 0.00625)
    peak: float = 0.9
    loads: Sequence[float] = (1.0, 10.0)


class Contact(NamedTuple):
    """A way to touch: its name and case, and length and width in m of what is pressed."""

    name: str
    case: Case
    length: float
    width: float


def contacts_of(case: Case, sizes: Sizes) -> list[Contact]:
    """Corners and pads."""
    corners = []
    for length in sizes.lengths:
        joints = tuple(joint.model_copy(update={"contact_length": length}) for joint in case.joints)
        pressed = case.model_copy(update={"joints": joints})
        corners.append(Contact(f"corner of {length:g} m", pressed, length, 0.0))
    return corners + [
        Contact(f"pad of {length:g} m x {width:g} m", with_pads(case, length, width), length, width)
        for length, width in sizes.pads
    ]


def squeezed(contact: Contact, part: float) -> Array:
    """(num_stations,) local compliance in m/N, edges so many times as long as the default ones."""
    from shell_model.boom_shell import assemble_segments
    from shell_model.contact.local_compliance import full_compliance, local_compliance
    from shell_model.contact.rows import gap_rows

    boom = build_boom(contact.case)
    model = finer(shell_of(contact.case), part)
    options = model.options()
    shells = assemble_segments(boom, options, MPI.COMM_SELF)
    laws = contact_laws(contact.case, model)
    rows = gap_rows(
        boom, shells, {"z": laws, "y": ()}, options.contact_line, options.surface
    ).contacts
    stations = [row.station for row in rows]
    local = local_compliance(full_compliance(shells, rows), [row.law for row in rows], stations)
    _, first = np.unique(stations, return_index=True)
    return np.asarray(local[first])


def first_peaks(contact: Contact, sizes: Sizes) -> list[float]:
    """The tip's first peak in m under each load, on the default mesh."""
    model = finer(shell_of(contact.case), sizes.default)
    system = gap_system(contact.case, build_boom(contact.case), model)
    step = contact_step(system, OUTPUT_STEP, phase=PHASE)
    return [
        integrate(Motion(replace(system, load=load * system.load), sizes.peak, OUTPUT_STEP), step)
        .first_peak()[1]
        for load in sizes.loads
    ]  # fmt: skip


@dataclass(frozen=True, slots=True)
class Found:
    """What a contact gives.

    Args:
        contact: which.
        local: (num_meshes, num_stations) in m/N.
        peaks: in m, one for each load.
    """

    contact: Contact
    local: Array
    peaks: Sequence[float]


def size_table(found: Sequence[Found], sizes: Sizes) -> TextTable:
    """What the size of a contact means for the boom."""
    default = sizes.meshes.index(sizes.default)
    rows = [
        (
            one.contact.name,
            f"{one.contact.length:g}",
            f"{one.contact.width:g}" if one.contact.width else "",
            *(fixed(value, 2, NANO) for value in one.local[default]),
            *(fixed(peak, 1, 1.0e3) for peak in one.peaks),
        )
        for one in found
    ]
    stations = build_boom(found[0].contact.case).stations
    return TextTable(
        "What the size of a contact means",
        (
            "pressed",
            "along the boom\n(m)",
            "across\n(m)",
            *(f"local compliance\nat {x:g} m (1e-9 m/N)" for x, _ in stations),
            *(f"first tip peak\nload × {load:g} (mm)" for load in sizes.loads),
        ),
        rows,
        (
            "The paper's boom with its friction, default mesh. Corners are pressed where webs meet "
            "flanges; pads beside them, where the flanges bend. What the size changes of the peak "
            "is more than what any mesh does.",
        ),
        name="contact-size",
    )


def mesh_table(found: Sequence[Found], sizes: Sizes) -> TextTable:
    """How the local compliance settles as meshes refine."""
    stations = build_boom(found[0].contact.case).stations
    rows = []
    for one in found:
        for (x, _), values in zip(stations, one.local.T, strict=True):
            convergence = GridConvergence.of(values.tolist(), RATIO)
            rows.append(
                (
                    f"{one.contact.name}, {x:g} m",
                    *(number(NANO * value, 5) for value in values),
                    fixed(convergence.order, 2),
                    fixed(convergence.index, 2, 100.0),
                )
            )
    return TextTable(
        "Local compliance on ever finer meshes (1e-9 m/N)",
        ("contact", *(f"edges × {part:g}" for part in sizes.meshes), "order", "GCI (%)"),
        rows,
        ("Edges are those of the default mesh, all of them longer or shorter by the same factor.",),
        name="local-compliance",
    )


def proofs(found: Sequence[Found], sizes: Sizes) -> list[Proof]:
    """The default mesh against the finest."""
    default = sizes.meshes.index(sizes.default)
    stations = build_boom(found[0].contact.case).stations
    return [
        Proof(
            f"local compliance, {one.contact.name}, at {x:g} m",
            NANO * float(values[default]),
            NANO * float(values[-1]),
            "1e-9 m/N",
            "other code",
            f"edges {1.0 / sizes.meshes[-1]:g} times as short",
            ALLOWED,
        )
        for one in found
        for (x, _), values in zip(stations, one.local.T, strict=True)
    ]


def plate_proofs(sizes: Sizes) -> list[Proof]:
    """A wall under a patch beside its edge."""
    from shell_model.verification.pressed_plate import flange

    found = []
    for edges in ("simply supported", "clamped"):
        plate = flange(edges)
        theory = plate.theory()
        found += [
            Proof(
                f"{edges} plate under a patch beside its edge, mesh of {1e3 * size:g} mm",
                NANO * plate.shell(size),
                NANO * theory,
                "1e-9 m/N",
                "analytic",
                "Reissner and Mindlin's plate, by Ritz's method",
                ALLOWED,
            )
            for size in sizes.plate
        ]
    return found


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """Corners and pads of several sizes, and a plate."""
    sizes = sizes or Sizes()
    tell("plates")
    plates = plate_proofs(sizes)
    found = []
    for contact in contacts_of(friction_case(), sizes):
        tell(contact.name)
        local = np.array([squeezed(contact, part) for part in sizes.meshes])
        found.append(Found(contact, local, first_peaks(contact, sizes)))
    return Study(
        name="contact-size",
        title="What walls give way where segments touch",
        tables=[size_table(found, sizes), mesh_table(found, sizes)],
        proofs=[*plates, *proofs(found, sizes)],
        data={
            one.contact.name: {"local": one.local.tolist(), "first_peaks": list(one.peaks)}
            for one in found
        },
    )

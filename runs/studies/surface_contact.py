# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact over the whole overlap beside contact at the stations, on the paper's boom.

Without friction the motion is chaotic after its first presses, so the first peak is compared; with
friction the tip over the whole run.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from dynamics.gap_system import GapSystem
from dynamics.motion import Motion
from dynamics.splitting import integrate
from dynamics.step import contact_step
from dynamics.trajectory import Trajectory
from runs.case.build import build_boom, contact_laws
from runs.case.kinds.shell import ShellTable
from runs.case.schema import Case
from runs.report.tables import TextTable
from runs.report.theme import fixed, number
from runs.studies.motions import friction_case, gap_system, model_of, shell_of
from runs.studies.pads import flexibility_table, pad_proofs, with_pads
from runs.studies.study import Plot, Proof, Study

Array = npt.NDArray[np.float64]

OUTPUT_STEP = 1.0e-3
# Of the highest frequency of the contacts, see dynamics.step: thrice what a run would take, which
# changes the tip with friction by less than 0.1 % of its range.
PHASE = 0.1
# Beyond the play, in m: how deep the approaches of the proofs go.
DEPTH = 1.0e-3


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured.

    Args:
        mesh: edge length in m.
        duration: of the motions with friction that are compared, in s.
        peak: time in s within which the first peak of the tip comes.
        penalties: parts of the default penalty per area.
        points: along the overlap and across half a wall.
        pads: lengths and widths in m.
    """

    mesh: float = 0.1
    duration: float = 10.0
    peak: float = 0.9
    penalties: Sequence[float] = (0.1, 1.0, 10.0, 100.0)
    points: Sequence[tuple[int, int]] = ((4, 4), (8, 2), (8, 4), (8, 6), (12, 4))
    pads: Sequence[tuple[float, float]] = ((0.1, 0.03), (0.1, 0.06), (0.2, 0.06))


@dataclass(frozen=True, slots=True)
class Contact:
    """A way to touch, and what it does.

    Args:
        name: of it.
        case: what touches so.
        system: its shell, with friction.
        peaks: first tip peak in m without and with friction.
    """

    name: str
    case: Case
    system: GapSystem
    peaks: tuple[float, float]


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """Surface against stations, its penalty, its quadrature, and pads of several sizes."""
    sizes = sizes or Sizes()
    case = friction_case()
    shell = _shell(case, sizes)

    def touching(name: str, case: Case, update: Mapping[str, object]) -> Contact:
        tell(f"contact {name}")
        system = gap_system(case, build_boom(case), shell.model_copy(update=update))
        return Contact(name, case, system, _first_peaks(system, sizes))

    lines = touching("near webs", case, {})
    across = touching("across", case, {"contact_line": "across"})
    padded = [
        touching(f"pads of {length:g} m x {width:g} m", with_pads(case, length, width), {})
        for length, width in sizes.pads
    ]
    surfaces = {
        points: touching(
            f"surface, {points[0]} x {points[1]} points",
            case,
            {"contact_line": "surface", "surface_points": points},
        )
        for points in sizes.points
    }
    default = surfaces.get((8, 4)) or next(iter(surfaces.values()))
    tell("motions with friction")
    tips = {
        contact.name: np.asarray(_move(contact.system, sizes.duration).data["tip"].values)
        for contact in (lines, default)
    }
    tell("penalties")
    softer = [
        (part, _first_peaks(_scaled(default.system, part), sizes)) for part in sizes.penalties
    ]
    density = _density(case, sizes, default.system)
    stations = [lines, across, *padded]
    tables = [
        _contact_table([*stations, default], tips, sizes),
        _penalty_table(softer, density),
        _points_table(surfaces),
        flexibility_table([(one.name, one.case, one.system) for one in stations]),
    ]
    time = (OUTPUT_STEP * np.arange(len(tips[lines.name]))).tolist()
    return Study(
        name="surface-contact",
        title="Contact over the whole overlap",
        tables=tables,
        proofs=[
            *_proofs(case, default.system),
            *pad_proofs(case, sizes.pads[0], padded[0].system),
        ],
        plots=[
            Plot(
                "surface-contact",
                "Contact over the whole overlap is softer than from web to web",
                "time (s)",
                "tip (mm)",
                {name: (time, (1.0e3 * tip).tolist()) for name, tip in tips.items()},
                "The tip of the paper's boom with friction, touching at its stations near the webs "
                "and over the whole overlap.",
                logarithmic=False,
            )
        ],
        data={
            "first_peaks": {
                contact.name: list(contact.peaks) for contact in [*stations, *surfaces.values()]
            },
            "penalties": {f"{part:g}": list(peaks) for part, peaks in softer},
            "tip_difference": _apart(tips, default.name),
        },
    )


def rigid_motion(system: GapSystem, tail: float, tip: float) -> Array:
    """(num_modes,) the state in which the free inner segment's ends are so high, in m."""
    free = np.flatnonzero(system.omega2 == 0.0)
    rows = np.array([system.observers[name].row[free] for name in ("tail", "tip")])
    state = np.zeros(system.num_modes)
    state[free] = np.linalg.lstsq(rows, np.array([tail, tip]), rcond=None)[0]
    return state


def _shell(case: Case, sizes: Sizes) -> ShellTable:
    shell = shell_of(case)
    return shell.model_copy(update={"mesh_size": sizes.mesh, "contact_tolerance": "any"})


def _move(system: GapSystem, duration: float) -> Trajectory:
    return integrate(
        Motion(system, duration, OUTPUT_STEP), contact_step(system, OUTPUT_STEP, phase=PHASE)
    )


def _first_peaks(system: GapSystem, sizes: Sizes) -> tuple[float, float]:
    smooth = replace(system, friction_rows=np.zeros((0, system.num_modes)), frictions=())
    found = [_move(one, sizes.peak).first_peak()[1] for one in (smooth, system)]
    return found[0], found[1]


def _scaled(system: GapSystem, part: float) -> GapSystem:
    return replace(system, laws=[law.shared(part) for law in system.laws])


def _apart(tips: Mapping[str, Array], reference: str) -> float:
    """Largest difference of the two tips over the run, as a part of the reference's range."""
    one, other = tips.values()
    return float(np.abs(one - other).max() / np.ptp(tips[reference]))


def _upper_stiffness(system: GapSystem) -> float:
    """Of all rows together where the inner segment presses up, in N/mⁿ."""
    return sum(term.stiffness for law in system.laws for term in law.terms if term.side > 0.0)


def _density(case: Case, sizes: Sizes, system: GapSystem) -> float:
    """The default penalty per area in N/mⁿ⁺²."""
    boom = build_boom(case)
    (joint,) = boom.joints
    section = boom.segments[joint.inner].section
    assert section is not None
    start, end = boom.overlap(joint)
    return _upper_stiffness(system) / (section.size("y") * (end - start))


def _contact_table(
    contacts: Sequence[Contact], tips: Mapping[str, Array], sizes: Sizes
) -> TextTable:
    reference = contacts[0]
    rows = []
    for contact in contacts:
        off = [100.0 * (a / b - 1.0) for a, b in zip(contact.peaks, reference.peaks, strict=True)]
        rows.append(
            (
                contact.name,
                f"{contact.system.num_modes}",
                f"{len(contact.system.laws)}",
                fixed(contact.peaks[0], 1, 1.0e3),
                fixed(off[0], 1),
                fixed(contact.peaks[1], 1, 1.0e3),
                fixed(off[1], 1),
            )
        )
    apart = 100.0 * _apart(tips, contacts[-1].name)
    return TextTable(
        "Where the segments touch",
        (
            "contact",
            "modes",
            "rows",
            "first tip peak\nwithout friction (mm)",
            "off near webs (%)",
            "with friction (mm)",
            "off near webs (%)",
        ),
        rows,
        (
            f"With friction, over {sizes.duration:g} s, the tip of the surface is up to "
            f"{fixed(apart, 1)} % of its range from that of near webs.",
            "A surface has no pads: the corners of the inner box press on the outer flange beside "
            "its web, and the flange gives way there.",
            "Pads at the ends of the overlap have their middles half their length inside, which "
            "shortens the arm of the couple that holds the inner segment, and lets it tilt more "
            "within the play.",
        ),
        name="surface",
    )


def _penalty_table(peaks: Sequence[tuple[float, tuple[float, float]]], density: float) -> TextTable:
    stiffest = peaks[-1][1]
    rows = [
        (
            f"{part:g}",
            number(part * density),
            *(fixed(peak, 1, 1.0e3) for peak in found),
            fixed(100.0 * (found[1] / stiffest[1] - 1.0), 2),
        )
        for part, found in peaks
    ]
    return TextTable(
        "Penalty per area",
        (
            "part of the default",
            "k_A (N/m³)",
            "first tip peak\nwithout friction (mm)",
            "with friction (mm)",
            "off the stiffest (%)",
        ),
        rows,
        ("The default presses as both stations do when the segments approach each other alike.",),
        name="surface-penalty",
    )


def _points_table(surfaces: Mapping[tuple[int, int], Contact]) -> TextTable:
    finest = surfaces[max(surfaces, key=lambda points: (points[1], points[0]))]
    rows = [
        (
            f"{along} x {across}",
            f"{len(contact.system.laws)}",
            f"{contact.system.num_modes}",
            *(fixed(peak, 1, 1.0e3) for peak in contact.peaks),
            fixed(100.0 * (contact.peaks[1] / finest.peaks[1] - 1.0), 2),
        )
        for (along, across), contact in surfaces.items()
    ]
    return TextTable(
        "Contact points of a surface",
        (
            "along x half across",
            "rows",
            "modes",
            "first tip peak\nwithout friction (mm)",
            "with friction (mm)",
            "off most across (%)",
        ),
        rows,
        name="surface-points",
    )


def _proofs(case: Case, system: GapSystem) -> list[Proof]:
    """Forces of approaches whose pressure can be integrated by hand."""
    (joint,) = build_boom(case).joints
    start, end = build_boom(case).overlap(joint)
    law = system.laws[0]
    whole = _upper_stiffness(system)
    upper, _ = contact_laws(case, model_of(case, "shell"))[0].terms
    n, k = upper.exponent, upper.stiffness * len(joint.stations)

    def forces(tail: float, slope: float) -> Array:
        """Of the inner segment this high at its tail, beyond the play, and rising so."""
        high = law.clearance + tail
        state = rigid_motion(system, high, high + slope * (build_boom(case).tip - start))
        gaps = system.rows @ state
        return np.array([float(w.force(y)) for w, y in zip(system.laws, gaps, strict=True)])

    places = system.rows @ rigid_motion(system, start, build_boom(case).tip)
    uniform = forces(DEPTH, 0.0)
    tilted = forces(0.0, DEPTH / (end - start))
    approach = f"{1e3 * DEPTH:g} mm beyond the play"
    return [
        Proof(
            f"contact force over the overlap, uniform approach {approach}",
            float(uniform.sum()),
            k * DEPTH**n,
            "N",
            "analytic",
            "(4) at all stations",
            1.0e-6,
        ),
        Proof(
            "its place along the boom",
            float(uniform @ places / uniform.sum()),
            0.5 * (start + end),
            "m",
            "analytic",
            "middle of the overlap",
            1.0e-6,
        ),
        Proof(
            f"contact force over the overlap, approach rising to {approach}",
            float(tilted.sum()),
            k * DEPTH**n / (n + 1.0),
            "N",
            "analytic",
            "integral of the pressure",
            1.0e-6,
        ),
        Proof(
            "contact rows of a surface without weight",
            float(sum(w.terms[0].stiffness <= 1.0e-9 * whole for w in system.laws)),
            0.0,
            "",
            "analytic",
            "Gauss's weights are positive",
            0.0,
        ),
    ]

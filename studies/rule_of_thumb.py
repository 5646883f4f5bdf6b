# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rule of thumb for the error of a beam relative to the shell, and the scatter of this error.

The beam lacks a fraction δ of the tip's static deflection: the deflections by shear and by the
local compliance of walls. A mass that falls through the play onto a spring models the effect on the
motion. γ is the ratio of the tip's free travel to its static deflection, and s = √(2γ). The first
peak then has the relative error δ/√(1 + s²). After n slow periods, the error of the tip as a
fraction of its range is

    δ (1/√(1 + s²) + n μ ψ)
    ψ = ½ (χ + s/(1 + s²)) / (s + χ),   μ = 2 (s + χ) √(1 + s²) / (s²/2 + 1 + √(1 + s²))

with χ = π − arctan s. ψ is the relative error of the period divided by δ. μ is the period times the
largest speed of the tip, divided by its range. The study measures the accuracy of the rule on booms
with proportions other than the paper's, and with the paper's friction.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from protractile.beam_model.wall_compliance import contact_compliance
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.box import BoxSection
from protractile.geometry.section import EACH_SIDE
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.case.sections import SectionTable
from protractile.runs.pipeline.model_run import static_tip
from protractile.runs.report.tables import Cell, Table
from studies.calibrated_beams import (
    EULER,
    PLAIN,
    SHELL,
    SPRUNG,
    calibrated_beam,
    move_all,
    peak_errors,
    tip_errors,
)
from studies.motions import build_all, friction_case, model_of, shell_of, with_pads
from studies.study import Criterion, Piece, Progress, Verification, define_study
from studies.working_load import Point

_DENSITY = 7850.0


@dataclass(frozen=True, slots=True)
class Proportions:
    """Proportions of a boom of two boxes, the paper's by default."""

    length: float = 10.0  #: length of each segment in m
    overlap: float = 1.0  #: length of the overlap in m
    aspect: float = 1.634  #: height over width of the outer box
    walls: float = 1.0  #: ratio of the wall thicknesses to the paper's
    #: Length and width in m of pads beside the webs; without pads, contact is near the webs.
    pad: tuple[float, float] | None = None


# The paper's boxes, mid-lines and walls in m, and the room of the inner one in them.
HEIGHT, OUTER_WALL, INNER_WALL = 0.4945, 6.64e-3, 4.87e-3
_ROOM, BESIDE = 0.0141, 0.17

# Length and width in m of the pads of booms with pads.
PAD = (0.1, 0.06)

BOOMS: Mapping[str, Proportions] = {
    "the paper's": Proportions(),
    "half as long": Proportions(length=5.0, overlap=0.7),
    "a third as long": Proportions(length=3.5, overlap=0.5),
    "longer": Proportions(length=13.0),
    "long overlap": Proportions(overlap=3.0),
    "short overlap": Proportions(overlap=0.6),
    "thin walls": Proportions(walls=0.6),
    "thick walls": Proportions(walls=2.0),
    "narrow": Proportions(aspect=2.5),
    "wide": Proportions(aspect=1.0),
    "pads": Proportions(pad=PAD),
    "pads, thick walls": Proportions(walls=2.0, pad=PAD),
}


def boom_case(given: Proportions) -> Case:
    """Return the paper's case with friction and given proportions, under its weight at 1 m/s²."""
    case = friction_case()
    walls = given.walls * OUTER_WALL, given.walls * INNER_WALL
    width = HEIGHT / given.aspect
    heights = HEIGHT, HEIGHT - sum(walls) - _ROOM
    boxes = [
        SectionTable.model_validate({"height": height, "width": wide, "flange": wall, "web": wall})
        for height, wide, wall in zip(heights, (width, (1.0 - BESIDE) * width), walls, strict=True)
    ]
    head = given.length
    spans = (0.0, head), (head - given.overlap, 2.0 * head - given.overlap)
    segments = []
    for table, box, span in zip(case.segments, boxes, spans, strict=True):
        supports = tuple(
            replace(support, x=0.2 * head if number else 0.0)
            for number, support in enumerate(table.supports)
        )
        # The box determines its own properties.
        of_box = "height_to_width", "mass_per_length", "second_moment_of_area", "rotary_inertia"
        own = {"section": box, "span": span, "supports": supports}
        own["load"] = _DENSITY * box.section().area
        segments.append(table.model_copy(update=dict.fromkeys(of_box) | own))
    # Friction has the same ratio to the weight as the paper's.
    lighter = sum(table.load for table in segments) / sum(table.load for table in case.segments)
    forces = tuple(
        0.1 * head * lighter * force for joint in case.joints for force in joint.normal_forces
    )
    joint = replace(case.joints[0], stations=(head - given.overlap, head), normal_forces=forces)
    found = case.model_copy(update={"segments": tuple(segments), "joints": (joint,)})
    return found if given.pad is None else with_pads(found, *given.pad)


# Compliance of a wall near its web, in 1/(E t): c₀ + c₁ ln(b/l), with the width b of the box and
# the loaded length l.
NEAR_WEBS = 0.20, 0.70
# Relative error of the bending frequency f of beams with springs over (f/flange frequency)².
FLANGES = 0.065
# Relative excess of the shear deflection over a Timoshenko beam: webs have non-uniform shear.
UNEVEN = 0.09
# Relative difference of frequencies up to which a mode of the shell corresponds to one of the beam.
_NEAR = 0.15
# Permitted deviation of the mean ratio of errors to the rule from 1; error of beams with springs.
MEAN_OFF, PEAK = 0.25, 0.005
# Permitted relative error of the compliance of walls under pads.
WALLS = 0.08
# The motion of the tip is unpredictable if the rule gives a larger error.
UNPREDICTABLE = 0.5


class Sizes(NamedTuple):
    """Parameters of the study."""

    booms: Mapping[str, Proportions] = BOOMS  #: booms by name
    mesh_size: float = 0.2  #: mesh size of the shells in m
    contact_tolerance: float = 0.04  #: contact tolerance of these shells
    wall_tolerance: float = 0.01  #: contact tolerance for the compliance of walls under pads
    plays: Sequence[float] = (0.0, 4.0e-3, 14.0e-3)  #: plays 2Δ in m
    #: Loads over the weight at 1 m/s²; under smaller loads friction stops the boom early.
    loads: Sequence[float] = (10.0,)
    periods: float = 8.0  #: duration of the motions in periods of the boom without play


class Rule(NamedTuple):
    """Data of a boom for the rule, without a shell."""

    #: Parts in m of the tip's static deflection under the weight at 1 m/s²: by bending, by shear,
    #: and by the compliance of walls.
    bending: float
    shear: float
    pressed: float
    frequency: float  #: first frequency without play in Hz
    lever: float  #: free travel of the tip over half the play

    @classmethod
    def of(cls, given: Proportions, case: Case) -> Rule:
        """Return the rule for a boom, from beams without play and their static deflections."""
        boom = build_boom(case)
        bonded = [
            model_of(case, name).system_without_play(boom)
            for name in ("beam-fe-rotary", "timoshenko")
        ]
        tips = [static_tip(system) for system, _ in filter(None, bonded)]
        inner = boom.segments[1]
        # Positions of the contact forces at tail and head, from the start of the inner segment.
        tail = 0.0 if given.pad is None else 0.5 * given.pad[0]
        head = given.overlap - tail
        arm, weight = head - tail, inner.load * inner.length

        def normal_rows(x: float) -> Array:
            """Return the contact forces (2,) in N at tail and head under a unit force at x in m."""
            return np.array([x - head, x - tail]) / arm

        pressed = weight * normal_rows(0.5 * inner.length) * normal_rows(inner.length)
        assert bonded[1] is not None
        return cls(
            bending=tips[0],
            shear=tips[1] - tips[0],
            pressed=float(station_compliances(given, case) @ pressed),
            frequency=float(bonded[1][0].frequencies[0]),
            lever=2.0 * (inner.length - tail) / arm - 1.0,
        )

    @property
    def deflection(self) -> float:
        """Static deflection of the tip in m."""
        return self.bending + (1.0 + UNEVEN) * self.shear + self.pressed

    def missing_part(self, name: str) -> float:
        """Return the fraction δ of the static deflection that a kind of beam lacks."""
        known = self.bending + (0.0 if name == EULER else self.shear)
        return 1.0 - known / self.deflection

    def swing(self, point: Point) -> float:
        """Return s = √(2γ)."""
        return float(np.sqrt(self.lever * point.play / (point.load * self.deflection)))

    def peak_error(self, name: str, point: Point) -> float:
        """Return the relative error of the first peak."""
        return self.missing_part(name) / float(np.hypot(1.0, self.swing(point)))

    def tip_error(self, name: str, point: Point, duration: float) -> float:
        """Return the error of the tip within a duration in s, as a fraction of its range."""
        s = self.swing(point)
        root, chi = float(np.hypot(1.0, s)), np.pi - float(np.arctan(s))
        periods = duration * np.pi * self.frequency / (s + chi)
        psi = 0.5 * (chi + s / root**2) / (s + chi)
        mu = 2.0 * (s + chi) * root / (0.5 * s**2 + 1.0 + root)
        return min(1.0, self.missing_part(name) * (1.0 / root + periods * mu * psi))


def station_compliances(given: Proportions, case: Case) -> Array:
    """Return the compliance (2,) in m/N of the walls of both segments at tail and head."""
    if given.pad is not None:
        return np.diag(contact_compliance(build_boom(case)))[:: len(EACH_SIDE)]
    material = case.material
    assert material is not None
    width = HEIGHT / given.aspect
    # A corner is pressed over a tenth of the overlap.
    spread = NEAR_WEBS[0] + NEAR_WEBS[1] * np.log(width / (0.1 * given.overlap))
    walls = 1.0 / (given.walls * OUTER_WALL) + 1.0 / (given.walls * INNER_WALL)
    return np.full(2, spread / material.youngs_modulus * walls)


class BoomErrors(NamedTuple):
    """Errors of the beams of a boom relative to its shell, at all points."""

    rule: Rule  #: rule for the boom
    points: Sequence[Point]  #: plays and loads
    duration: float  #: duration of the motions in s
    #: (num_points,) errors by the name of the beam.
    peaks: Mapping[str, Array]
    tips: Mapping[str, Array]
    #: First frequency of the free inner segment in Hz, by the name of the model.
    bending: Mapping[str, float]


def flange_frequency(case: Case) -> float:
    """Return the frequency in Hz of a strip of the inner segment's flange between the webs."""
    inner = build_boom(case).segments[1]
    box, material = inner.section, inner.material
    assert isinstance(box, BoxSection)
    plate = material.youngs_modulus * box.flange**2 / (12.0 * (1.0 - material.poissons_ratio**2))
    return float(0.5 * np.pi * np.sqrt(plate / material.density) / box.width**2)


def inner_bending(shell: GapSystem, beam: GapSystem) -> dict[str, float]:
    """Return the lowest bending frequency in Hz of the free inner segment, by beam and by shell."""
    own, shown = _moving_tip(beam), _moving_tip(shell)
    bending = min(own)
    near = {f: moves for f, moves in shown.items() if abs(f / bending - 1.0) < _NEAR}
    return {SPRUNG: bending, SHELL: max(near, key=near.__getitem__)}


def _moving_tip(system: GapSystem) -> dict[float, float]:
    """Return the tip amplitudes of the modes in which the tip moves much, by frequency in Hz."""
    frequencies, moves = system.omega / (2.0 * np.pi), np.abs(system.observers["tip"].row)
    much = (frequencies > 0.0) & (moves > 0.1 * moves.max())
    return dict(zip(frequencies[much].tolist(), moves[much].tolist(), strict=True))


def measure(given: Proportions, sizes: Sizes) -> BoomErrors:
    """Return the errors of the beams of a boom, from motions of beams and shell."""
    case = boom_case(given)
    rule = Rule.of(given, case)
    fine = {"mesh_size": sizes.mesh_size, "contact_tolerance": sizes.contact_tolerance}
    shell = shell_of(case).model_copy(update=fine)
    models = {
        SHELL: shell,
        EULER: model_of(case, "beam-fe-rotary"),
        PLAIN: model_of(case, "timoshenko"),
        SPRUNG: calibrated_beam(case, shell, fields=False),
    }
    points = Point.each(sizes.plays, sizes.loads)
    duration = sizes.periods / rule.frequency
    systems = {name: one.system for name, one in build_all(case, models).items()}
    beams = move_all(systems, points, duration)
    of_shell = beams.pop(SHELL)
    return BoomErrors(
        rule,
        points,
        duration,
        {name: peak_errors(moved, of_shell) for name, moved in beams.items()},
        {name: tip_errors(moved, of_shell) for name, moved in beams.items()},
        inner_bending(systems[SHELL], systems[SPRUNG]),
    )


def wall_compliances(given: Proportions, sizes: Sizes) -> tuple[Array, Array]:
    """Return compliances (2,) of walls in m/N at tail and head, by plate theory and by the shell.

    The load is a pair of forces that presses the walls of both segments apart.
    """
    case = boom_case(replace(given, pad=given.pad or PAD))
    walls = contact_compliance(build_boom(case))
    above, below = slice(0, None, 2), slice(1, None, 2)
    apart = walls[above, above] + walls[below, below] - walls[above, below] - walls[below, above]
    fine = {"mesh_size": sizes.mesh_size, "contact_tolerance": sizes.wall_tolerance}
    shell = build_all(case, {SHELL: shell_of(case).model_copy(update=fine)})[SHELL].shell
    assert shell is not None
    return 0.5 * np.diag(apart), np.asarray(shell.local_compliance)[above]


def ratios(found: Sequence[BoomErrors], name: str, tips: bool) -> Array:
    """Return the ratios (num_ratios,) of a beam's errors to those of the rule, for all points."""
    pairs = [
        (
            off,
            one.rule.tip_error(name, point, one.duration)
            if tips
            else one.rule.peak_error(name, point),
        )
        for one in found
        for point, off in zip(one.points, (one.tips if tips else one.peaks)[name], strict=True)
    ]
    return np.array(
        [off / rule for off, rule in pairs if np.isfinite(off) and rule < UNPREDICTABLE]
    )


def boom_table(found: Mapping[str, BoomErrors], sizes: Sizes) -> Table:
    """Return the table of δ for each beam, by the rule and by the shell without play."""
    rows: list[Sequence[Cell]] = []
    for name, one in found.items():
        rule, given = one.rule, sizes.booms[name]
        parts = [part / rule.deflection for part in (rule.shear, rule.pressed)]
        parts += [rule.missing_part(beam) for beam in (EULER, PLAIN)]
        parts += [one.peaks[beam][0] for beam in (EULER, PLAIN, SPRUNG)]
        sizes_of = given.length / HEIGHT, given.overlap / HEIGHT
        rows.append((name, *sizes_of, *(100.0 * part for part in parts)))
    columns = {
        "boom": "", "length /\nheight": ".1f", "overlap /\nheight": ".2f", "shear\n(%)": ".2f",
        "local\ncompliance (%)": ".2f", f"rule,\n{EULER} (%)": ".2f", f"rule,\n{PLAIN} (%)": ".2f",
        f"{EULER}\n(%)": ".2f", f"{PLAIN}\n(%)": ".2f", f"{SPRUNG}\n(%)": ".3f",
    }  # fmt: skip
    return Table.of_rows(
        "rule-of-thumb-booms",
        "Missing parts of the tip's static deflection, and errors of first peaks",
        columns,
        rows,
        (f"Without play, under {sizes.loads[0]:g} times the weight at 1 m/s² at once.",),
    )


def scatter_table(found: Sequence[BoomErrors], sizes: Sizes) -> Table:
    """Return a table of the scatter of measured errors about the rule, over all points."""
    rows: list[Sequence[Cell]] = []
    for tips, what in ((False, "first peak"), (True, "tip")):
        for name in (EULER, PLAIN):
            ratio = ratios(found, name, tips)
            # By one standard deviation of the logarithms.
            mean, scatter = np.exp([np.log(ratio).mean(), np.log(ratio).std()]).tolist()
            rows.append((what, name, ratio.size, mean, scatter, ratio.min(), ratio.max()))
    columns = {
        "error of": "", "beam": "", "points": ".0f", "geometric\nmean": ".2f",
        "scatter,\na factor": ".2f", "least": ".2f", "most": ".2f",
    }  # fmt: skip
    return Table.of_rows(
        "rule-of-thumb-scatter",
        "Measured errors over those of the rule",
        columns,
        rows,
        (
            f"{len(found)} booms, plays of {', '.join(f'{1e3 * play:g}' for play in sizes.plays)} "
            f"mm, loads of {', '.join(f'{load:g}' for load in sizes.loads)} times the weight at "
            f"1 m/s², {sizes.periods:g} periods of the boom without play; where the rule tells "
            f"more than {100.0 * UNPREDICTABLE:g} % the tip is lost, and it is left out.",
        ),
    )


def springs_table(found: Mapping[str, BoomErrors], sizes: Sizes) -> Table:
    """Return the table of the largest errors of beams with springs, and the flanges' share."""
    rows: list[Sequence[Cell]] = []
    for name, one in found.items():
        bending, flange = one.bending[SHELL], flange_frequency(boom_case(sizes.booms[name]))
        parts = (
            float(np.nanmax(one.peaks[SPRUNG])),
            one.tips[SPRUNG].max(),
            one.bending[SPRUNG] / bending - 1.0,
            FLANGES * (bending / flange) ** 2,
        )
        peak, tip, too_high, of_flanges = (100.0 * part for part in parts)
        rows.append((name, peak, tip, bending, too_high, of_flanges))
    columns = {
        "boom": "", "first peak,\nworst (%)": ".3f", "tip,\nworst (%)": ".2f",
        "free bending of the\ninner segment (Hz)": ".1f", "error of the\nbeam (%)": ".2f",
        "0.065 (ω/ω_fl)²\n(%)": ".2f",
    }  # fmt: skip
    return Table.of_rows(
        "rule-of-thumb-springs",
        "A beam with the stiffness and springs of the shell",
        columns,
        rows,
        ("Flanges: 0.065 times the square of the frequency over that of a strip on the webs.",),
    )


def wall_table(found: Mapping[str, tuple[Array, Array]], sizes: Sizes) -> Table:
    """Return the table of the compliance of walls under pads, by plate theory and by the shell."""
    rows: list[Sequence[Cell]] = []
    for name, (plates, shell) in found.items():
        stations = zip(1.0e9 * plates, 1.0e9 * shell, 100.0 * (plates / shell - 1.0), strict=True)
        rows.append((name, *(float(one) for station in stations for one in station)))
    columns = {"boom": ""}
    for station in ("tail", "head"):
        columns |= {f"{station}, plates\n(1e-9 m/N)": ".1f", f"{station}, shell\n(1e-9 m/N)": ".1f"}
        columns |= {f"{station}\n(%)": ".1f"}
    return Table.of_rows(
        "rule-of-thumb-walls",
        "Compliance of walls under pads",
        columns,
        rows,
        (
            f"Pads of {PAD[0]:g} x {PAD[1]:g} m in all booms; shells of {sizes.mesh_size:g} m with "
            f"a contact tolerance of {sizes.wall_tolerance:g}.",
        ),
    )


def verifications(found: Sequence[BoomErrors]) -> Iterator[Verification]:
    """Return the verifications of the rule against the shells, and of springs."""
    booms = f"{len(found)} booms"
    for name in (EULER, PLAIN):
        what = f"{name}: first tip peak's error over that of the rule of thumb, geometric mean of "
        mean = float(np.exp(np.log(ratios(found, name, tips=False)).mean()))
        yield Verification(what + booms, mean, 1.0, "", "other code", "shells", MEAN_OFF)
    worst = max(float(np.nanmax(one.peaks[SPRUNG])) for one in found)
    criterion: Criterion = ("other code", "the shell that calibrates it", PEAK)
    yield Verification(
        f"beam {SPRUNG}: first tip peak, worst of {booms}", worst, 0.0, "", *criterion
    )


@define_study("rule-of-thumb", "A rule of thumb for beams")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Study booms of other proportions than the paper's, with its friction."""
    sizes = sizes or Sizes()
    found = {}
    for name, given in sizes.booms.items():
        progress(name)
        found[name] = measure(given, sizes)
    walls = {}
    for name, given in sizes.booms.items():
        progress(f"{name}, walls under pads")
        walls[name] = wall_compliances(given, sizes)
    every = list(found.values())
    yield boom_table(found, sizes)
    yield scatter_table(every, sizes)
    yield springs_table(found, sizes)
    yield wall_table(walls, sizes)
    yield from verifications(every)
    worst = max(float(np.abs(plates / shell - 1.0).max()) for plates, shell in walls.values())
    what = f"compliance of walls under pads, worst of {2 * len(walls)} stations"
    yield Verification(what, worst, 0.0, "", "other code", "shells", WALLS)

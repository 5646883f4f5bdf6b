# SPDX-License-Identifier: LGPL-3.0-or-later
"""One reading of the paper's data: its case, and its findings on the statements."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from typing import Literal

import numpy as np

from beam_model.kantorovich import Base
from dynamics.failure import NumericsError
from dynamics.predictability.ensemble import perturbations
from runs.case.kinds.kantorovich import Kantorovich
from runs.case.kinds.model import of_kind
from runs.case.schema import Case
from runs.folder.cache import Memory
from runs.paper.rules import CLEAR_INFLUENCE, DIVERGENCE, PEAK_SCATTER, judge
from runs.paper.verdicts import Judgement
from runs.pipeline.means import Means
from runs.pipeline.results import Results
from runs.pipeline.run import run_case

Stiffness = Literal["restored", "literal"]

SERIES = ("kantorovich-4", "kantorovich-5")
WITH_PLAY = (*SERIES, "beam-fe")
MODELS = (*WITH_PLAY, "beam-fe-tied")

# Judged by the rules of every run; the others here, since they need several runs.
COMMON = ("S1", "S5", "S6")
JUDGED = ("S1", "S2", "S3", "S4", "S5", "S6", "S9")

# "1010 kN/m" with the exponent lost in print, in N/m², and literally, in N/mⁿ.
RESTORED = 1.0e13
LITERAL = 1.01e6
# About the mean force of a loaded pad in N, at which the laws of all exponents are equally stiff.
PAD_FORCE = 2.5e4

# The soft literal contacts would let the integrator take steps that resonate with the highest modes
# of the beam elements; in s.
LITERAL_STEP = 1.0e-5

# Runs of a reading with slightly changed loads, since chaos makes a single run a sample.
MEMBERS = 5
CHANGE = 1.0e-4

# Time in s from which the models of the paper diverge.
STRATIFIED_FROM = 6.0


@dataclass(frozen=True, slots=True)
class Reading:
    """One reading of the data.

    Args:
        clearance: Δ in m.
        stiffness: of the contact, with the lost exponent restored or literal.
        base: of the series.
        exponent: n of all models with play.
    """

    clearance: float
    stiffness: Stiffness
    base: Base
    exponent: float

    def __str__(self) -> str:
        return f"{1e3 * self.clearance:g}, {self.stiffness}, {self.base}, {self.exponent:g}"

    @property
    def contact_stiffness(self) -> float:
        """Contact stiffness k in N/mⁿ.

        Its unit depends on n, so the restored one of another n than the paper's 2 has the tangent
        n k^(1/n) F^(1−1/n) of the quadratic law at the pads' force F.
        """
        if self.stiffness == "literal":
            return LITERAL
        n = self.exponent
        tangent = 2.0 * np.sqrt(RESTORED * PAD_FORCE)
        return float((tangent / (n * PAD_FORCE ** (1.0 - 1.0 / n))) ** n)

    def case(self, paper: Case, change: float = 0.0) -> Case:
        """Return the paper's case in this reading, with the beam models alone.

        Args:
            paper: case of the file.
            change: relative, of all loads.
        """
        law = {
            "play": 2.0 * self.clearance,
            "stiffness": self.contact_stiffness,
            "exponent": self.exponent,
        }
        joints = tuple(joint.model_copy(update=law) for joint in paper.joints)
        models = tuple(
            model.model_copy(
                update={"contact": None}
                | ({"base": self.base} if of_kind(Kantorovich, [model]) else {})
            )
            for model in paper.models
            if model.name in MODELS
        )
        # No box of uniform walls leaves a play of 28 mm, and beams do not need the plates.
        segments = tuple(
            segment.model_copy(
                update={"height_to_width": None, "load": (1.0 + change) * segment.load}
            )
            for segment in paper.segments
        )
        time = paper.time
        if self.stiffness == "literal":
            time = time.model_copy(update={"step": LITERAL_STEP})
        return paper.model_copy(
            update={
                "time": time,
                "statements": COMMON,
                "demand": (),
                "ensemble": None,
                "segments": segments,
                "joints": joints,
                "models": models,
            }
        )


@dataclass(frozen=True, slots=True)
class ReadingFinding:
    """Finding on a statement in a reading: the verdict with its numbers."""

    verdict: Judgement
    measured: Sequence[float]


@dataclass(frozen=True, slots=True)
class Judged:
    """A reading with its findings.

    Args:
        reading: that was judged.
        findings: by the statement's id.
        peaks: first tip peak of each model in m.
        energy_residual: the largest of all runs.
    """

    reading: Reading
    findings: Mapping[str, ReadingFinding]
    peaks: Mapping[str, float]
    energy_residual: float

    def excluded_by(self) -> list[str]:
        """Return the statements that the reading contradicts."""
        return [key for key, finding in self.findings.items() if finding.verdict == "contradicted"]


def by_base(readings: Sequence[Reading]) -> list[list[Reading]]:
    """Return groups of readings that differ only in the base of the series."""
    groups: dict[Reading, list[Reading]] = {}
    for reading in readings:
        groups.setdefault(replace(reading, base="complete"), []).append(reading)
    return [*groups.values()]


def judge_bases(readings: Sequence[Reading], paper: Case, members: int) -> list[Judged]:
    """Judge one of these groups, whose readings all have the same beam elements."""
    motions = Memory()
    return [_judge(reading, paper, members, motions) for reading in readings]


def _judge(reading: Reading, paper: Case, members: int, motions: Memory) -> Judged:
    """Run a reading and judge all statements but S9, which needs several readings.

    Motions of other readings are reused, and its own are added to them.
    """
    changes = perturbations(members, CHANGE, 0)
    runs = [_results(reading.case(paper, change), motions) for change in changes]
    first = runs[0]
    findings = {
        verdict.id: ReadingFinding(
            verdict.verdict, () if verdict.measured is None else (verdict.measured,)
        )
        for verdict in judge(first)
    }
    peaks = {name: _first_peak(first, name) for name in MODELS}
    findings |= {
        "S2": _all_above([_apart(run, SERIES, run.case.time.duration - 1.0) for run in runs]),
        "S3": _all_above([_apart(run, WITH_PLAY, STRATIFIED_FROM) for run in runs]),
        "S4": _grows([peaks[name] for name in WITH_PLAY]),
    }
    residuals = [run.summary.models[name].energy_residual for run in runs for name in MODELS]
    return Judged(reading, findings, peaks, max(residuals))


def judge_exponents(judged: Sequence[Judged]) -> list[Judged]:
    """Add S9 to readings that differ in their exponent alone, which share the verdict.

    Its number is the part by which a model's larger first tip peak exceeds the smaller one.
    """
    groups: dict[Reading, list[Judged]] = {}
    for entry in judged:
        groups.setdefault(_but_exponent(entry.reading), []).append(entry)
    shared = {}
    for key, group in groups.items():
        heights = [[entry.peaks[name] for entry in group] for name in WITH_PLAY]
        measured = max(max(peaks) / min(peaks) - 1.0 for peaks in heights)
        verdict: Judgement = "reproduced" if measured < CLEAR_INFLUENCE else "contradicted"
        if len(group) < 2 or abs(measured - CLEAR_INFLUENCE) <= PEAK_SCATTER:
            verdict = "undecided"
        shared[key] = ReadingFinding(verdict, (measured,) if len(group) > 1 else ())
    return [
        replace(entry, findings={**entry.findings, "S9": shared[_but_exponent(entry.reading)]})
        for entry in judged
    ]


def _but_exponent(reading: Reading) -> Reading:
    """Return the common part of readings that differ only in their exponent."""
    return replace(reading, exponent=0.0)


def _results(case: Case, motions: Memory) -> Results:
    finished = run_case(case, "paper.toml", Means(kept=motions))
    assert finished is not None
    for model, why in finished.results.summary.failures.items():
        raise NumericsError(f"{model}: {why}")
    return finished.results


def _first_peak(run: Results, model: str) -> float:
    """Return the first peak of the tip in m."""
    height = run.summary.models[model].first_peak["tip"].height
    if height is None:
        raise NumericsError(f"{model}: no first peak")
    return height


def _apart(run: Results, models: Sequence[str], since: float) -> float:
    """Return the largest difference of two tips from a time in s on, as a part of the range."""
    late = run.trajectories["time"].values >= since
    tips = [run.trajectories["tip"].sel(model=name).values for name in models]
    largest = max(float(np.abs(a - b)[late].max()) for a, b in combinations(tips, 2))
    return largest / max(float(np.ptp(tip)) for tip in tips)


def _all_above(values: Sequence[float]) -> ReadingFinding:
    above = [value > DIVERGENCE for value in values]
    if all(above):
        return ReadingFinding("reproduced", values)
    return ReadingFinding("undecided" if any(above) else "contradicted", values)


def _grows(peaks: Sequence[float]) -> ReadingFinding:
    """Return the finding on S4 without the shell: the smallest rise between successive models.

    A rise below the scatter of first peaks is chance.
    """
    smallest = min(after / before - 1.0 for before, after in pairwise(peaks))
    if abs(smallest) <= PEAK_SCATTER:
        return ReadingFinding("undecided", (smallest,))
    return ReadingFinding("reproduced" if smallest > 0.0 else "contradicted", (smallest,))

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Study of interpretations of the paper's data, which statements of the paper may exclude.

The paper does not say whether the play of 14 mm is 2Δ or Δ, whether the contact stiffness has lost
its exponent in print, which functions the series has at its ends, and which contact law a figure
has. The study runs every combination with the beam models, and judges it by the statements. The
authors cannot have used a combination that contradicts a statement.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from itertools import combinations, groupby, pairwise, product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Literal, NamedTuple

import numpy as np

from protractile.beam_model.kantorovich import Base
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.predictability import perturbations
from protractile.geometry.typography import number
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.kinds.kantorovich import Kantorovich
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.schema import Case
from protractile.runs.folder.cache import Cache
from protractile.runs.paper.rules import CLEAR_INFLUENCE, DIVERGENCE, PEAK_SCATTER, judge
from protractile.runs.paper.verdicts import MARKS, Judgement
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import run_case
from protractile.runs.report.tables import Table
from studies.study import Progress, define_study

PAPER = CASES / "paper.toml"
SERIES = ("kantorovich-4", "kantorovich-5")
WITH_PLAY = (*SERIES, "beam-fe")
MODELS = (*WITH_PLAY, "beam-fe-bonded")

# A single run suffices to judge the first three statements; the others need several runs.
COMMON = ("S1", "S5", "S6")
JUDGED = ("S1", "S2", "S3", "S4", "S5", "S6", "S9")

Stiffness = Literal["restored", "literal"]
# "1010 kN/m" with the exponent lost in print, in N/m², and literally, in N/mⁿ.
RESTORED, LITERAL = 1.0e13, 1.01e6
# Approximate mean force of a loaded pad in N, at which the laws of all exponents have the same
# stiffness.
PAD_FORCE = 2.5e4
# Step in s for the soft literal contacts, whose adaptive steps would resonate with the highest
# modes of beam elements.
LITERAL_STEP = 1.0e-5

# Runs of an interpretation with slightly changed loads, since chaos makes a single run a sample.
MEMBERS, CHANGE = 5, 1.0e-4
# Time in s from which the models of the paper diverge.
STRATIFIED_FROM = 6.0


@dataclass(frozen=True, slots=True)
class Interpretation:
    """One interpretation of the data."""

    play: float  #: 2Δ in m
    stiffness: Stiffness  #: contact stiffness, with the lost exponent restored or literal
    base: Base  #: base of the series
    exponent: float  #: n of all models with play

    def __str__(self) -> str:
        return f"{1e3 * self.play:g}, {self.stiffness}, {self.base}, {self.exponent:g}"

    @property
    def contact_stiffness(self) -> float:
        """Contact stiffness k in N/mⁿ.

        For n other than the paper's 2, k follows from the tangent stiffness n k^(1/n) F^(1−1/n),
        which equals that of the quadratic law at the force F of the pads.
        """
        if self.stiffness == "literal":
            return LITERAL
        n = self.exponent
        tangent = 2.0 * np.sqrt(RESTORED * PAD_FORCE)
        return float((tangent / (n * PAD_FORCE ** (1.0 - 1.0 / n))) ** n)

    def case(self, paper: Case, change: float = 0.0) -> Case:
        """Return the paper's case in this interpretation, with the beam models only.

        ``change`` is the relative change of all loads.
        """
        law: dict[str, Any] = {
            "play": self.play,
            "stiffness": self.contact_stiffness,
            "exponent": self.exponent,
        }
        models = tuple(
            model.model_copy(
                update={"contact": None}
                | ({"base": self.base} if select_kind(Kantorovich, [model]) else {})
            )
            for model in paper.models
            if model.name in MODELS
        )
        # No box with uniform walls leaves a play of 28 mm, and beams do not need plates.
        segments = tuple(
            segment.model_copy(
                update={"height_to_width": None, "load": (1.0 + change) * segment.load}
            )
            for segment in paper.segments
        )
        step = {"step": LITERAL_STEP} if self.stiffness == "literal" else {}
        return paper.model_copy(
            update={
                "time": paper.time.model_copy(update=step),
                "statements": COMMON,
                "demand": (),
                "ensemble": None,
                "segments": segments,
                "joints": tuple(replace(joint, **law) for joint in paper.joints),
                "models": models,
            }
        )


STIFFNESSES: tuple[Stiffness, ...] = ("restored", "literal")
BASES: tuple[Base, ...] = ("as printed", "pinned", "complete")
ALL = tuple(
    Interpretation(play, stiffness, base, exponent)
    for play, stiffness, exponent, base in product(
        (0.014, 0.028), STIFFNESSES, (1.0, 1.5, 2.0), BASES
    )
)


class Finding(NamedTuple):
    """Verdict on a statement in an interpretation, with the measured numbers."""

    verdict: Judgement
    measured: Sequence[float]


@dataclass(frozen=True, slots=True)
class JudgedInterpretation:
    """An interpretation with its findings."""

    interpretation: Interpretation
    findings: Mapping[str, Finding]  #: findings by the statement's id
    peaks: Mapping[str, float]  #: first tip peak of each model in m
    energy_residual: float  #: the largest of all runs

    @property
    def excluded_by(self) -> list[str]:
        """The statements that the interpretation contradicts."""
        return [key for key, finding in self.findings.items() if finding.verdict == "contradicted"]


@define_study("interpretations", "Interpretations of the paper's data")
def study(progress: Progress) -> Iterator[Table]:
    """Run and judge all interpretations."""
    progress(f"{len(ALL)} interpretations, {MEMBERS} runs each")
    yield finding_table(survey(ALL))


def survey(
    interpretations: Sequence[Interpretation], members: int = MEMBERS
) -> list[JudgedInterpretation]:
    """Return interpretations with their findings; two groups of runs are computed in parallel.

    Neighbours that differ only in the base of the series share the motions of beam elements.
    """
    paper = case_file.load(str(PAPER))

    def judge_group(group: Sequence[Interpretation]) -> list[JudgedInterpretation]:
        with TemporaryDirectory() as folder:
            motions = Cache(Path(folder))
            return [_judge(one, paper, members, motions) for one in group]

    groups = groupby(interpretations, lambda one: replace(one, base="complete"))
    with ThreadPoolExecutor(2) as pool:
        found = pool.map(judge_group, [[*group] for _, group in groups])
        return judge_exponents([one for group in found for one in group])


def _judge(
    interpretation: Interpretation, paper: Case, members: int, motions: Cache
) -> JudgedInterpretation:
    """Return an interpretation with findings on all statements but S9.

    S9 compares several interpretations. ``motions`` caches the motions that interpretations share.
    """
    changes = perturbations(members, CHANGE, 0)
    runs = [_results(interpretation.case(paper, change), motions) for change in changes]
    findings = {
        verdict.id: Finding(
            verdict.verdict, () if verdict.measured is None else (verdict.measured,)
        )
        for verdict in judge(runs[0])
    }
    peaks = {name: _first_peak(runs[0], name) for name in MODELS}
    late = runs[0].case.time.duration - 1.0
    findings |= {
        "S2": _all_above([_largest_difference(run, SERIES, late) for run in runs]),
        "S3": _all_above([_largest_difference(run, WITH_PLAY, STRATIFIED_FROM) for run in runs]),
        "S4": _judge_growth([peaks[name] for name in WITH_PLAY]),
    }
    residuals = [run.summary.models[name].energy_residual for run in runs for name in MODELS]
    return JudgedInterpretation(interpretation, findings, peaks, max(residuals))


def judge_exponents(judged: Sequence[JudgedInterpretation]) -> list[JudgedInterpretation]:
    """Add the common verdict on S9 to interpretations that differ only in the exponent.

    Its number is the relative difference between a model's larger and smaller first tip peak.
    """
    groups: dict[Interpretation, list[JudgedInterpretation]] = {}
    for entry in judged:
        groups.setdefault(replace(entry.interpretation, exponent=0.0), []).append(entry)
    shared = {}
    for key, group in groups.items():
        heights = [[entry.peaks[name] for entry in group] for name in WITH_PLAY]
        measured = max(max(peaks) / min(peaks) - 1.0 for peaks in heights)
        verdict: Judgement = "reproduced" if measured < CLEAR_INFLUENCE else "contradicted"
        if len(group) < 2 or abs(measured - CLEAR_INFLUENCE) <= PEAK_SCATTER:
            verdict = "undecided"
        shared[key] = Finding(verdict, (measured,) if len(group) > 1 else ())
    return [
        replace(
            one, findings={**one.findings, "S9": shared[replace(one.interpretation, exponent=0.0)]}
        )
        for one in judged
    ]


def _results(case: Case, motions: Cache) -> Results:
    finished = run_case(case, "paper.toml", RunContext(motions=motions))
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


def _largest_difference(run: Results, models: Sequence[str], since: float) -> float:
    """Return the largest difference of two tips after a time in s, as a fraction of the range."""
    late = run.trajectories["time"].values >= since
    tips = [run.trajectories["tip"].sel(model=name).values for name in models]
    largest = max(float(np.abs(a - b)[late].max()) for a, b in combinations(tips, 2))
    return largest / max(float(np.ptp(tip)) for tip in tips)


def _all_above(values: Sequence[float]) -> Finding:
    above = [value > DIVERGENCE for value in values]
    if all(above):
        return Finding("reproduced", values)
    return Finding("undecided" if any(above) else "contradicted", values)


def _judge_growth(peaks: Sequence[float]) -> Finding:
    """Return the finding on S4 without the shell: the smallest rise between successive models.

    A rise below the scatter of first peaks is chance.
    """
    smallest = min(after / before - 1.0 for before, after in pairwise(peaks))
    if abs(smallest) <= PEAK_SCATTER:
        return Finding("undecided", (smallest,))
    return Finding("reproduced" if smallest > 0.0 else "contradicted", (smallest,))


def conclude(judged: Sequence[JudgedInterpretation]) -> list[str]:
    """Return sentences on the interpretations that the statements exclude."""
    excluded = [entry for entry in judged if entry.excluded_by]
    sentences = [f"{len(excluded)} of {len(judged)} interpretations are excluded."]
    aspects: Mapping[str, Callable[[Interpretation], str]] = {
        "play": lambda one: f"{1e3 * one.play:g} mm",
        "stiffness": lambda one: one.stiffness,
        "base": lambda one: one.base,
        "exponent": lambda one: f"{one.exponent:g}",
    }
    for aspect, value in aspects.items():
        values = list(dict.fromkeys(value(entry.interpretation) for entry in judged))
        for one in values if len(values) > 1 else ():
            with_it = [entry for entry in judged if value(entry.interpretation) == one]
            by = [key for entry in with_it for key in entry.excluded_by]
            counts = ", ".join(f"{key} {by.count(key)} times" for key in JUDGED if key in by)
            several = sum(bool(entry.excluded_by) for entry in with_it)
            how = "all" if several == len(with_it) else f"{several} of {len(with_it)}"
            sentences.append(
                f"{aspect} {one}: {how if several else 'none'} excluded"
                + (f", by {counts}." if counts else ".")
            )
    return sentences


def finding_table(judged: Sequence[JudgedInterpretation]) -> Table:
    """Return the table of interpretations: verdict on each statement, with the numbers."""

    def cell(finding: Finding) -> str:
        ends = (min(finding.measured), max(finding.measured)) if finding.measured else ()
        numbers = "…".join(dict.fromkeys(number(end, 2) for end in ends))
        return f"{MARKS[finding.verdict]} {numbers}".strip()

    return Table.of_rows(
        "interpretations",
        "Interpretations of the data, and the statements on them",
        ("play mm, stiffness, base, n", "k\nN/mⁿ", *JUDGED, "excluded\nby", "first tip peaks\nmm",
         "energy residual"),
        [
            (
                str(entry.interpretation),
                number(entry.interpretation.contact_stiffness),
                *(cell(entry.findings[key]) for key in JUDGED),
                " ".join(entry.excluded_by) or "–",
                ", ".join(f"{1e3 * entry.peaks[name]:.0f}" for name in MODELS),
                number(entry.energy_residual, 1),
            )
            for entry in judged
        ],
        (
            "✓ reproduced, ✗ contradicted, ? undecided. S1, S2, S3: parts of the range, S2 and S3 "
            f"from the smallest to the largest of runs with loads changed by up to {CHANGE:g}, "
            "decided where all agree; S3 says here that the models with play are more than "
            f"{100.0 * DIVERGENCE:g} % apart at some time from {STRATIFIED_FROM:g} s on. S4: the "
            "smallest rise of the first tip peak from model to model, without the shell. S5, S6: "
            "ratios. S9: relative difference between the first tip peaks of two exponents.",
            f"Peaks of {', '.join(MODELS)}.",
            f"The restored stiffness of n = 1 and 3/2 has the tangent of the quadratic law at "
            f"{PAD_FORCE / 1e3:g} kN; the literal one is {number(LITERAL)} for every n.",
            *conclude(judged),
        ),
    )  # fmt: skip

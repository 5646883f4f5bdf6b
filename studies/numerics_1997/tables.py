# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of the study of statements that accurate solutions contradict, by methods of 1997."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import product

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.typography import NONE, TO_PERCENT, number
from protractile.runs.paper.rules import DIVERGENCE, INTERVAL, MOST, SERIES_STEPS
from protractile.runs.report.tables import Cell, Table
from studies.numerics_1997.samples import MEMBERS, MODES, PAPER_STEP, SERIES, ModelRun, Numerics
from studies.numerics_1997.schemes import NEWMARK, WILSON
from studies.numerics_1997.survey import (
    ABOUT,
    METHODS,
    TOLERANCES,
    Survey,
    diverges_near_7_s,
    share,
)
from studies.study import Piece, Plot, Progress, define_study

TITLE = "The statements of the paper by numerics of 1997"
POINTS = 1000  # of a curve in a figure


@define_study("numerics-1997", TITLE)
def study(progress: Progress) -> Iterator[Piece]:
    """Study both examples with all schemes, steps, numbers of modes, and types of iteration."""
    survey = Survey.of(progress)
    yield from tables(survey)
    yield from plots(survey)


def tables(survey: Survey) -> list[Table]:
    """Return all tables of a survey."""
    made = outcome_table, free_table, frictional_table, reach_table
    return [table(survey) for table in made]


def outcome_table(survey: Survey) -> Table:
    """Return a table with a row for each statement."""
    rows = [
        (key, "yes" if found.shown else "no", found.why) for key, found in survey.outcomes.items()
    ]
    return Table.of_rows(
        "numerics-1997-statements",
        "Statements of the paper that numerics of 1997 reproduce",
        {"statement": "", "shown": "", "by": ""},
        rows,
        (
            f"Shown: by some numerics in {TO_PERCENT * MOST:g} % of the runs or more. Runs have "
            f"{', '.join(map(str, MODES))} modes of the elements, {MEMBERS} each with loads "
            "changed by 1e-9.",
        ),
    )


def free_table(survey: Survey) -> Table:
    """Return the table of motions without friction: a row for each method, and an accurate one."""
    example = survey.without
    peak = np.mean([one.elements.first_peak for one in example.accurate])
    rows: list[Sequence[Cell]] = []
    for how, samples in (("solved accurately", example.accurate), *survey.free.items()):
        off = TO_PERCENT * (np.array([one.elements.first_peak for one in samples]) / peak - 1.0)
        alike, mixed = (
            [one.peaks(example.cutoff) for one in found]
            for found in (samples, example.with_accurate_series(samples))
        )
        energies = _energies([one.elements for one in samples])
        rows.append((str(how), *energies, _span(off), *_parting(alike), *_parting(mixed)))
    headings = ("peaks apart to 6 s\n(%, median)", "and later", "as S3 says\n(% of runs)")
    columns = {
        "numerics": "", "elements gain more\nthan was put in at (s)": "",
        "energy at the end\n(% of that put in)": "", "first peak of the\nelements off (%)": "",
        **dict.fromkeys(headings, ".0f"),
        **dict.fromkeys((f"{one},\nseries solved accurately" for one in headings), ".0f"),
    }  # fmt: skip
    return Table.of_rows(
        "numerics-1997-free", "Without friction: the tip by numerics of 1997", columns, rows
    )


def frictional_table(survey: Survey) -> Table:
    """Return the table of motions with friction, with the rows of :func:`free_table`."""
    rows: list[Sequence[Cell]] = []
    example = survey.with_friction
    for how, samples in (("solved accurately", example.accurate), *survey.frictional.items()):
        apart = TO_PERCENT * np.array([one.tip_distances() for one in samples])
        rows.append(
            (
                str(how),
                *_energies([one.elements for one in samples]),
                _span([TO_PERCENT * one.elements.unconverged for one in samples]),
                _span([TO_PERCENT * example.tip_error(one.elements) for one in samples]),
                _span(apart[:, 0]),
                _span(apart[:, 1]),
                TO_PERCENT * share(one.stratifies() for one in samples),
                TO_PERCENT
                * share(one.stratifies() for one in example.with_accurate_series(samples)),
                TO_PERCENT * share(map(diverges_near_7_s, samples)),
            )
        )
    columns = {
        "numerics": "", "elements gain more\nthan was put in at (s)": "",
        "energy at the end\n(% of that put in)": "", "steps without\nagreement (%)": "",
        "elements off to 6 s\n(% of range)": "", "models apart to 6 s\n(% of range)": "",
        "and later": "", "as S7 says\n(% of runs)": ".0f",
        "with the series\nsolved accurately": ".0f",
        f"lost at {INTERVAL - ABOUT:g} to {INTERVAL + ABOUT:g} s\n(% of runs)": ".0f",
    }  # fmt: skip
    return Table.of_rows(
        "numerics-1997-friction", "With friction: the tip by numerics of 1997", columns, rows
    )


def reach_table(survey: Survey) -> Table:
    """Return the table of the times that the general solver reaches."""
    rows: list[Sequence[Cell]] = []
    for method, tolerance in product(METHODS, TOLERANCES):
        ways = [(method, tolerance, *way[::-1]) for way in product((False, True), SERIES)]
        rows.append((method, number(tolerance), *(survey.reached[way] for way in ways)))
    columns = {
        "solver": "", "tolerance": "", "four terms": ".3g", "five terms": ".3g",
        "four terms, friction": ".3g", "five terms, friction": ".3g",
    }  # fmt: skip
    return Table.of_rows(
        "numerics-1997-series",
        f"How far {SERIES_STEPS} steps of a general solver reach (s)",
        columns,
        rows,
    )


def plots(survey: Survey) -> Iterator[Plot]:
    """Yield plots of the tip by both iterated schemes at the paper's step."""
    for name, what, example, samples in (
        ("numerics-1997-free", "Without friction", survey.without, survey.free),
        ("numerics-1997-friction", "With friction", survey.with_friction, survey.frictional),
    ):
        by = {
            f"{scheme.name}, iterated": max(
                (one.elements for one in samples[Numerics(scheme, True, PAPER_STEP)]),
                key=lambda run: run.divergence_time,
            )
            for scheme in (NEWMARK, WILSON)
        }
        runs = {**by, "solved accurately": example.accurate[0].elements}
        yield Plot(
            name,
            f"{what}: the beam elements' tip, solved accurately and by numerics of 1997",
            *("time (s)", "tip (mm)"),
            {label: _curve(run.time, 1e3 * run.tip) for label, run in runs.items()},
            f"{1e3 * PAPER_STEP:g} ms; of {MEMBERS * len(MODES)} runs the one that lasts longest.",
            logarithmic=False,
        )


def _energies(runs: Sequence[ModelRun]) -> tuple[str, str]:
    """Return texts on the energy of runs: the time of divergence, and the gain or loss."""
    breaks = [run.divergence_time for run in runs]
    ends = [TO_PERCENT * run.balance[-1] for run in runs]
    return _span(breaks), _span([end for end in ends if end < TO_PERCENT])


def _parting(peaks: Sequence[tuple[float, float]]) -> tuple[float, float, float]:
    """Return median distances of peaks before and after six seconds, and the share of S3, in %."""
    early, late = np.median(peaks, axis=0)
    shown = share(before <= DIVERGENCE < after for before, after in peaks)
    return TO_PERCENT * float(early), TO_PERCENT * float(late), TO_PERCENT * shown


def _span(values: Sequence[float] | Array) -> str:
    """Return the range of the finite values as text with two digits."""
    finite = [float(value) for value in values if np.isfinite(value)]
    if not finite:
        return NONE
    ends = dict.fromkeys(number(end, 2) for end in (min(finite), max(finite)))
    many = "" if len(finite) == len(values) else f" ({len(finite)} of {len(values)})"
    return " … ".join(ends) + many


def _curve(time: Array, values: Array) -> tuple[list[float], list[float]]:
    """Return a curve with as many points as a figure can show."""
    shown = slice(None, None, max(1, time.size // POINTS))
    return time[shown].tolist(), values[shown].tolist()

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distances of the verdicts on the paper from their thresholds, and other samples of the motions.

The round-off of another processor gives another sample of a chaotic motion, as a relative change of
E by 1e-12 does. All samples must give the same verdicts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from protractile.cases import run_case
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.paper.decision import DECISIVE
from protractile.runs.paper.rules import judge
from protractile.runs.paper.verdicts import Verdict
from protractile.runs.report.tables import Cell, Table
from studies.study import Progress, define_study

# The shipped cases with verdicts.
JUDGED = ("paper", "paper-friction", "three-segments")
# Relative changes of E.
CHANGES = (0.0, 1.0e-12, 2.0e-12, 3.0e-12)


@define_study("verdicts", "Verdicts on the paper")
def study(progress: Progress) -> Iterator[Table]:
    """Judge the shipped cases, and compare samples of their motions."""
    rows: list[list[Cell]] = []
    for case in JUDGED:
        progress(f"{case}, {len(CHANGES)} samples")
        judged = [verdicts_on(case, change) for change in CHANGES]
        rows += [_row(case, samples) for samples in zip(*judged, strict=True)]
    yield Table.of_rows(
        "verdicts",
        "Distances of verdicts from their thresholds",
        {
            "case": "", "statement": "", "verdict": "", "measured": ".4g", "threshold": ".4g",
            "unit": "", "standard errors\nfrom the threshold": ".1f",
            "least\nof all samples": ".1f", "standard deviation\nof measured": ".2g",
        },
        rows,
        (
            f"Samples: E changed by {', '.join(f'{one:g}' for one in CHANGES)}. "
            f"{DECISIVE:g} standard errors decide a verdict; numbers without them do not depend on "
            "the sample.",
        ),
    )  # fmt: skip


def verdicts_on(case: str, change: float) -> list[Verdict]:
    """Return the verdicts on a shipped case with a relative change of E."""
    chosen = case_file.load(str(CASES / f"{case}.toml"))
    assert chosen.material is not None
    modulus = (1.0 + change) * chosen.material.youngs_modulus
    material = replace(chosen.material, youngs_modulus=modulus)
    return judge(run_case(chosen.model_copy(update={"material": material})))


def _row(case: str, samples: Sequence[Verdict]) -> list[Cell]:
    first = samples[0]
    distances = [one.distance for one in samples if one.distance is not None]
    measured = [one.measured for one in samples if one.measured is not None]
    return [
        case,
        first.id,
        " or ".join(dict.fromkeys(one.verdict for one in samples)),
        first.measured,
        first.threshold,
        first.unit,
        first.distance,
        min(distances, default=None),
        float(np.std(measured, ddof=1)) if len(measured) > 1 else None,
    ]

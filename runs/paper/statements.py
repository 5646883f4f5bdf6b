# SPDX-License-Identifier: LGPL-3.0-or-later
"""Statements of the paper."""

from __future__ import annotations

from typing import Literal

StatementId = Literal["S1", "S2", "S3", "S4", "S5", "S6", "S7", "S8", "S9", "S10", "S11"]
STATEMENTS: dict[StatementId, str] = {
    "S1": "Four and five terms of the series coincide until the first collision.",
    "S2": "At the end of the interval they are more than 20 % apart.",
    "S3": "At the tip all models with play conform for six seconds, then stratify.",
    "S4": "The deflection grows with the complication of the model: four terms, five terms, "
    "beam elements, shell.",
    "S5": "Play changes the motion fundamentally.",
    "S6": "At the head relative differences are greater than at the tip, absolute ones of the "
    "same level.",
    "S7": "With friction the models conform for six seconds, then stratify somewhat; the "
    "play-free one deviates considerably.",
    "S8": "With friction the finite element solution is stable for 7 s only, at 4375 steps.",
    "S9": "The collision model has no clear influence on the deflection.",
    "S10": "The series needs at most 2000 integration steps, beam elements more than 4000.",
    "S11": "The description extends to more than two segments, with two more equations per segment "
    "and plane.",
}
# Titles of the statements in the table of the terminal.
TITLES: dict[str, str] = {
    "S1": "4 and 5 terms agree until contact",
    "S2": "4 and 5 terms end 20 % apart",
    "S3": "models agree for 6 s, then differ",
    "S4": "deflection grows with the model",
    "S5": "play changes the motion",
    "S6": "head: greater relative differences",
    "S7": "friction: models agree for 6 s",
    "S8": "friction: elements stable for 7 s",
    "S9": "contact law has little influence",
    "S10": "series 2000 steps, elements 4000",
    "S11": "more than two segments",
}

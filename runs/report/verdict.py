# SPDX-License-Identifier: LGPL-3.0-or-later
"""A judgement on a statement that a run is held against."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Judgement = Literal["reproduced", "contradicted", "undecided"]


@dataclass(frozen=True, slots=True)
class Verdict:
    """One statement, judged.

    Args:
        id: by which the case knows it.
        statement: what is claimed.
        measured: the number that the rule looks at, None where there is none.
        threshold: what it is held against.
        unit: of both; empty where there is none.
        verdict: what the rule says.
        why: what was compared, and what the number can and cannot decide.
        demanded: the case takes no other verdict than ``reproduced``.
        then: what numerics of the statement's own time show; empty where none were tried.
    """

    id: str
    statement: str
    measured: float | None
    threshold: float | None
    unit: str
    verdict: Judgement
    why: str
    demanded: bool = False
    then: str = ""

    @property
    def broken(self) -> bool:
        """Whether the case demands another one."""
        return self.demanded and self.verdict != "reproduced"

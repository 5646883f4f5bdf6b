# SPDX-License-Identifier: LGPL-3.0-or-later
"""What numerics of the paper's own time show of its statements, beside the verdicts on a run.

``python -m studies.as_computed_then`` finds it; a run's folder may hold a copy.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from runs.case import toml
from runs.case.messages import BadInput, first_fault
from runs.case.schema import Case
from runs.case.user_files import read_text
from runs.report.verdict import Verdict

FILE = "then.json"
MODULE = "studies.as_computed_then"


class Outcome(BaseModel):
    """Whether some numerics of then show a statement, and which."""

    model_config = ConfigDict(extra="forbid")

    shown: bool
    why: str

    def __str__(self) -> str:
        return f"{'shown' if self.shown else 'not shown'}: {self.why}"


class Outcomes(BaseModel):
    """The file: of which cases it is, and what it says by statement."""

    model_config = ConfigDict(extra="forbid")

    case_hashes: list[str]
    outcomes: Mapping[str, Outcome]


def beside(verdicts: Sequence[Verdict], folder: Path, case: Case) -> list[Verdict]:
    """The verdicts with what the file in a run's folder says; as they are where none is.

    Raises:
        BadInput: the file is damaged, or of another case.
    """
    try:
        found = Outcomes.model_validate(json.loads(read_text(folder / FILE)))
    except FileNotFoundError:
        return list(verdicts)
    except ValidationError as error:
        what = f"{first_fault(error)}; is damaged or another version's"
    except (OSError, ValueError) as error:
        what = f"cannot be understood ({error})"
    else:
        if toml.digest(case) in found.case_hashes:
            says = {key: str(outcome) for key, outcome in found.outcomes.items()}
            return [replace(one, then=says.get(one.id, "")) for one in verdicts]
        what = "is not of the case in case.toml"
    raise BadInput(str(folder), FILE, f"{what}; remove it, or run python -m {MODULE} again")

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of a case that request verdicts on statements of the paper."""

from __future__ import annotations

from typing import Annotated

from protractile.geometry.fields import Few
from protractile.runs.case.limits import CaseTable
from protractile.runs.paper.statements import StatementId


class Keys(CaseTable):
    """Keys of a case for the statements of the paper."""

    statements: Annotated[tuple[StatementId, ...], Few] = ()
    """the statements of the paper that are judged on the run"""
    demand: Annotated[tuple[StatementId, ...], Few] = ()
    """the statements of the paper that the run must reproduce"""

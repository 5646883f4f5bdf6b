# SPDX-License-Identifier: LGPL-3.0-or-later
"""Whether the shells of a boom buckle under its axial forces."""

from __future__ import annotations

from collections.abc import Sequence

from dynamics.failure import NumericsError
from geometry.boom import Boom
from shell_model.boom_shell import BoomShell
from shell_model.contact.rows import ties
from shell_model.reduction.coordinates import BoomCoordinates
from shell_model.reduction.segment import ReducedSegment


def critical_factor(boom: Boom, full: BoomShell, reduced: Sequence[ReducedSegment]) -> float | None:
    """Of the axial forces on the boom without play; infinite without any. Collective.

    Raises:
        NumericsError: it is 1 or less, and the boom buckles.
    """
    if not boom.compressed:
        return float("inf")
    held = ties(boom.play_free, full.shells)
    factor = BoomCoordinates(full.comm, full.shells, reduced, held, full.lines).critical_factor
    if factor is not None and factor <= 1.0:
        raise NumericsError(
            f"the shell of the boom buckles under {factor:.3g} times its axial forces; make these "
            "smaller, or the sections larger"
        )
    return factor

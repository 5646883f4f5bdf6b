# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of models with rigid segments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from beam_model.component import SegmentModel
from beam_model.rigid import freedom, rigid_segment
from geometry.boom import Boom, BoomError
from runs.case.kinds.model import BeamTable, Joined, StandIn


class Rigid(BeamTable):
    """Rigid bodies, which move only in play, contacts and elastic supports."""

    if TYPE_CHECKING:

        def __init__(self, boom: Boom | None = None, /, **keys: Any) -> None: ...

    kind: Literal["rigid"]
    """the kind of model"""

    def check(self, where: str, joined: Joined) -> None:
        if not any(freedom(segment) for segment in joined.boom.segments):
            raise BoomError(
                f"{where}.kind",
                "every segment is held, and no rigid one could move; give another kind, or elastic "
                "supports",
            )
        super().check(where, joined)

    def describe(self) -> str:
        return "rigid segments"

    def segments(self, boom: Boom) -> list[SegmentModel]:
        return [rigid_segment(segment) for segment in boom.segments]

    def stand_in(self, boom: Boom) -> StandIn:
        return StandIn(self, (5 if boom.spatial else 2) * len(boom.segments))

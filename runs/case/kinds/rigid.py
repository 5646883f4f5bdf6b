# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of models with rigid segments."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal

from beam_model.component import SegmentModel
from beam_model.kantorovich import count_rigid_motions, rigid_segment
from geometry.boom import Boom, BoomError
from runs.case.kinds.model import BeamTable, ModelBoom, Surrogate


class Rigid(BeamTable):
    """Rigid segments, which move only by play and by the compliance of contacts and supports."""

    if TYPE_CHECKING:

        def __init__(self, boom: Boom | None = None, /, **keys: Any) -> None: ...

    kind: Literal["rigid"]
    """the kind of model"""

    def check(self, where: str, model_boom: ModelBoom) -> None:
        if not any(count_rigid_motions(segment) for segment in model_boom.boom.segments):
            raise BoomError(
                f"{where}.kind",
                "every segment is held, and no rigid one could move; give another kind, or elastic "
                "supports",
            )
        super().check(where, model_boom)

    def describe(self) -> str:
        return "rigid segments"

    def segments(self, boom: Boom) -> list[SegmentModel]:
        return [rigid_segment(segment) for segment in boom.segments]

    def surrogate(self, boom: Boom) -> Surrogate:
        return Surrogate(self, (5 if boom.spatial else 2) * len(boom.segments))

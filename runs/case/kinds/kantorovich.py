# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of the Kantorovich series, and of models with rigid segments."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from protractile.beam_model.component import SegmentModel
from protractile.beam_model.kantorovich import (
    check_base,
    count_rigid_motions,
    kantorovich_segments,
    rigid_segment,
)
from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.fields import Few, Flag
from protractile.runs.case.kinds.calibration import CalibratedTable
from protractile.runs.case.kinds.model import BeamTable, ModelBoom, Surrogate
from protractile.runs.case.limits import Count

# Maximum number of terms: with more, round-off changes the lowest frequencies by more than 1e-6.
MOST_TERMS = 60


class Kantorovich(CalibratedTable, init=False):
    """The semi-discrete Ritz series of the paper."""

    smooth: ClassVar[bool] = True

    kind: Literal["kantorovich"]
    """the kind of model"""
    terms: Annotated[tuple[Count, ...], Few]
    """the number of functions of each segment, from the base to the tip"""
    base: Literal["as printed", "pinned", "complete"] = "as printed"
    """the interpretation of the functions: as printed, with zero slope at the base; pinned, with a
    free slope; complete, where the inner segment bends freely too"""
    rotary_inertia: Flag = False
    """whether the rotary inertia is kept"""

    def check(self, where: str, model_boom: ModelBoom) -> None:
        segments = model_boom.boom.segments
        if len(self.terms) != len(segments):
            raise BoomError(
                f"{where}.terms",
                f"must have one number for each of the {len(segments)} segments, got "
                f"{list(self.terms)}",
            )
        if max(self.terms) > MOST_TERMS:
            raise BoomError(
                f"{where}.terms",
                f"must not be above {MOST_TERMS}, where the polynomials lose their digits, got "
                f"{list(self.terms)}; use finite elements",
            )
        try:
            check_base(model_boom.boom, self.base)
        except BoomError as error:
            raise BoomError(f"{where}.base", error.what) from None
        super().check(where, model_boom)

    def describe(self) -> str:
        return f"series of {' + '.join(map(str, self.terms))} functions ({self.base} set)"

    def segments(self, boom: Boom) -> list[SegmentModel]:
        rotary_inertia = self.rotary_inertia or self.calibrated_by is not None
        return kantorovich_segments(boom, self.terms, self.base, rotary_inertia)

    def beam_surrogate(self, boom: Boom) -> Surrogate:
        return Surrogate(self, sum(self.terms) * (3 if boom.spatial else 1))


class Rigid(BeamTable, init=False):
    """Rigid segments, which move only by play and by the compliance of contacts and supports."""

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

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beam finite elements as a kind of model."""

from __future__ import annotations

from typing import Literal

import numpy as np
from pydantic import Field

from beam_model.component import SegmentModel
from beam_model.finite_element import finite_element_segments
from geometry.boom import Boom, BoomError
from runs.case.kinds.model import BeamTable, Joined, StandIn
from runs.case.limits import Flag, Length

# A dense eigenproblem of more elements is a slip of the pen.
MOST_ELEMENTS = 5_000

# Of a dense eigenproblem of n coordinates: s for each n³, numbers for each n². Measured.
_EIGEN_TIME, _EIGEN_ROOM = 5.0e-9, 6.0
# A beam of more coordinates is estimated by a coarser one.
_BUILT = 400


class FiniteElementTable(BeamTable):
    """Beam finite elements."""

    kind: Literal["finite-element"] = Field(description="the kind of model")
    element_length: Length = Field(0.5, description="the length of an element in m, at most")
    theory: Literal["euler-bernoulli", "timoshenko"] = Field(
        "euler-bernoulli", description="the beam theory"
    )
    rotary_inertia: Flag = Field(True, description="whether the rotary inertia is kept")
    tied: Flag = Field(
        False, description="whether the segments deflect alike at the stations, without play"
    )

    @property
    def needs_plates(self) -> bool:
        return self.theory == "timoshenko"

    @property
    def play_free(self) -> bool:
        return self.tied

    def check(self, where: str, joined: Joined) -> None:
        if self.tied and self.contact:
            raise BoomError(f"{where}.contact", "a tied model has no contact; leave it out")
        length = max(segment.length for segment in joined.boom.segments)
        if length / self.element_length > MOST_ELEMENTS:
            raise BoomError(
                f"{where}.element_length",
                f"{self.element_length:g} m makes more than {MOST_ELEMENTS} elements of a "
                f"segment; it must be at least {length / MOST_ELEMENTS:.3g} m",
            )
        super().check(where, joined)

    def describe(self) -> str:
        return f"{self.theory}, elements of {self.element_length:g} m"

    def segments(self, boom: Boom) -> list[SegmentModel]:
        return finite_element_segments(boom, self.element_length, self.theory, self.rotary_inertia)

    def stand_in(self, boom: Boom) -> StandIn:
        nodes = sum(
            np.ceil(segment.length / self.element_length) + 1 + len(boom.stations_of(number))
            for number, segment in enumerate(boom.segments)
        )
        coordinates = int((5 if boom.spatial else 2) * nodes)
        coarser = max(1.0, coordinates / _BUILT)
        # The highest frequency of bending goes with the inverse square of the length.
        return StandIn(
            self.model_copy(update={"element_length": coarser * self.element_length}),
            coordinates,
            shorter=coarser**2,
            memory=8.0 * _EIGEN_ROOM * coordinates**2,
            seconds=_EIGEN_TIME * coordinates**3,
        )

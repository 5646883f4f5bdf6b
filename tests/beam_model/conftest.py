# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plain beams, and the paper's boom as each kind of model."""

from collections.abc import Callable, Sequence
from typing import Any

import pytest

from beam_model.component import SegmentModel
from beam_model.finite_element import Theory, finite_element_segment
from beam_model.kantorovich import Base, kantorovich_segments
from geometry.boom import Boom, Material, Segment, Support
from geometry.section import BoxSection

BOX = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01)


@pytest.fixture(scope="session")
def beam(steel: Material) -> Callable[..., Segment]:
    """Return a factory of beams of BOX on [3, 8] m; numbers in ``supports`` are pinned supports."""

    def make(*, supports: Sequence[float | Support] = (), **changes: Any) -> Segment:
        numbers: dict[str, Any] = {
            "name": "beam", "start": 3.0, "end": 8.0, "material": steel,
            "mass_per_length": BOX.mass_per_length(steel.density),
            "second_moment_of_area": BOX.second_moment_of_area,
            "rotary_inertia": steel.density * BOX.second_moment_of_area, "section": BOX,
            "supports": tuple(x if isinstance(x, Support) else Support(x) for x in supports),
        }  # fmt: skip
        return Segment(**numbers | changes)

    return make


@pytest.fixture(scope="session")
def series(paper_boom: Boom) -> Callable[..., list[SegmentModel]]:
    """Kantorovich models of the paper's segments."""

    def make(terms: tuple[int, int], base: Base = "as printed") -> list[SegmentModel]:
        return kantorovich_segments(paper_boom, terms, base, False)

    return make


@pytest.fixture(scope="session")
def elements(paper_boom: Boom) -> Callable[..., list[SegmentModel]]:
    """Finite element models of the paper's segments."""

    def make(length: float, theory: Theory = "euler-bernoulli") -> list[SegmentModel]:
        return [
            finite_element_segment(segment, length, (9.0, 10.0), theory, rotary_inertia=False)
            for segment in paper_boom.segments
        ]

    return make

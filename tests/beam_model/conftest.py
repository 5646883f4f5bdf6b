# SPDX-License-Identifier: LGPL-3.0-or-later
"""The paper's boom as each kind of model."""

from collections.abc import Callable

import pytest

from beam_model.component import SegmentModel
from beam_model.finite_element import Theory, finite_element_segment
from beam_model.kantorovich import Base, kantorovich_segments
from geometry.boom import Boom


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

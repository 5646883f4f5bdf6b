# SPDX-License-Identifier: LGPL-3.0-or-later
"""Size of the system for an additional segment, section 5.3 of the paper."""

from dataclasses import replace
from itertools import pairwise

import pytest

from beam_model.finite_element import finite_element_segment
from beam_model.kantorovich import kantorovich_segment
from beam_model.segment_model import SegmentModel, gap_system
from dynamics.contact import PowerContact
from geometry.boom import Boom, Segment
from tests.touching import touching


def chain(boom: Boom, count: int) -> Boom:
    """Return the paper's boom with additional segments, each a metre inside the previous one."""
    outer, inner = boom.segments
    (joint,) = boom.joints
    segments = [
        replace(inner, name=f"inner {i}", section=None, start=9.0 * i, end=9.0 * i + 10.0)
        for i in range(1, count)
    ]
    joints = [
        replace(joint, outer=i, inner=i + 1, stations=(9.0 * (i + 1), 9.0 * (i + 1) + 1.0))
        for i in range(count - 1)
    ]
    return Boom((replace(outer, section=None), *segments), tuple(joints))


@pytest.mark.parametrize("kind", ["series", "elements"])
def test_the_size_grows_with_the_number_of_segments(paper_boom: Boom, kind: str) -> None:
    """Reference: external source, section 5.3. A segment adds its equations and two forces."""
    law = PowerContact(1.0e9, 1.0).with_clearance(7.0e-3)

    def model(boom: Boom, number: int, segment: Segment) -> SegmentModel:
        if kind == "series":
            return kantorovich_segment(segment, 6, "complete", False)
        stations = boom.stations_of(number)
        return finite_element_segment(segment, 0.5, stations, "euler-bernoulli", False)

    sizes = []
    for count in (2, 3, 4, 5):
        boom = chain(paper_boom, count)
        models = [model(boom, number, segment) for number, segment in enumerate(boom.segments)]
        system = gap_system(touching(boom, law), models)
        sizes.append(system.num_modes)
        assert len(system.laws) == 2 * (count - 1)
    steps = [after - before for before, after in pairwise(sizes)]
    assert steps == [6 if kind == "series" else 42] * 3

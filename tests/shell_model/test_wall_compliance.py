# SPDX-License-Identifier: LGPL-3.0-or-later
"""Estimated compliance of walls under pads against that of the shell."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from beam_model.wall_compliance import contact_compliance
from geometry.boom import Boom, Collar, PadSize, Support
from tests.shell_model.booms import LAW, box_segment, flat_boom
from tests.shell_model.models import reduced
from tests.touching import touching

SUPPORTS = (Support(7.0), Support(8.0))


def short_boom(pad: PadSize) -> Boom:
    """Return the paper's sections with 3 m of each segment at the overlap, and pads."""
    boom = touching(flat_boom(), LAW)
    spans = (7.0, 10.0), (9.0, 12.0)
    outer, inner = (
        box_segment(one.name, *span, one.section, supports=held)
        for one, span, held in zip(boom.segments, spans, (SUPPORTS, ()), strict=True)
        if one.section is not None
    )
    return replace(boom, segments=(outer, inner), joints=(replace(boom.joints[0], pad=pad),))


def with_collar(boom: Boom) -> Boom:
    """Return the boom with a collar at the head of the outer segment."""
    collared = replace(boom.segments[0], collars=(Collar((9.6, 10.0), 0.008),))
    return replace(boom, segments=(collared, boom.segments[1]))


def with_strips(boom: Boom) -> Boom:
    """Return the boom with doublers on the outer halves of the flanges at the head."""
    strips = Collar((9.6, 10.0), 0.008, walls=("top", "bottom"), across=(0.06, 0.14))
    return replace(boom, segments=(replace(boom.segments[0], collars=(strips,)), boom.segments[1]))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("pad", "change"),
    [
        (PadSize(0.1, 0.06), lambda boom: boom),
        (PadSize(0.2, 0.04, offset=0.03), lambda boom: boom),
        (PadSize(0.1, 0.06), with_collar),
        (PadSize(0.1, 0.06), with_strips),
    ],
    ids=["beside the webs", "away from the webs", "under a collar", "under strips"],
)
def test_estimated_compliance_follows_the_shell(
    pad: PadSize, change: Callable[[Boom], Boom]
) -> None:
    """Reference: other code, the shell, whose own error of the local compliance is 1 %."""
    boom = change(short_boom(pad))
    shell = reduced(boom, 0.1, contact_tolerance=0.01)
    walls = contact_compliance(boom)
    opening = walls[::2, ::2] + walls[1::2, 1::2] - walls[::2, 1::2] - walls[1::2, ::2]
    estimated = 0.5 * np.diag(opening)
    assert estimated == pytest.approx(shell.local_compliance[::2], rel=0.03)


@pytest.mark.slow
def test_a_pad_on_the_corners_bends_no_wall() -> None:
    """Reference: other code path, stations at the middles of the pads that press the corners along
    their length; narrow pads beside the webs come near from above.
    """

    def local(boom: Boom) -> float:
        return float(reduced(boom, 0.1, contact_tolerance=0.05).local_compliance.max())

    boom = short_boom(PadSize(0.1, 0.06, bears="corner"))
    stations = replace(boom.joints[0], stations=(9.05, 9.95), pad=None, contact_length=0.1)
    on_corners = local(boom)
    assert on_corners == pytest.approx(local(replace(boom, joints=(stations,))), rel=1.0e-6)
    wide, narrow = (local(short_boom(PadSize(0.1, width))) for width in (0.06, 0.01))
    assert on_corners < narrow < wide
    assert on_corners < 0.1 * wide
    assert not contact_compliance(boom).any()

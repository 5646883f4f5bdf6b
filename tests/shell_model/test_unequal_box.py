# SPDX-License-Identifier: LGPL-3.0-or-later
"""A shell with flanges of different thickness bends about its centroid, as its beam does."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from dynamics.contact import PowerContact
from geometry.boom import Boom, Collar, Diaphragm, PadSize, PointMass, Stop, Support
from geometry.section import BoxSection, Section
from shell_model.segment.segment_shell import SegmentShell
from tests.shell_model.booms import HELD, flat_boom, two_segments
from tests.shell_model.conftest import BOX, UNEQUAL
from tests.shell_model.models import assert_rests_as_beams, frequencies_off, reduced

Shells = Callable[..., SegmentShell]


@pytest.mark.slow
@pytest.mark.parametrize("supports", [(), HELD], ids=["free", "held"])
def test_its_frequencies_are_as_far_from_its_beam_as_those_of_a_box(
    box_shell: Shells, supports: tuple[Support, ...]
) -> None:
    """Reference: other code, Timoshenko elements. Free, the box is 0.3 and 2 % apart, for what no
    beam knows; about half its height J would be 3.5 % larger, and the frequencies 1.7 %.
    """
    equal, unequal = (
        frequencies_off(box_shell(0.25, supports=supports, section=one), count=2)
        for one in (BOX, UNEQUAL)
    )
    assert unequal == pytest.approx(equal, abs=2.0e-3)


INNER = BoxSection(0.46, 0.28, flange=0.008, web=0.005, bottom_flange=0.005)


def _boom(outer: Section, inner: Section) -> Boom:
    return replace(flat_boom(), segments=two_segments(outer, inner))


@pytest.mark.slow
def test_a_pressed_boom_rests_as_its_beams_do() -> None:
    """Reference: other code, tied Timoshenko elements; equal flanges are up to 0.25 % apart."""
    boom = _boom(UNEQUAL, INNER)
    assert_rests_as_beams(reduced(boom, 0.25).system, boom, 5.0e-3)


@pytest.mark.slow
def test_thicker_flanges_give_way_less() -> None:
    """Reference: analytic, by order. The upper flanges of both segments, which meet, are the
    thicker ones; with equal flanges both sides give way alike. With all that a segment may have,
    on a graded mesh.
    """
    equal = _boom(BOX, replace(BOX, height=0.46, width=0.28))
    above, below = _row_compliances(_laden(equal))
    assert above == pytest.approx(below, rel=1.0e-6)
    above, below = _row_compliances(_laden(_boom(UNEQUAL, INNER)))
    assert above < 0.99 * below


def _laden(boom: Boom) -> Boom:
    outer, inner = boom.segments
    outer = replace(outer, collars=(Collar((4.0, 5.0), 0.004),))
    masses, plates = (PointMass(19.0, 50.0),), (Diaphragm(18.5, 0.005),)
    inner = replace(inner, masses=masses, diaphragms=plates)
    pads = (replace(boom.joints[0], pad=PadSize(0.1, 0.06)),)
    stops = (Stop(1, 18.0, 0.02, PowerContact(1.0e8, 1.0, stiffness_below=1.0e8)),)
    return replace(boom, segments=(outer, inner), joints=pads, stops=stops)


def _row_compliances(boom: Boom) -> tuple[float, float]:
    """Of the rows at 9 m that press up and down, in m/N, beyond slow motion of the segments."""
    found = reduced(boom, 0.5, contact_tolerance=0.3)
    assert np.isfinite(found.local_compliance).all()
    rows, squares = found.system.rows[:2], found.system.omega2
    above, below = (rows**2 / (squares + 1e6)).sum(axis=1)
    return float(above), float(below)

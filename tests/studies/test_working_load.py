# SPDX-License-Identifier: LGPL-3.0-or-later
"""Two points of the paper's boom on two coarse meshes, and verifications of invented motions."""

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from studies.motions import friction_case
from studies.working_load import ContactResults, ContactType, Point, PointMotion, Sizes, study

TINY = Sizes(
    meshes=(16.0, 8.0),
    plays=(14.0e-3,),
    loads=(1.0, 10.0),
    pads=(),
    in_space=(Point(2.0e-3, 40.0),),
    duration=0.9,
    spatial_duration=0.07,
    peaks=1,
)


def moved(tip: float, peak: float) -> PointMotion:
    return PointMotion(np.array([0.0, tip]), np.array([peak]), np.ones(2))


def told(*peaks: float) -> list[tuple[str, float]]:
    """Return text and value of the verifications of each peak of a point, on two meshes."""
    points = [Point(1.0e-3 * i, 1.0) for i in range(len(peaks))]
    touch = ContactType("points", "webs", friction_case(), points, 1.0)
    meshes = {
        point: [moved(1.01, peak), moved(1.0, 1.0)]
        for point, peak in zip(points, peaks, strict=True)
    }
    return [
        (verification.what, verification.value)
        for verification in ContactResults(touch, meshes).verifications
    ]


def test_existing_first_peaks_are_verified() -> None:
    """Reference: analytic, changes of 1 % of the tip, and of 2 % of the only peak."""
    none = float("nan")
    tip = ("tip, part of its range, webs, worst of 2 points (0 mm, load × 1)", pytest.approx(0.01))
    peak = ("first tip peak, webs, worst of 1 points (1 mm, load × 1)", pytest.approx(0.02))
    assert told(none, none) == [tip]
    assert told(none, 1.02) == [peak, tip]


@pytest.mark.slow
def test_a_mesh_errs_more_under_more_load() -> None:
    """Reference: other mesh, the finer one. Ten times the load bends walls more."""
    contact_types: list[str] = []
    found = study(contact_types.append, TINY)
    assert contact_types == ["near webs", "in space, near webs"]
    assert list(found.data) == ["working-load", "points-webs", "points-in-space"]
    light, heavy = found.data["points-webs"]
    assert (light["point"], heavy["point"]) == ("14 mm, load × 1", "14 mm, load × 10")
    change, force = "tip (% of range)", "largest pad force (kN)"
    assert 0.0 < light[change] < heavy[change] < 10.0
    assert heavy[force] > 3.0 * light[force]
    assert [verification.what for verification in found.verifications] == [
        "first tip peak, near webs, worst of 2 points (14 mm, load × 10)",
        "tip, part of its range, near webs, worst of 2 points (14 mm, load × 10)",
        "tip, part of its range, in space, near webs, worst of 1 points (2 mm, load × 40)",
    ]
    assert found.verifications[1].value == pytest.approx(0.01 * heavy[change])
    (pressed,) = found.data["points-in-space"]
    assert pressed[force] > 10.0
    assert found.verifications[2].value == pytest.approx(0.01 * pressed[change])
    assert 0.0 < pressed[change] < 10.0

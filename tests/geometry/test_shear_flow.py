# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shear flow of closed walls: equilibrium, the work that it does, the shear centre."""

import numpy as np
import pytest

from geometry.polygon import PolygonSection
from geometry.section import BoxSection, Direction, Section
from geometry.shear_flow import ShearFlow, shear_centre
from tests.geometry.test_polygon import ALL, HEXAGON, OCTAGON, TRAPEZOID, U


def test_a_box_worked_by_hand() -> None:
    """Reference: analytic, t b h/4 J at the end of half a flange, plus (t/2J)(h²/4 − z²) over the
    web."""
    b, h, t = 0.4, 0.6, 0.01
    bending = t * h**3 / 6.0 + b * t * h**2 / 2.0
    corner, hump = t * b * h / (4.0 * bending), t * h**2 / (8.0 * bending)
    webs = 2.0 * h * (corner**2 + 4.0 / 3.0 * corner * hump + 8.0 / 15.0 * hump**2)
    flanges = 2.0 * b * corner**2 / 3.0
    flow = ShearFlow.from_plates(BoxSection(h, b, t, t).plates, "z")
    assert flow.shear_area == pytest.approx(t / (webs + flanges), rel=1e-12)
    assert flow.moment == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("direction", ["z", "y"])
def test_it_is_the_force_and_does_not_twist(name: str, direction: Direction) -> None:
    """Reference: analytic, equilibrium and ∮ q/t ds = 0."""
    plates = ALL[name].plates
    flow = ShearFlow.from_plates(plates, direction)
    tangents = np.array([plate.tangent for plate in plates])
    expected = [1.0, 0.0] if direction == "y" else [0.0, 1.0]
    assert flow.forces @ tangents == pytest.approx(expected, abs=1e-12)
    assert flow.forces @ (1.0 / flow.thicknesses) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("direction", ["z", "y"])
def test_carriers_hold_a_force_through_the_axis(name: str, direction: Direction) -> None:
    """Reference: analytic. In a rigid motion they give its part along the force, and no turn."""
    section = ALL[name]
    found = section.shear_plates(direction)
    forces = sum(force * section.plates[n].tangent for n, force in found)
    assert forces == pytest.approx([1.0, 0.0] if direction == "y" else [0.0, 1.0], abs=1e-12)
    arms = [np.linalg.det([section.plates[n].middle, section.plates[n].tangent]) for n, _ in found]
    assert sum(f * arm for (_, f), arm in zip(found, arms, strict=True)) == pytest.approx(
        0.0, abs=1e-15
    )


def test_flats_carry_nothing_along_z_and_the_inclined_plates_alike() -> None:
    """Reference: symmetry."""
    assert [n for n, _ in HEXAGON.shear_plates("z")] == [1, 2, 4, 5]
    right, left = (dict(HEXAGON.shear_plates("z"))[n] for n in (1, 5))
    assert right == pytest.approx(-left, rel=1e-12)


def _by_small_steps(section: Section, direction: Direction) -> tuple[float, float]:
    """Shear area in m² and the force's arm in m, by sums over 20 000 pieces of the mid-line."""
    count = 20_000 // len(section.plates)
    parts = (np.arange(count) + 0.5) / count
    places = np.concatenate(
        [np.outer(1 - parts, p.start) + np.outer(parts, p.end) for p in section.plates]
    )
    thickness = np.repeat([plate.thickness for plate in section.plates], count)
    length = np.repeat([plate.length / count for plate in section.plates], count)
    tangents = np.repeat([plate.tangent for plate in section.plates], count, axis=0)
    area = thickness * length
    centre = area @ places / area.sum()
    coordinate = (places - centre)[:, 0 if direction == "y" else 1]
    statical = np.cumsum(area * coordinate) - 0.5 * area * coordinate
    flow = -statical / (area @ coordinate**2)
    flow -= (flow @ (length / thickness)) / (length / thickness).sum()
    arms = places[:, 0] * tangents[:, 1] - places[:, 1] * tangents[:, 0]
    return 1.0 / (flow**2 @ (length / thickness)), arms @ (flow * length)


@pytest.mark.parametrize("section", [TRAPEZOID, HEXAGON, OCTAGON, U], ids=ALL)
def test_shear_areas_and_centre_against_small_steps(section: PolygonSection) -> None:
    """Reference: other code, sums over 20 000 pieces."""
    found = {d: _by_small_steps(section, d) for d in ("z", "y")}
    assert section.shear_area == pytest.approx(found["z"][0], rel=1e-6)
    assert section.lateral_shear_area == pytest.approx(found["y"][0], rel=1e-6)
    centre = found["z"][1], -found["y"][1]
    assert shear_centre(section.plates) == pytest.approx(centre, abs=1e-7)


def test_the_shear_centre_of_a_box_with_unequal_webs() -> None:
    """Reference: other code, sums over small steps; with equal webs it is on the axis."""
    box = BoxSection(0.6, 0.4, 0.02, 0.02, left_web=0.01)
    assert shear_centre(box.plates)[0] == pytest.approx(_by_small_steps(box, "z")[1], abs=1e-7)
    assert shear_centre(box.plates)[0] > 0.04
    assert shear_centre(BoxSection(0.6, 0.4, 0.02, 0.01).plates) == pytest.approx((0, 0), abs=1e-15)

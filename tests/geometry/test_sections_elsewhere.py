# SPDX-License-Identifier: LGPL-3.0-or-later
"""Polygons, compared with finite elements over the section by the program sectionproperties."""

import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from protractile.geometry.polygon import PolygonSection
from protractile.geometry.walls import trapezoids
from studies.reference_models.statics import shear_centre
from tests.geometry.test_polygon import ALL
from tests.other_codes import INSTALLED, run_elsewhere

pytestmark = [pytest.mark.slow, INSTALLED]

PROGRAM = """
import json, sys
from sectionproperties.analysis import Section
from sectionproperties.pre import Geometry
from shapely import Polygon

outline, hole, size = json.load(sys.stdin)
geometry = Geometry(Polygon(outline, [hole]))
geometry.create_mesh([size])
found = Section(geometry)
found.calculate_geometric_properties()
found.calculate_warping_properties()
about_y, about_z, _ = found.get_ic()
along_y, along_z = found.get_as()
json.dump({
    "area": found.get_area(),
    "second_moment_of_area": about_y,
    "lateral_second_moment_of_area": about_z,
    "torsion_constant": found.get_j(),
    "shear_area": along_z,
    "lateral_shear_area": along_y,
    "centroid": found.get_c(),
    "shear_centre": found.get_sc(),
}, sys.stdout)
"""
OF_WALLS = ("torsion_constant", "shear_area", "lateral_shear_area")


def thinner(section: PolygonSection, part: float) -> PolygonSection:
    return replace(section, thicknesses=tuple(part * wall for wall in section.thicknesses))


@cache
def elsewhere(section: PolygonSection) -> dict[str, Any]:
    """Return the properties by quadratic triangles, several across the thinnest wall."""
    walls = trapezoids(section.plates)
    outline, hole = walls[:, 0].tolist(), walls[:, 3].tolist()
    given = json.dumps([outline, hole, 0.5 * min(section.thicknesses) ** 2])
    return json.loads(run_elsewhere("-c", PROGRAM, given=given))


@pytest.mark.parametrize("name", ALL)
def test_area_and_second_moments(name: str) -> None:
    """Reference: other code. Both are exact for straight boundaries."""
    section = ALL[name]
    found = elsewhere(section)
    for key in ("area", "second_moment_of_area", "lateral_second_moment_of_area"):
        assert getattr(section, key) == pytest.approx(found[key], rel=1e-8), key
    assert found["centroid"] == pytest.approx((0.0, 0.0), abs=1e-9)


@pytest.mark.parametrize("name", ALL)
def test_torsion_shear_areas_and_shear_centre_of_thin_walls(name: str) -> None:
    """Reference: other code, extrapolated from half and a quarter of the thickness to 0, since the
    effect of corners is proportional to the thickness. It is 0.3 to 1.2 % for these walls.
    """
    halves = [thinner(ALL[name], part) for part in (0.5, 0.25)]
    for key in OF_WALLS:
        half, quarter = (elsewhere(one)[key] / getattr(one, key) for one in halves)
        assert 2.0 * quarter - half == pytest.approx(1.0, abs=1.0e-3), key
        assert quarter == pytest.approx(1.0, abs=4.0e-3), key
    half, quarter = (np.array(elsewhere(one)["shear_centre"]) for one in halves)
    centre = shear_centre(thinner(ALL[name], 1.0e-3).plates)
    assert 2.0 * quarter - half == pytest.approx(centre, abs=1.0e-3 * ALL[name].size("z"))

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Polygons, compared with finite elements over the section by the program sectionproperties."""

import json
from dataclasses import replace

import numpy as np
import pytest

from protractile.geometry.walls import trapezoids
from studies.reference_models.statics import shear_centre
from tests.geometry.test_section import ALL
from tests.other_codes import INSTALLED, run_elsewhere

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


@pytest.mark.slow
@INSTALLED
@pytest.mark.parametrize("name", ["trapezoid", "u"])
def test_properties_of_thin_walls(name: str) -> None:
    """Reference: other code, by quadratic triangles. Areas and
    second moments are exact for straight boundaries. Others are extrapolated from half and a
    quarter of the thickness to 0, since the effect of corners is proportional to the thickness. It
    is 0.3 to 1.2 % for these walls.
    """
    whole = ALL[name]
    halves = [
        replace(whole, thicknesses=tuple(part * wall for wall in whole.thicknesses))
        for part in (0.5, 0.25, 1.0e-3)
    ]
    found = []
    for section in halves[:2]:
        walls = trapezoids(section.plates)
        outline, hole = walls[:, 0].tolist(), walls[:, 3].tolist()
        numbers = json.dumps([outline, hole, 2.0 * min(section.thicknesses) ** 2])
        found.append(json.loads(run_elsewhere("-c", PROGRAM, given=numbers)))
    for key in ("area", "second_moment_of_area", "lateral_second_moment_of_area"):
        assert getattr(halves[0], key) == pytest.approx(found[0][key], rel=1e-8), key
    assert found[0]["centroid"] == pytest.approx((0.0, 0.0), abs=1e-9)
    for key in ("torsion_constant", "shear_area", "lateral_shear_area"):
        half, quarter = (f[key] / getattr(s, key) for f, s in zip(found, halves, strict=False))
        assert 2.0 * quarter - half == pytest.approx(1.0, abs=1.0e-3), key
        assert quarter == pytest.approx(1.0, abs=4.0e-3), key
    half, quarter = (np.array(one["shear_centre"]) for one in found)
    centre = shear_centre(halves[2].plates)
    assert 2.0 * quarter - half == pytest.approx(centre, abs=1.0e-3 * whole.size("z"))

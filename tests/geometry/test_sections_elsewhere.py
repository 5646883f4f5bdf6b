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

def properties(outline, hole, size):
    geometry = Geometry(Polygon(outline, [hole]))
    geometry.create_mesh([size])
    found = Section(geometry)
    found.calculate_geometric_properties()
    found.calculate_warping_properties()
    about_y, about_z, _ = found.get_ic()
    along_y, along_z = found.get_as()
    return {
        "area": found.get_area(),
        "second_moment_of_area": about_y,
        "lateral_second_moment_of_area": about_z,
        "torsion_constant": found.get_j(),
        "shear_area": along_z,
        "lateral_shear_area": along_y,
        "centroid": found.get_c(),
        "shear_centre": found.get_sc(),
    }

json.dump([properties(*section) for section in json.load(sys.stdin)], sys.stdout)
"""


@pytest.mark.slow
@INSTALLED
def test_properties_of_thin_walls() -> None:
    """Reference: other code, by quadratic triangles. Areas and
    second moments are exact for straight boundaries. Others are extrapolated from half and a
    quarter of the thickness to 0, since the effect of corners is proportional to the thickness. It
    is 0.3 to 1.2 % for these walls.
    """
    sections, given = [], []
    for whole in (ALL["trapezoid"], ALL["u"]):
        for part in (0.5, 0.25):
            section = replace(whole, thicknesses=tuple(part * wall for wall in whole.thicknesses))
            walls = trapezoids(section.plates)
            size = 2.0 * min(section.thicknesses) ** 2
            sections.append(section)
            given.append([walls[:, 0].tolist(), walls[:, 3].tolist(), size])
    results = json.loads(run_elsewhere("-c", PROGRAM, given=json.dumps(given)))
    for at in (0, 2):
        halves, found = sections[at : at + 2], results[at : at + 2]
        for key in ("area", "second_moment_of_area", "lateral_second_moment_of_area"):
            assert getattr(halves[0], key) == pytest.approx(found[0][key], rel=1e-8), key
        assert found[0]["centroid"] == pytest.approx((0.0, 0.0), abs=1e-9)
        for key in ("torsion_constant", "shear_area", "lateral_shear_area"):
            half, quarter = (f[key] / getattr(s, key) for f, s in zip(found, halves, strict=True))
            assert 2.0 * quarter - half == pytest.approx(1.0, abs=1.0e-3), key
            assert quarter == pytest.approx(1.0, abs=4.0e-3), key
        half, quarter = (np.array(one["shear_centre"]) for one in found)
        thin = tuple(0.002 * wall for wall in halves[0].thicknesses)
        centre = shear_centre(replace(halves[0], thicknesses=thin).plates)
        assert 2.0 * quarter - half == pytest.approx(centre, abs=1.0e-3 * halves[0].size("z"))

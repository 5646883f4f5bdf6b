# SPDX-License-Identifier: LGPL-3.0-or-later
"""A box whose walls differ: its centroid, its properties about it, its faces, what it refuses."""

import re
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.spatial import cKDTree

from geometry.boom import Boom, BoomError
from geometry.mesh import mesh_segment
from geometry.plating import plain_thickness
from geometry.section import BoxSection
from geometry.walls import free_room

# Outside 0.41 m wide, from -0.31 to 0.32 m; hole 0.39 m wide, from -0.29 to 0.28 m.
BOX = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01, bottom_flange=0.02)
OUTER, INNER = (0.41, -0.31, 0.32), (0.39, -0.29, 0.28)


def test_properties_worked_by_hand() -> None:
    """Reference: analytic, by hand. The outer rectangle less the inner one, with Steiner's part."""
    areas = [width * (top - bottom) for width, bottom, top in (OUTER, INNER)]
    middles = [0.5 * (bottom + top) for _, bottom, top in (OUTER, INNER)]
    area = areas[0] - areas[1]
    z = (areas[0] * middles[0] - areas[1] * middles[1]) / area
    assert BOX.area == pytest.approx(area, rel=1e-12)
    assert BOX.centroid == pytest.approx((0.0, z), rel=1e-12, abs=1e-15)
    own = [width * (top - bottom) ** 3 / 12.0 for width, bottom, top in (OUTER, INNER)]
    parts = [i + a * (middle - z) ** 2 for i, a, middle in zip(own, areas, middles, strict=True)]
    assert BOX.second_moment_of_area == pytest.approx(parts[0] - parts[1], rel=1e-12)
    aside = (0.63 * 0.41**3 - 0.57 * 0.39**3) / 12.0
    assert BOX.lateral_second_moment_of_area == pytest.approx(aside, rel=1e-12)
    assert BOX.polar_second_moment_of_area == pytest.approx(parts[0] - parts[1] + aside, rel=1e-12)
    # 4 (0.24 m²)² over 2 · 0.6/0.01 + 0.4/0.04 + 0.4/0.02 = 150
    assert BOX.torsion_constant == pytest.approx(0.2304 / 150.0, rel=1e-12)
    assert BOX.shear_area == pytest.approx(0.012, rel=1e-12)
    assert BOX.lateral_shear_area == pytest.approx(0.024, rel=1e-12)
    assert BOX.perimeter == pytest.approx(2.0, rel=1e-12)
    assert BOX.enclosed_area == pytest.approx(0.24, rel=1e-12)


def test_properties_against_integration_over_the_plane() -> None:
    """Reference: other code, scipy's adaptive quadrature over the rectangle less its hole."""

    def moment(power: int) -> float:
        total = 0.0
        for sign, (width, bottom, top) in ((1.0, OUTER), (-1.0, INNER)):
            value, _ = dblquad(
                lambda z, _: (z - BOX.centroid[1]) ** power,
                -0.5 * width, 0.5 * width, bottom, top, epsabs=1e-14, epsrel=1e-13,
            )  # fmt: skip
            total += sign * value
        return total

    assert BOX.area == pytest.approx(moment(0), rel=1e-11)
    assert moment(1) == pytest.approx(0.0, abs=1e-13)
    assert BOX.second_moment_of_area == pytest.approx(moment(2), rel=1e-11)


def test_walls_given_twice_alike_are_those_of_a_plain_box() -> None:
    plain = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01)
    assert BoxSection(0.60, 0.40, 0.04, 0.01, bottom_flange=0.04, left_web=0.01) == plain
    assert (str(plain), str(BOX)) == ("600 x 400 x 40 / 10", "600 x 400 x 40 / 20 / 10 / 10")


def test_on_its_side() -> None:
    """Reference: analytic, y and z exchanged."""
    side = BOX.turned()
    assert side.second_moment_of_area == BOX.lateral_second_moment_of_area
    assert side.lateral_second_moment_of_area == BOX.second_moment_of_area
    assert side.centroid == BOX.centroid[::-1]
    assert (BOX.mirrors, side.mirrors) == (("y",), ("z",))
    assert side.turned() == BOX


def test_faces_count_from_the_centroid() -> None:
    """Reference: analytic. The outer surfaces are 0.63 m apart, the inner ones 0.57 m."""
    z = BOX.centroid[1]
    top, bottom = BOX.face("z", 1), BOX.face("z", -1)
    assert (top.outside, bottom.outside) == pytest.approx((0.32 - z, -0.31 - z), rel=1e-12)
    assert (top.inside, bottom.inside) == pytest.approx((0.28 - z, -0.29 - z), rel=1e-12)
    inner = BoxSection(height=0.53, width=0.30, flange=0.02, web=0.02)
    assert free_room(BOX, inner)[0] == pytest.approx(0.02, rel=1e-12)


def test_a_force_through_the_centroid_goes_to_the_flanges_by_the_lever() -> None:
    """Reference: analytic. The parts sum to one, and their resultant is in the centroid."""
    forces = [(n, part * BOX.plates[n].tangent[0]) for n, part in BOX.shear_plates("y")]
    assert sum(force for _, force in forces) == pytest.approx(1.0, rel=1e-15)
    arms = [force * BOX.plates[number].middle[1] for number, force in forces]
    assert sum(arms) == pytest.approx(0.0, abs=1e-16)


def test_boom_refuses_sections_without_lateral_symmetry(
    paper_boom: Boom, spatial_boom: Boom
) -> None:
    crooked = BoxSection(0.45, 0.25, 0.006, 0.006, left_web=0.005)
    message = (
        "segments[1].section: does not mirror itself in y, and would bend sideways under its weight"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        _with_inner(paper_boom, crooked)
    message = (
        "segments[1].section: does not mirror itself in z, and would twist as it bends sideways, "
        "which no model in space knows; leave lateral_play out, or make the flanges alike"
    )
    unequal = BoxSection(0.45, 0.25, 0.008, 0.005, bottom_flange=0.005)
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        _with_inner(spatial_boom, unequal)
    assert _with_inner(paper_boom, unequal).segments[1].section is unequal


def _with_inner(boom: Boom, section: BoxSection) -> Boom:
    outer, inner = boom.segments
    return replace(boom, segments=(outer, replace(inner, section=section)))


def test_each_wall_of_its_mesh_has_its_place_area_and_thickness() -> None:
    """Reference: analytic. The mesh is its own image in y; a diaphragm fills the box."""
    mesh = mesh_segment(BOX, {"start": 0.0, "end": 2.0}, 0.1, closed=("end",))
    corners = mesh.points[mesh.triangles]
    areas = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    thickness = plain_thickness(BOX, mesh)
    for number, plate in enumerate(BOX.plates):
        mine = mesh.walls == number
        assert plate.distance(corners[mine].reshape(-1, 3)[:, 1:]).max() < 1e-14
        assert areas[mine].sum() == pytest.approx(2.0 * plate.length, rel=1e-12)
        assert (thickness[mine] == plate.thickness).all()
    assert areas[~mesh.on_walls].sum() == pytest.approx(BOX.enclosed_area, rel=1e-12)
    mirrored = mesh.points * [1.0, -1.0, 1.0]
    assert cKDTree(mesh.points).query(mirrored)[0].max() < 1e-12


def test_places_on_plates() -> None:
    """Reference: analytic. Ends and middles are on them, the middle of the section is not."""
    places = np.array([place for plate in BOX.plates for place in (plate.start, plate.middle)])
    assert BOX.on_plates(places).all()
    assert not BOX.on_plates(np.vstack([[0.0, 0.0], 1.001 * places])).any()

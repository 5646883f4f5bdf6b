# SPDX-License-Identifier: LGPL-3.0-or-later
"""Hexahedra fill the walls of a quarter box, corners once."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from geometry.arrays import Array
from geometry.section import BoxSection
from studies.reference_models.solid_mesh import SolidMesh, mesh_quarter

BOX = BoxSection(height=0.40, width=0.30, flange=0.03, web=0.02)
PLACES = (0.0, 0.5, 2.0)


def volumes(mesh: SolidMesh) -> Array:
    """(num_hexahedra,) of bricks, negative where their points do not run along x, y, z."""
    corners = mesh.points[mesh.hexahedra]
    edges = corners[:, [1, 2, 4]] - corners[:, :1]
    assert corners[:, 7] == pytest.approx(corners[:, 0] + edges.sum(axis=1), abs=1.0e-12)
    return np.linalg.det(edges)


@pytest.mark.parametrize("layers", [2, 4])
def test_the_quarter_has_a_quarter_of_the_volume_and_of_both_second_moments(layers: int) -> None:
    """Reference: analytic, A L / 4, and J L / 4 of the hollow rectangle.

    A shell's mid-surfaces have the same area, and less second moment: by tw h tf²/2 about y.
    """
    mesh = mesh_quarter(BOX, PLACES, (0.02, 0.3), 0.05, 2, layers)
    parts = volumes(mesh)
    assert (parts > 0.0).all()
    assert parts.sum() == pytest.approx(0.25 * BOX.area * 2.0, rel=1.0e-12)
    bounds = mesh.points[mesh.hexahedra]
    low, high = bounds.min(axis=1), bounds.max(axis=1)
    for axis, moment in (
        (2, BOX.second_moment_of_area),
        (1, BOX.lateral_second_moment_of_area),
    ):
        squares = (high**3 - low**3)[:, axis] / (3.0 * (high - low)[:, axis])
        assert parts @ squares == pytest.approx(0.25 * moment * 2.0, rel=1.0e-12)
    h, b, tf, tw = BOX.height, BOX.width, BOX.flange, BOX.web
    middle_lines = b * tf * h**2 / 2.0 + b * tf**3 / 6.0 + tw * h**3 / 6.0
    assert BOX.second_moment_of_area - middle_lines == pytest.approx(tw * h * tf**2 / 2.0)


def test_mid_lines_places_and_mirrors_are_planes_and_edges_grow_away_from_places() -> None:
    """Reference: analytic."""
    mesh = mesh_quarter(BOX, PLACES, (0.02, 0.3), 0.05)
    x, y, z = mesh.planes
    for plane, places in ((x, PLACES), (y, (0.0, 0.14, 0.15, 0.16)), (z, (0.0, 0.185, 0.2, 0.215))):
        for place in places:
            assert np.abs(plane - place).min() < 1.0e-12
    edges = np.diff(x)
    for place in PLACES:
        beside = np.abs(0.5 * (x[1:] + x[:-1]) - place) < 0.6 * edges
        assert edges[beside].max() < 0.02 * (1.0 + 1.0e-12)
    assert 0.1 < edges.max() < 0.3
    assert (edges[1:] / edges[:-1]).max() < 3.0 + 1.0e-9
    assert len(mesh.points) == mesh.hexahedra.max() + 1
    for plane, wall in ((y, BOX.web), (z, BOX.flange)):
        around = np.diff(plane)
        assert (around[:-3] >= around[1:-2] - 1.0e-12).all()
        assert 0.5 * wall < around[-3] < 1.0001 * wall
        assert around.max() < 0.05
    split = mesh_quarter(BOX, PLACES, (0.02, 0.3), 0.05, splits=2)
    assert split.planes[1][:-2:2] == pytest.approx(y[:-2], abs=1.0e-12)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"along": (0.0, 0.1)},
            "the lengths along x must be positive numbers of m, rising, got (0.0, 0.1)",
        ),
        (
            {"along": (0.2, 0.1)},
            "the lengths along x must be positive numbers of m, rising, got (0.2, 0.1)",
        ),
        ({"around": 0.0}, "the length around must be a positive number of m, got 0.0"),
        ({"splits": 0}, "an edge must be split into 1 or more, got 0"),
        ({"layers": 3}, "the layers must be an even number from 2 on, got 3"),
        ({"places": (1.0, 1.0)}, "a segment needs two distinct places at least, its ends"),
    ],
)
def test_refuses_what_cannot_be_meshed(changes: dict[str, Any], message: str) -> None:
    arguments: dict[str, Any] = {
        "places": PLACES,
        "along": (0.1, 0.2),
        "around": 0.1,
        "layers": 2,
        **changes,
    }
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        mesh_quarter(BOX, **arguments)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The largest stresses of a run are found where and when a hand-made motion has them."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.mesh import mesh_segment
from geometry.plating import plated
from geometry.section import BoxSection
from shell_model.stress.history import near_places, sum_up
from shell_model.stress.stresses import ShellStress
from tests.shell_model.booms import box_segment

BOX = BoxSection(height=0.4, width=0.3, flange=0.005, web=0.005)
TIME = np.linspace(0.0, 1.0, 1001)


@pytest.fixture
def shell() -> ShellStress:
    """A box of 4 m: a bending of all of it in one coordinate, a spot near 3 m in the other.

    The spot is one triangle of the top, whose faces bend; it shows at 0.701 s for an instant,
    between those at which every triangle is looked at.
    """
    mesh = mesh_segment(BOX, {"start": 0.0, "end": 4.0}, 0.1)
    mesh = plated(box_segment("box", 0.0, 4.0, BOX), mesh)
    centroids = mesh.points[mesh.triangles].mean(axis=1)
    modes = np.zeros((2, len(mesh.triangles), 6), dtype=np.float32)
    modes[0, :, 0] = 5.0e6 * centroids[:, 2]
    spot = np.abs(centroids - [3.05, 0.05, 0.2]).sum(axis=1)
    spot[mesh.walls != mesh.plates.index("top")] = np.inf
    modes[1, spot.argmin(), 3] = 8.0e6
    states = np.stack([np.sin(np.pi * TIME) ** 2, TIME[701] == TIME], axis=1).astype(np.float32)
    still = ShellStress.still(mesh, modes[:1])
    return ShellStress(
        still.centroids,
        still.areas,
        still.thickness,
        still.spans,
        still.segment,
        still.outward,
        still.wall,
        still.plates,
        modes=[modes],
        states=[states],
        time=TIME,
        axial=still.axial,
    )


def test_bands_see_the_spot_and_patches_its_mean(shell: ShellStress) -> None:
    """Reference: analytic. The bending is 1 MPa at the flanges at its height; a spot in a patch
    of thirty triangles raises their mean by a thirtieth of it.
    """
    history = near_places(shell, [1.0, 3.0, 9.0], ["box"])
    near = history["von_mises"].sel(segment="box")
    assert near.sel(place=1.0).max() == pytest.approx(1.0e6, rel=1e-5)
    assert float(near["time"][int(near.sel(place=1.0).argmax("time"))]) == pytest.approx(0.5)
    assert float(near["time"][int(near.sel(place=3.0).argmax("time"))]) == pytest.approx(0.701)
    bending = 1.0e6 * np.sin(0.701 * np.pi) ** 2
    assert near.sel(place=3.0).max() == pytest.approx(bending + 8.0e6, rel=1e-5)
    patch = history["von_mises_patch"].sel(segment="box", place=3.0)
    top = np.flatnonzero((shell.wall == 2) & (np.abs(shell.centroids[:, 0] - 3.0) <= 0.25))
    half = top[shell.centroids[top, 1] > 0.0]
    share = 8.0e6 / half.size
    assert float(patch[701]) == pytest.approx(bending + share, rel=1e-3)
    assert history["von_mises"].sel(place=9.0).isnull().all()


@pytest.mark.parametrize("places", [[1.0, 3.0], []])
def test_the_largest_is_found(shell: ShellStress, places: list[float]) -> None:
    """With a band it is the spot; without, what all triangles have at some instants."""
    found = sum_up(shell, near_places(shell, places, ["box"]))
    if not places:
        assert found.von_mises == pytest.approx(1.0e6, rel=1e-3)
        assert found.patch is None
        return
    assert found.time == pytest.approx(0.701)
    assert (found.segment, found.wall, found.face) == ("box", "top", "outer")
    assert found.x == pytest.approx(3.05, abs=0.05)
    assert len(found.history.time) == 80
    spotted = next(row for row in found.history.places if row.x == 3.0)
    assert max(spotted.von_mises) == pytest.approx(found.von_mises, rel=1e-3)

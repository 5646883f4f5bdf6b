# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling of walls: known factors of plates, finite strips, and segments of a boom at rest."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.failure import NumericsError
from protractile.geometry.boom import Boom, Support
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.buckling import (
    ShellState,
    buckle_segments,
    buckling_modes,
)
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.stress.stresses import triangle_areas
from studies.reference_models.finite_strip import Strips
from studies.reference_models.plates import STEEL
from studies.reference_models.single_segment import shell_alone
from studies.wall_buckling import (
    BOXES,
    COLUMN,
    PLATES,
    PRESSED,
    TUBE,
    UNIT,
    LoadedBox,
    LoadedPlate,
)
from tests.shell_model.booms import box_segment


def extrapolated(coarse: float, fine: float) -> float:
    """Return the limit of two meshes, one with edges of half the length, at an order of 2."""
    return float(fine * np.cbrt(fine / coarse))


@pytest.mark.parametrize("plate", PLATES, ids=lambda plate: plate.name)
def test_plates_buckle_at_known_factors(plate: LoadedPlate) -> None:
    """Reference: analytic, from above with order 2; the limit of two meshes within 0.6 %."""
    first, coarse, fine = (float(plate.shell(n)[0]) for n in (4, 8, 16))
    assert first > coarse > fine > plate.factor
    assert fine < 1.035 * plate.factor
    assert np.log2((first - coarse) / (coarse - fine)) > 1.0
    assert extrapolated(coarse, fine) == pytest.approx(plate.factor, rel=6.0e-3)


def test_tension_has_no_factor() -> None:
    pulled = replace(PLATES[0], forces=((1.0, 0.5, 0.0),) * 2)
    assert pulled.shell(4, 2).size == 0


def test_finite_strips_know_walls_and_columns() -> None:
    """Reference: analytic, k = 4 of a square tube, 5.33 in bending, and Euler's column."""
    strips, width = Strips.of(TUBE, STEEL), 0.4
    stress = UNIT * (0.004 / width) ** 2
    found = strips.lowest(3.0 * width, range(1, 7), lambda y, z: np.full_like(z, -stress))
    assert found == pytest.approx(4.0, rel=1.0e-3)
    found = min(
        strips.factor(part * width, 1, lambda y, z: -stress * z / 0.2)
        for part in np.linspace(0.7, 1.0, 13)
    )
    assert found == pytest.approx(5.33, rel=2.0e-3)
    length = 200.0 * width
    found = strips.factor(length, 1, lambda y, z: np.full_like(z, -1.0))
    radius2 = TUBE.second_moment_of_area / TUBE.area
    assert found == pytest.approx(np.pi**2 * STEEL.youngs_modulus * radius2 / length**2, rel=1e-3)


@pytest.mark.slow
def test_a_box_buckles_as_finite_strips() -> None:
    """Reference: other code, finite strips, within 1 % of the limit of two meshes."""
    box = BOXES[-1]  # in compression and bending
    coarse, fine = (float(box.shell(n)[1].factors[0]) for n in (8, 16))
    assert coarse > fine
    assert extrapolated(coarse, fine) == pytest.approx(box.strips(), rel=0.01)


@pytest.mark.slow
def test_webs_buckle_under_patch_loads() -> None:
    """Reference: external, k_F = 6 + 2 (h/a)² of EN 1993-1-5, 6.4, within 15 %."""
    pressed = PRESSED[0]
    found = extrapolated(pressed.shell(4), pressed.shell(8))
    assert found == pytest.approx(pressed.fitted, rel=0.15)


@pytest.mark.slow
def test_a_column_buckles_as_a_whole_and_in_its_walls() -> None:
    """Reference: other code, finite strips with one half-wave and with many, within 1 %."""
    whole = Strips.of(COLUMN.section, STEEL).factor(COLUMN.length, 1, COLUMN.stress)
    shell, modes = COLUMN.shell(4, 2)
    assert modes.factors == pytest.approx([whole, whole], rel=0.01)
    first, _ = shell.owned
    moved = modes.shapes[shell.node_dofs - first]
    assert np.linalg.norm(moved, axis=1).max(axis=0) == pytest.approx([1.0, 1.0])


def test_an_unheld_segment_is_refused() -> None:
    shell = shell_alone(box_segment("box", 0.0, 2.0, TUBE), 0.2)
    forces = np.zeros((len(shell.mesh.triangles), 3)) - [1.0, 0.0, 0.0]
    message = r"^the shell has a rigid motion, and cannot buckle; add a support$"
    with pytest.raises(NumericsError, match=message):
        buckling_modes(shell, forces, 1)


@pytest.mark.slow
def test_beam_buckles_at_its_largest_moment() -> None:
    """Reference: other code, finite strips under the largest moment, from below."""
    supports = Support(0.0), Support(4.0)
    segment = box_segment("beam", 0.0, 4.0, TUBE, load=-8.0e3, supports=supports)
    boom, options = Boom((segment,), ()), ShellOptions(0.1)
    shell = reduce_boom(boom, options, MPI.COMM_SELF)
    state = ShellState.from_fields(shell.fields, shell.system, equilibrium_at(shell.system))
    (found,) = buckle_segments(boom, shell.meshes, state, options, 1, MPI.COMM_SELF)
    moment = 8.0e3 * 4.0**2 / 8.0
    bent = LoadedBox("beam", TUBE, 4.0, bending=-moment / TUBE.second_moment_of_area)
    least = bent.strips(16)
    assert least < found.factors[0] < 1.05 * least
    assert 0.05 < found.mesh_errors[0] < 0.1
    size = np.linalg.norm(found.shapes[0], axis=1)
    most = found.mesh.points[size.argmax()]
    assert most[[0, 2]] == pytest.approx([2.0, 0.2], abs=0.3)


def test_halved_meshes_have_the_same_walls() -> None:
    """Reference: analytic, areas and places."""
    shell = shell_alone(box_segment("box", 0.0, 2.0, TUBE), 0.2)
    mesh = shell.mesh
    finer = mesh.refined
    assert np.array_equal(finer.points[: len(mesh.points)], mesh.points)
    areas = triangle_areas(mesh.points, mesh.triangles)
    own = triangle_areas(finer.points, finer.triangles)
    assert own == pytest.approx(np.repeat(0.25 * areas, 4))
    midpoints = finer.points[finer.triangles].mean(axis=1).reshape(-1, 4, 3).mean(axis=1)
    assert midpoints == pytest.approx(mesh.points[mesh.triangles].mean(axis=1))
    assert len(np.unique(finer.points.round(9), axis=0)) == len(finer.points)

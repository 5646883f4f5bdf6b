# SPDX-License-Identifier: LGPL-3.0-or-later
"""Collars and diaphragms: edges with three walls, masses, and stiffening."""

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from protractile.dynamics.excitation import Step
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Collar, Diaphragm, Load, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.mesh import collar_breaks, diaphragm_breaks, mesh_segment, strip_lines
from protractile.geometry.plating import PlatedMesh, add_thickness
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.segment.segment_shell import SegmentShell, assemble_segment
from protractile.shell_model.segment.solver import times
from studies.reference_models.single_segment import natural_frequencies
from tests.shell_model.booms import HELD, LAW, STEEL, box_segment, flat_boom, reduce_quickly
from tests.shell_model.conftest import BOX, compliance
from tests.touching import touching

# At both ends, on a support, within a collar, and free.
PLATES = tuple(Diaphragm(x, 0.008) for x in (0.0, 2.0, 5.0, 8.0, 10.0))
COLLARS = (
    Collar((9.0, 10.0), 0.01),
    Collar((4.5, 5.5), 0.004),
    Collar((2.5, 3.5), 0.006, across=(0.04, 0.1)),
)


def meshed(segment: Segment, size: float) -> PlatedMesh:
    """Return the mesh of a segment with all its required lines."""
    assert segment.section is not None
    plates = diaphragm_breaks(segment)
    breaks = {"start": segment.start, "end": segment.end} | plates | collar_breaks(segment)
    breaks |= {f"support-{one.x:g}": one.x for one in segment.supports}
    # Where there is none, the mesh is that of the stiffened box all the same.
    breaks |= {f"place-{one.x:g}": one.x for one in PLATES if one.x <= segment.end}
    mesh = mesh_segment(segment.section, breaks, size, tuple(plates), across=strip_lines(segment))
    return add_thickness(segment, mesh)


@cache
def shell_of(section: BoxSection = BOX, **parts: Any) -> SegmentShell:
    """Return a stiffened box on [0, 10]."""
    segment = replace(box_segment("box", 0.0, 10.0, section), **parts)
    return assemble_segment(MPI.COMM_WORLD, segment, meshed(segment, 0.25))


def test_rigid_motions_cost_no_energy_and_carry_the_mass_of_the_stiffeners() -> None:
    """Reference: analytic, ρ times volumes, and their moment about the middle; the uniform load is
    1 N/m over 10 m without a moment, for any stiffeners.
    """
    shell = shell_of(collars=COLLARS, diaphragms=PLATES)
    motions = shell.rigid_motions()
    assert motions.shape[1] == 6
    trial = np.abs(motions).max(axis=1, keepdims=True)
    size = (trial.T @ times(shell.stiffness, trial)).item()
    energies = motions.T @ times(shell.stiffness, motions)
    assert np.abs(energies).max() < 1.0e-10 * size
    assert shell.unit_loads["z"] @ motions == pytest.approx([0, 0, 10.0, 0, 0, 0], abs=1.0e-9)
    assert shell.unit_loads["y"] @ motions == pytest.approx([0, 10.0, 0, 0, 0, 0], abs=1.0e-9)
    inertia = motions.T @ times(shell.mass, motions)
    perimeter, opening = 2.0 * (BOX.height + BOX.width), BOX.height * BOX.width
    widths = perimeter, perimeter, 8.0 * 0.06
    parts = [(BOX.area * 10.0, 0.0)]
    parts += [
        (width * one.length * one.thickness, one.midpoint - 5.0)
        for width, one in zip(widths, COLLARS, strict=True)
    ]
    parts += [(opening * one.thickness, one.x - 5.0) for one in PLATES]
    mass = STEEL.density * sum(volume for volume, _ in parts)
    moment = STEEL.density * sum(volume * arm for volume, arm in parts)
    assert inertia.diagonal()[:3] == pytest.approx([mass] * 3, rel=1.0e-11)
    # A pitch by one radian lowers what lies beyond the middle.
    assert inertia[2, 4] == pytest.approx(-moment, rel=1.0e-11)
    hoses = shell_of(collars=COLLARS, diaphragms=PLATES, added_mass_per_length=30.0)
    inertia = motions.T @ times(hoses.mass, motions)
    assert inertia.diagonal()[:3] == pytest.approx([mass + 300.0] * 3, rel=1.0e-11)
    assert inertia[2, 4] == pytest.approx(-moment, rel=1.0e-11)


def test_a_thrown_segment_flies_with_its_stiffeners() -> None:
    """Reference: analytic. All parts of a free segment have the initial velocity of 0.1 m/s."""
    outer, inner = flat_boom().segments
    mass = inner.mass_per_length + 30.0
    own: dict[str, Any] = {"mass_per_length": mass, "added_mass_per_length": 30.0}
    own |= {"diaphragms": (Diaphragm(9.0, 0.016),), "collars": (Collar((9.0, 9.5), 0.01),)}
    thrown = Load(1, "z", 0.1 * mass, None, Step(), inertial=True)
    stiff = replace(flat_boom(), segments=(outer, replace(inner, **own)), loads=(thrown,))
    system = reduce_quickly(touching(stiff, LAW), ShellOptions(0.5)).system
    velocity = system.excitations[0].load
    speeds = [system.observers[name].row @ velocity for name in ("tail", "tip")]
    assert speeds == pytest.approx([0.1, 0.1], rel=1.0e-8)


def test_outline_at_a_diaphragm_has_only_nodes_of_walls() -> None:
    """Reference: the box without diaphragm on the same mesh. Supports fix the same nodes."""
    held = (Support(0.0), Support(2.0, "clamped"))
    stiffeners = {"collars": COLLARS[:2], "diaphragms": PLATES}
    shells = shell_of(supports=held), shell_of(supports=held, **stiffeners)
    for x in (0.0, 2.0, 5.0, 10.0):
        around = [set(map(tuple, shell.outline(x).places.round(9) + 0.0)) for shell in shells]
        assert around[0] == around[1]
    held_dofs = [int((~shell.free).sum()) for shell in shells]
    assert held_dofs[0] == held_dofs[1]
    assert shells[0].num_dofs < shells[1].num_dofs


@pytest.mark.slow
def test_a_collar_all_along_is_a_thicker_box() -> None:
    """Reference: the box of thicker walls, to round-off, also of two collars on different walls."""
    thick = BoxSection(BOX.height, BOX.width, BOX.flange + 0.004, BOX.web + 0.004)
    frequencies = natural_frequencies(shell_of(supports=HELD, section=thick), 8)[1:]
    all_walls = ("top", "bottom", "right", "left")
    for parts in ((all_walls,), (all_walls[:2], all_walls[2:])):
        collars = tuple(Collar((0.0, 10.0), 0.004, walls=walls) for walls in parts)
        found = natural_frequencies(shell_of(supports=HELD, collars=collars), 8)[1:]
        assert found == pytest.approx(frequencies, rel=1.0e-8)


@pytest.mark.slow
def test_strips_and_a_collar_at_the_largest_moment_bend_as_by_hand() -> None:
    """Reference: analytic, Timoshenko's overhang: 2 A z² of strips, 0.5 m of thicker walls."""
    strips = Collar((0.0, 10.0), 0.012, walls=("top", "bottom"), across=(0.02, 0.08))
    shells = (
        shell_of(supports=HELD, collars=collars)
        for collars in ((), (strips,), (Collar((1.75, 2.25), 0.01),))
    )
    plain, *found = (compliance(one, one.outline(10.0).wall_deflection("z")) for one in shells)
    x = np.linspace(0.0, 10.0, 100_001)
    moment, shear = np.where(x < 2.0, 4.0 * x, 10.0 - x), np.where(x < 2.0, -4.0, 1.0)

    def beam(second: Array | float, area: Array | float) -> float:
        bent = moment**2 / (STEEL.youngs_modulus * second)
        return float(np.mean(bent + shear**2 / (STEEL.shear_modulus * area)))

    own, thick = (
        (box.second_moment_of_area, box.shear_area)
        for box in (BOX, BoxSection(BOX.height, BOX.width, BOX.flange + 0.01, BOX.web + 0.01))
    )
    more = 4.0 * 0.06 * 0.012 * (0.5 * BOX.height) ** 2
    within = np.abs(x - 2.0) < 0.25
    collared = (np.where(within, *pair) for pair in zip(thick, own, strict=True))
    with_strips, with_collar = (
        beam(*one) / beam(*own) for one in ((own[0] + more, own[1]), collared)
    )
    assert found[0] / plain == pytest.approx(with_strips, rel=0.01)
    assert 1.0 - found[1] / plain == pytest.approx(1.0 - with_collar, rel=0.03)


@pytest.mark.slow
def test_a_diaphragm_stops_the_breathing_of_the_section() -> None:
    """Reference: analytic. A tensioned plate is a hundred times as stiff as walls."""
    rows = []
    for plates in ((), (Diaphragm(5.0, 0.008),)):
        shell = shell_of(diaphragms=plates)
        rows.append(compliance(shell, shell.outline(5.0).distortion()))
    stretched = BOX.height / (STEEL.youngs_modulus * 0.008 * BOX.width)
    assert rows[0] > 100.0 * rows[1]
    assert rows[1] < stretched


def short_box(comm: MPI.Comm, size: float) -> SegmentShell:
    """Return a box in a collar, so short that the partition divides its diaphragms."""
    plates = tuple(Diaphragm(x, 0.008) for x in (0.0, 0.1, 0.2, 0.3))
    collar = Collar((0.0, 0.3), 0.007)
    segment = replace(box_segment("box", 0.0, 0.3, BOX), diaphragms=plates, collars=(collar,))
    return assemble_segment(comm, segment, meshed(segment, size) if comm.rank == 0 else None)

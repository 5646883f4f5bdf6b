# SPDX-License-Identifier: LGPL-3.0-or-later
"""Telescoping shells: rows and springs at extensions, and motion compared with beams."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.linalg import eigh

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.dynamics.motion_laws import SCurve, Stroke
from protractile.geometry.arrays import Array
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom
from protractile.geometry.joint import Drive
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.contact.local_compliance import compliance, local_compliance
from protractile.shell_model.reduced_shell import ReducedShell
from protractile.shell_model.telescoping import squared
from tests.shell_model.booms import boom_in_space, flat_boom, reduce_quickly, three_segments
from tests.touching import touching

LAW = PowerContact(1.0e8, 1.0).with_clearance(7.0e-3)
DRIVE = Drive(SCurve(2.0, 1.0), ("inner", "outer"))
SIZE = 0.25


def telescope(way: float, drive: Drive | None = None, boom: Boom | None = None) -> Boom:
    """Return the paper's boom with an overlap of 4 m less an extension in m.

    Without dashpots contacts are chaotic, and runs diverge.
    """
    boom = boom or flat_boom()
    outer, inner = boom.segments
    inner = replace(inner, start=6.0 + way, end=16.0 + way)
    own = {"stations": (inner.start, outer.end), "contact_length": SIZE, "dashpot": 3.0e3}
    joint = replace(boom.joints[0], drive=drive, **own)
    return replace(boom, segments=(outer, inner), joints=(joint,))


@cache
def shell(boom: Boom, size: float = SIZE) -> ReducedShell:
    return reduce_quickly(touching(boom, LAW, LAW), ShellOptions(size))


def at_rest(system: GapSystem, *names: str) -> list[float]:
    position = equilibrium(system, system.load)
    return [float(system.observers[name].row @ position) for name in names]


def local(system: GapSystem) -> Array:
    """Return the local compliance (num_rows,) in m/N."""
    whole = compliance(system.omega2, system.rows)
    return local_compliance(whole, system.laws, system.station_of_row.tolist())


def standing(system: GapSystem, way: float) -> GapSystem:
    """Return the shell at its position after an extension by its drive in m."""
    (travel,) = system.travels
    times = np.linspace(0.0, 1.0, 20001)
    return system.at_time(float(np.interp(way, travel.history(times), times)))


@pytest.mark.slow
def test_shell_at_an_extension_equals_a_shell_built_there() -> None:
    """Reference: other code path, the shell reduced at this extension with the same mesh lines."""
    made = shell(telescope(0.0, DRIVE))
    assert 1.0e-4 < made.errors["contact_compliance"] < 0.01
    assert made.errors["deflections"] < 0.02
    here, there = standing(made.system, 2.0), shell(telescope(2.0)).system
    assert at_rest(here, "tip") == pytest.approx(at_rest(there, "tip"), rel=1e-6)
    assert local(here) == pytest.approx(local(there), rel=1e-4)
    # Springs give way by a good part of that.
    modes = here.omega2 < squared(1000.0)
    whole = compliance(here.omega2[modes], here.rows[:, modes])
    without = local_compliance(whole, here.laws, here.station_of_row.tolist())
    assert (without < 0.9 * local(there)).all()


@pytest.mark.slow
def test_pads_of_a_boom_in_space_on_the_way() -> None:
    """Reference: other code path, the shell reduced there: statics and compliances."""

    boom = boom_in_space(friction=0.2, sideways=0.3)
    here = shell(telescope(0.0, DRIVE, boom), 1.0).system.at_time(1.0)
    there = shell(telescope(2.0, None, boom), 1.0).system
    names = "tip", "tip_lateral", "head", "head_lateral"
    assert at_rest(here, *names) == pytest.approx(at_rest(there, *names), rel=1e-6)
    for kind in ("rows", "friction_rows"):
        found, expected = (compliance(one.omega2, getattr(one, kind)) for one in (here, there))
        assert found == pytest.approx(expected, rel=1e-5, abs=1e-6 * expected.max())


def drawn(first: float, second: float, drives: Sequence[Drive | None]) -> Boom:
    """Return a boom of three with overlaps of 3 m less extensions in m."""
    boom = three_segments()
    outer, middle, last = boom.segments
    middle = replace(middle, start=7.0 + first, end=14.0 + first)
    last = replace(last, start=11.0 + first + second, end=17.0 + first + second)
    stations = (middle.start, outer.end), (last.start, middle.end)
    joints = tuple(
        replace(joint, drive=drive, stations=at, contact_length=0.5, dashpot=3.0e3)
        for joint, drive, at in zip(boom.joints, drives, stations, strict=True)
    )
    return replace(boom, segments=(outer, middle, last), joints=joints)


@pytest.mark.slow
def test_two_joints_on_the_way() -> None:
    """Reference: other code path, the shell reduced there."""
    drives = DRIVE, Drive(SCurve(1.0, 0.5), DRIVE.carriers)
    here = shell(drawn(0.0, 0.0, drives), 0.5).system.at_time(1.0)
    there = shell(drawn(2.0, 1.0, (None, None)), 0.5).system
    names = "tip", "head", "head-2"
    assert at_rest(here, *names) == pytest.approx(at_rest(there, *names), rel=1e-6)
    assert local(here) == pytest.approx(local(there), rel=1e-4)


@pytest.mark.slow
def test_no_ring_of_the_mesh_is_felt() -> None:
    """Reference: analytic, the lever rule. Between lines compliances are linear to 0.1 %."""
    ways = np.linspace(0.5, 2.0, 25)
    stands = [standing(shell(telescope(0.0, DRIVE)).system, way) for way in ways]
    gaps = np.array([system.rows @ equilibrium(system, system.load) for system in stands])
    laws = stands[0].laws
    forces = np.array([[law.force(y) for law, y in zip(laws, row, strict=True)] for row in gaps])
    weight = 55.07 * 10.0
    head, tail = forces[:, 2:].sum(axis=1), forces[:, :2].sum(axis=1)
    assert head + tail == pytest.approx(weight, rel=1e-6)
    assert head == pytest.approx(weight * 5.0 / (4.0 - ways), rel=1e-6)
    between = np.array([local(system) for system in stands])
    line = 0.5 * (between[:-2] + between[2:])
    assert np.abs(between[1:-1] / line - 1.0).max() < 1.0e-3


@pytest.mark.slow
def test_a_moving_shell_is_near_its_beam() -> None:
    """Reference: other code, beams; analytic, the energy balance."""
    boom = touching(telescope(0.0, DRIVE), LAW)
    beam = gap_system(boom, finite_element_segments(boom, 0.5, "timoshenko", True))
    made = shell(telescope(0.0, DRIVE)).system
    runs = [FixedStep(1.0e-5)(Motion(one, 0.5)) for one in (beam, made)]
    assert max(run.energy_residual for run in runs) < 1.0e-4
    tips = [run.data["tip"].values for run in runs]
    assert np.abs(tips[0] - tips[1]).max() < 0.02 * np.ptp(tips[1])
    works = [float(run.data["drive_work"][-1]) for run in runs]
    assert works[0] == pytest.approx(works[1], rel=0.01)
    assert abs(works[1]) > 0.01 * float(np.abs(runs[1].data["work"]).max())


def told(system: GapSystem) -> Array:
    """Return static tip and head, and three frequencies with springs as contacts (5,)."""
    stiffness = system.stiffness + 1.0e8 * system.rows.T @ system.rows
    squares = eigh(stiffness, eigvals_only=True, subset_by_index=[0, 2])
    return np.array([*at_rest(system, "tip", "head"), *np.sqrt(squares)])


@pytest.mark.slow
def test_shell_with_axial_forces_equals_a_shell_built_there() -> None:
    """Reference: other code path, the shell reduced there; analytic, the energy balance."""

    def reduced(way: float, drive: Drive | None = None) -> GapSystem:
        free = telescope(way, drive)
        ropes = [Thrust(1, free.tip, 1.0e5)]
        segments = with_compression(free.segments, free.joints, ropes, gravity=8.0)
        return shell(replace(free, segments=segments), 0.3).system

    system = reduced(0.0, Drive(Stroke(2.0, 4.0, 0.1), DRIVE.carriers))
    here, there = standing(system, 2.0), told(reduced(2.0))
    assert told(here) == pytest.approx(there, rel=1e-4)
    # Without the force that goes along it rests and swings by several times that elsewhere.
    plain = replace(here, geometric_stiffness=np.zeros((0, 0)))
    assert (np.abs(told(plain)[:4] / there[:4] - 1.0) > 5.0e-4).all()
    run = FixedStep(1.0e-5)(Motion(system, 0.6, 1.0e-2))
    assert run.energy_residual < 1.0e-4
    assert abs(float(run.data["drive_work"][-1])) > 0.01 * float(np.abs(run.data["work"]).max())

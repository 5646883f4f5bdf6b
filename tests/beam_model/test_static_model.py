# SPDX-License-Identifier: LGPL-3.0-or-later
"""Models that are kept while the shape of a boom does not change."""

from collections.abc import Callable
from dataclasses import replace
from math import radians

import numpy as np
import pytest

from protractile.beam_model import static_model
from protractile.beam_model.boom_modes import BoomModes, critical_factor
from protractile.beam_model.lines import lines_of_modes
from protractile.beam_model.static_model import StaticModel
from protractile.beam_model.statics import Elements, loaded_system
from protractile.beam_model.wall_compliance import station_compliance
from protractile.dynamics.damping import closed_stiffness
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.stability import closing_loads
from protractile.geometry.axial import Lead, Thrust, with_compression
from protractile.geometry.boom import Boom, Cylinder, Joint, Material, Pad, PointMass, Segment
from protractile.geometry.box import BoxSection
from protractile.geometry.compression import NO_COMPRESSION
from protractile.geometry.load import Load
from protractile.geometry.support import Support

STEEL = Material(2.1e11, 0.3, 7850.0)
FOOT = Support(0.0, "hinged", depth=0.2)


def crane(
    angle: float, mass: float = 300.0, thrust: float = 2.0e4, lateral: float | None = None
) -> Boom:
    """Return a luffed boom of two boxes on a cylinder, under its weight and a payload."""
    outer, inner = BoxSection(0.50, 0.40, 0.010, 0.008), BoxSection(0.45, 0.35, 0.008, 0.006)
    along, across = 9.81 * np.sin(radians(angle)), 9.81 * np.cos(radians(angle))
    segments = (
        Segment.of_section("base", 0.0, 8.0, STEEL, outer, supports=(FOOT,), load=-800.0 * across),
        Segment.of_section(
            "fly", 6.0, 14.0, STEEL, inner, load=-50.0 * across, masses=(PointMass(14.0, mass),)
        ),
    )
    if lateral is None:
        segments = tuple(replace(one, lateral=None) for one in segments)
    pad = Pad(length=0.1, width=0.08, thickness=0.02, modulus=2e9)
    joint = Joint(0, 1, (6.0, 8.0), 0.010, pad=pad, lateral_play=lateral)
    jack = Cylinder(0, 3.0, 0.4, ground=(1.0, -2.0), stiffness=5e7)
    jack = jack.on_earth(0.0, FOOT).in_boom_axes(radians(angle), FOOT)
    if lateral is not None:
        jack = replace(jack, spread=0.5)
    compressed = with_compression(segments, (joint,), [Thrust(1, 14.0, thrust)], along)
    loads = [Load(1, "z", -mass * across, 14.0, Step())]
    return Boom(compressed, (joint,), loads, cylinders=(jack,))


def by_data(angle: float) -> Boom:
    """Return the crane with a cylinder whose stiffness follows from its data and its length."""
    boom = crane(angle)
    (jack,) = boom.cylinders
    data = {"closed": 2.0, "open": 4.6, "bore": 0.2, "rod": 0.14, "pressure": 2.5e7}
    return replace(boom, cylinders=(replace(jack, stiffness=None, **data),))


CRANES: dict[str, Callable[[], Boom]] = {
    "level": lambda: crane(0.0),
    "luffed": lambda: crane(60.0),
    "heavier": lambda: crane(60.0, mass=900.0, thrust=5.0e4),
    "unloaded": lambda: crane(30.0, mass=300.0, thrust=0.0),
    "with a lead": lambda: replace(crane(50.0), leads=(Lead(1, 14.0, 2.0e4, -2.0),)),
    "on a long cylinder": lambda: by_data(60.0),
    "on a short cylinder": lambda: by_data(10.0),
    "in space": lambda: crane(45.0, lateral=0.006),
}


@pytest.mark.parametrize("name", CRANES)
def test_a_kept_model_has_the_states_of_a_new_one(name: str) -> None:
    """Reference: other code, modes of the boom with its masses and axial forces.

    The round-off of these modes is 1e-8.
    """
    boom = CRANES[name]()
    modes = BoomModes(boom, Elements(boom, 20).segments)
    system = loaded_system(boom, modes)
    kept, lines = StaticModel.of(boom).loaded(boom)
    position, other = (equilibrium(one, one.load) for one in (kept, system))
    for output, observer in system.observers.items():
        expected = observer.row @ other
        size = 1e-7 * np.linalg.norm(observer.row) * np.linalg.norm(other)
        assert kept.observers[output].row @ position == pytest.approx(expected, rel=1e-7, abs=size)
    for line, reference in zip(lines, lines_of_modes(boom, modes), strict=True):
        forces, expected_forces = line.read(position), reference.read(other)
        # Lateral forces without a lateral load are the round-off of those in the plane.
        round_off = 1e-13 * np.abs(expected_forces["moment"]).max()
        for quantity, values in expected_forces.items():
            near = 1e-7 * np.abs(values).max() + round_off
            np.testing.assert_allclose(forces[quantity], values, rtol=1e-7, atol=near)


@pytest.mark.parametrize("name", CRANES)
def test_a_kept_model_has_the_buckling_factor_of_a_new_one(name: str) -> None:
    """Reference: other code, the groups of bonded components in their own unknowns."""
    boom = CRANES[name]()
    unloaded = replace(
        boom,
        segments=[replace(one, compression=NO_COMPRESSION) for one in boom.segments],
        leads=(),
    )
    system = loaded_system(unloaded, BoomModes(unloaded, Elements(unloaded, 20).segments))
    models = Elements(boom, 20).segments
    factors = []
    for load in closing_loads(system, system.load):
        stiffness = closed_stiffness(system, equilibrium(system, load))
        factors.append(critical_factor(boom, models, station_compliance(boom, stiffness)))
    expected = min(factor for factor in factors if factor is not None)
    assert StaticModel.of(boom).critical_factor(boom) == pytest.approx(expected, rel=1e-7)


def test_booms_of_one_shape_share_a_model() -> None:
    """Reference: the definition of a shape. A longer boom or a force elsewhere has another one."""
    static_model._kept.cache_clear()
    booms = [crane(angle, mass) for angle in (20.0, 50.0) for mass in (100.0, 200.0)]
    assert len({id(StaticModel.of(boom)) for boom in booms}) == 1
    (load,) = booms[0].loads
    other = replace(booms[0], loads=(replace(load, x=13.0),))
    assert StaticModel.of(other) is not StaticModel.of(booms[0])

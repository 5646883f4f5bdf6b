# SPDX-License-Identifier: LGPL-3.0-or-later
"""The shell in space: pads in the corners, lateral motion and twist, and no lateral play."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Joint, Load, Support
from protractile.geometry.box import BoxSection
from protractile.shell_model.boom_shell import ShellOptions
from studies import sections
from tests.shell_model.booms import (
    LATERAL_LAW,
    LAW,
    bonded_beams,
    boom_in_space,
    box_segment,
    flat_boom,
    reduce_quickly,
    reduced,
    rigid_state,
)

# σ in rad²/s² of the compliances that are compared: below and above the lowest ω².
SHIFTS = (10.0, 1.0e4, 1.0e6)


def _compliances(system: GapSystem, rows: Array) -> Array:
    """Return the compliance of rows (num_shifts, num_rows, num_rows)."""
    return np.array([rows @ (rows / (system.omega2 + sigma)).T for sigma in SHIFTS])


def _walls(system: GapSystem, direction: str) -> Array:
    """Return the mean rows (4, num_modes) of the two pads of each wall, station by station."""
    along = np.array(system.station_directions)[system.station_of_row] == direction
    return np.asarray(system.rows[along].reshape(4, 2, -1).mean(axis=1))


def _differ(found: Array, expected: Array) -> float:
    errors, sizes = (np.abs(one).max(axis=(1, 2)) for one in (found - expected, expected))
    return float((errors / sizes).max())


@pytest.mark.slow
def test_a_boom_on_its_side_is_the_same_boom() -> None:
    """Reference: symmetry, exchanged directions: frequencies, compliances, loads, round-off."""
    octagons, law = sections.boom_of(*sections.SHAPES["octagon"]), sections.LAW
    segments = [
        replace(one, lateral=replace(one.lateral, load=0.3 * one.load)) for one in octagons.segments
    ]
    joint = replace(octagons.joints[0], lateral_play=2.0 * LATERAL_LAW.above)
    turned = replace(joint, play=joint.lateral_play, lateral_play=joint.play)
    upright = Boom(segments, (joint,))
    lying = Boom([segment.turned() for segment in segments], (turned,))
    first, second = (
        reduced(boom, 0.5, law=laws[0], lateral=laws[1]).system
        for boom, laws in ((upright, (law, LATERAL_LAW)), (lying, (LATERAL_LAW, law)))
    )
    assert second.frequencies == pytest.approx(first.frequencies, rel=1.0e-6, abs=1.0e-9)
    for one, other in (("z", "y"), ("y", "z")):
        expected = _compliances(first, _walls(first, one))
        assert _differ(_compliances(second, _walls(second, other)), expected) < 1.0e-6
    tips = [
        [system.observers[name].row @ (system.load / (system.omega2 + 10.0)) for name in names]
        for system, names in ((first, ("tip", "tip_lateral")), (second, ("tip_lateral", "tip")))
    ]
    assert tips[1] == pytest.approx(tips[0], rel=1.0e-9)


@pytest.mark.slow
def test_segments_rolling_together_keep_their_gaps() -> None:
    """Reference: analytic. By a roll φ, pads move by φ y, −φ z; (11): N of each pad's own row."""
    system = reduced(boom_in_space(friction=0.2), 0.5).system
    still = dict.fromkeys(("tip", "tail", "tip_lateral", "tail_lateral"), 0.0)
    state = rigid_state(system, still | {"tip_twist": 1.0e-3})
    outer, section = (segment.section for segment in flat_boom().segments)
    along_z = np.array(system.station_directions)[system.station_of_row] == "z"
    gaps = system.rows @ state
    assert np.abs(gaps[along_z]) == pytest.approx(0.5e-3 * section.width, rel=1.0e-9)
    assert np.abs(gaps[~along_z]) == pytest.approx(0.5e-3 * section.height, rel=1.0e-9)
    # A flange's pad slides sideways by its height: the outer one's inner face less the play.
    slides = system.friction_rows @ state
    arm = 0.5 * (outer.height - outer.flange) - LAW.above
    assert np.abs(slides[along_z]) == pytest.approx(1.0e-3 * arm, rel=1.0e-9)
    found = [(one.normal_rows, one.normal_force, one.station) for one in system.frictions]
    assert found == [((row,), 0.0, at) for row, at in enumerate(system.station_of_row)]
    assert list(system.station_directions) == ["z", "z", "y", "y"]


@pytest.mark.slow
def test_the_bonded_boom_vibrates_as_beams_in_both_planes() -> None:
    """Reference: other code, bonded Timoshenko elements, 3 frequencies a plane, 0.7 %."""
    boom = boom_in_space()
    boom = replace(boom, joints=(replace(boom.joints[0], bonded=True),))
    expected = bonded_beams(boom, 0.5).frequencies[:6]
    assert reduced(boom, 0.5).system.frequencies[:6] == pytest.approx(expected, rel=0.01)


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["beam", "shell"])
def test_square_boxes_move_alike_in_both_planes(kind: str) -> None:
    """Reference: analytic, the symmetry of a square. Before, 7.66 Hz laterally for 3.71 Hz."""
    base, fly = (BoxSection(size, size, wall, wall) for size, wall in ((0.3, 65e-4), (0.26, 6e-3)))
    segments = (
        box_segment("base", 0.0, 4.0, base, supports=(Support(0.0, "clamped"),)),
        box_segment("fly", 3.0, 7.0, fly),
    )
    law = PowerContact(1.0e6 if kind == "beam" else 1.0e8, 1.0)
    joint = Joint(0, 1, (3.0, 4.0), 0.0, lateral_play=0.0, contact=law, lateral_contact=law)
    boom = Boom(segments, (joint,), (Load(1, "z", -100.0, 7.0, Step()),))
    if kind == "beam":
        system = gap_system(boom, finite_element_segments(boom, 0.5, "timoshenko", True))
    else:
        system = reduce_quickly(boom, ShellOptions(mesh_size=0.15)).system
    rest = equilibrium(system, system.gather_loads().load)
    first, second = closed_contact_modes(system, rest)[0][:2]
    assert first == pytest.approx(second, rel=1e-6 if kind == "beam" else 1e-3)

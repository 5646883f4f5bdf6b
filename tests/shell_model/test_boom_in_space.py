# SPDX-License-Identifier: LGPL-3.0-or-later
"""The shell in space: pads in the corners, lateral motion and twist, and no lateral play."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import AdaptiveStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, BoomError
from protractile.runs.case.reading import check_tables
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import reduce_boom
from studies import sections
from tests.runs.case_texts import CLAMPED, STEEL, box, elements, joint, table
from tests.shell_model.booms import (
    LATERAL_LAW,
    LAW,
    bonded_beams,
    boom_in_space,
    flat_boom,
    reduced,
)

# σ in rad²/s² of the compliances that are compared: below and above the lowest ω².
SHIFTS = (10.0, 1.0e4, 1.0e6)


def _compliance(system: GapSystem, rows: Array, sigma: float) -> Array:
    return np.asarray(rows @ (rows / (system.omega2 + sigma)).T)


def _walls(system: GapSystem, direction: str) -> Array:
    """Return the mean rows (4, num_modes) of the two pads of each wall, station by station."""
    along = np.array(system.station_directions)[system.station_of_row] == direction
    return np.asarray(system.rows[along].reshape(4, 2, -1).mean(axis=1))


def _differ(found: Array, expected: Array) -> float:
    return float(np.abs(found - expected).max() / np.abs(expected).max())


@pytest.mark.slow
def test_without_lateral_load_the_boom_moves_as_the_flat_one() -> None:
    """Reference: the flat shell. Compliances, and the motion until the first contact, agree within
    1e-9; then within 1 %.
    """
    flat, space = (reduced(one, 0.5, moments=2).system for one in (flat_boom(), boom_in_space()))
    for sigma in SHIFTS:
        expected = _compliance(flat, flat.rows, sigma)
        assert _differ(_compliance(space, _walls(space, "z"), sigma), expected) < 1.0e-9
    motions = [
        AdaptiveStep()(Motion(system, 0.2, output_step=0.01)).data for system in (flat, space)
    ]
    tips = [motion["tip"].values for motion in motions]
    early = motions[0]["time"].values < 0.115
    assert _differ(tips[1][early], tips[0][early]) < 1.0e-9
    assert _differ(tips[1], tips[0]) < 0.01
    sideways = np.abs(motions[1]["tip_lateral"].values).max()
    assert sideways < 1.0e-9 * np.abs(tips[1]).max()


@pytest.mark.slow
def test_a_boom_on_its_side_is_the_same_boom() -> None:
    """Reference: symmetry, exchanged directions: frequencies, compliances, loads, round-off."""
    boom, law = sections.boom_of(*sections.SHAPES["octagon"]), sections.LAW
    segments = tuple(
        replace(s, lateral=replace(s.lateral, load=0.3 * s.load)) for s in boom.segments
    )
    joint = replace(boom.joints[0], lateral_play=2.0 * LATERAL_LAW.above)
    upright = replace(boom, segments=segments, joints=(joint,))
    lying = Boom(
        tuple(segment.turned() for segment in upright.segments),
        (replace(joint, play=joint.lateral_play, lateral_play=joint.play),),
    )
    first, second = (
        reduced(boom, 0.5, law=laws[0], lateral=laws[1]).system
        for boom, laws in ((upright, (law, LATERAL_LAW)), (lying, (LATERAL_LAW, law)))
    )
    assert second.frequencies == pytest.approx(first.frequencies, rel=1.0e-6, abs=1.0e-9)
    for one, other in (("z", "y"), ("y", "z")):
        for sigma in SHIFTS:
            expected = _compliance(first, _walls(first, one), sigma)
            assert _differ(_compliance(second, _walls(second, other), sigma), expected) < 1.0e-6
    tips = [
        [system.observers[name].row @ (system.load / (system.omega2 + 10.0)) for name in names]
        for system, names in ((first, ("tip", "tip_lateral")), (second, ("tip_lateral", "tip")))
    ]
    assert tips[1] == pytest.approx(tips[0], rel=1.0e-9)


@pytest.mark.slow
def test_segments_rolling_together_keep_their_gaps() -> None:
    """Reference: analytic. Under a rotation φ, flange pads move by φ y and web pads by −φ z. (11):
    each pad's contact row gives N for its friction.
    """
    system = reduced(boom_in_space(friction=0.2), 0.5).system
    rigid = np.flatnonzero(system.omega2 == 0.0)
    names = ("tip", "tail", "tip_lateral", "tail_lateral", "tip_twist")
    rows = np.array([system.observers[name].row[rigid] for name in names])
    state = np.zeros(system.num_modes)
    state[rigid] = np.linalg.solve(rows, [0.0, 0.0, 0.0, 0.0, 1.0e-3])
    section = flat_boom().segments[1].section
    outer = flat_boom().segments[0].section
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
    stiffness = np.zeros((4, 2))
    for law, station in zip(system.laws, system.station_of_row, strict=True):
        for term in law.terms:
            stiffness[station, int(term.side > 0.0)] += term.stiffness
    assert stiffness == pytest.approx(1.0e13)


@pytest.mark.slow
def test_the_bonded_boom_vibrates_as_beams_in_both_planes() -> None:
    """Reference: other code, bonded Timoshenko elements, 3 frequencies a plane, 0.7 %."""
    boom = boom_in_space()
    boom = replace(boom, joints=(replace(boom.joints[0], bonded=True),))
    expected = bonded_beams(boom, 0.5).frequencies[:6]
    assert reduced(boom, 0.5).system.frequencies[:6] == pytest.approx(expected, rel=0.01)


def test_contact_across_the_flanges_is_for_flat_booms() -> None:
    message = (
        "contact_line: 'across' spreads the force over the flanges of a flat boom; in space the "
        "pads sit in the corners: give 'near webs' or 'surface'"
    )
    with pytest.raises(BoomError, match=f"^{message}$"):
        reduced(boom_in_space(), 0.5, "across")


SQUARES = 0.3, 0.26


def boom_of(stiffness: float) -> Boom:
    """Return a boom of two square boxes without play, which a vertical load at the tip presses."""
    outer, inner = ((size, size, 0.0065 - 0.0005 * i, 0.0065 - 0.0005 * i)
                    for i, size in enumerate(SQUARES))  # fmt: skip
    ends = f"lateral_play = 0.0\nstiffness = {stiffness}"
    text = 'title = "square boxes"\ntime = { duration = 0.05 }\n' + STEEL
    text += box("base", (0.0, 4.0), outer, CLAMPED) + box("fly", (3.0, 7.0), inner)
    text += joint("fly", "base", 0.0, (3.0, 4.0), ends) + elements("beam")
    text += table("[[load]]", segment="fly", x="head", magnitude=-100.0)
    return check_tables(tomllib.loads(text), "boom").boom


def first_pair(system: GapSystem) -> tuple[float, float]:
    """Return the first two frequencies in Hz at rest under the loads."""
    load = system.load + np.sum([one.load for one in system.excitations], axis=0)
    first, second = closed_contact_modes(system, equilibrium(system, load))[0][:2]
    return float(first) / (2.0 * np.pi), float(second) / (2.0 * np.pi)


def test_a_beam_moves_alike_in_both_planes() -> None:
    """Reference: analytic, the symmetry of a square; before, 7.66 Hz laterally for 3.71 Hz."""
    models = finite_element_segments(boom := boom_of(1.0e6), 0.5, "timoshenko", rotary_inertia=True)
    first, second = first_pair(gap_system(boom, models))
    assert first == pytest.approx(second, rel=1e-6)


@pytest.mark.slow
def test_a_shell_moves_alike_in_both_planes() -> None:
    """Reference: analytic, the symmetry of a square; before, the lateral one was 27 % lower."""
    shell = reduce_boom(boom_of(1.0e8), ShellOptions(mesh_size=0.15), MPI.COMM_SELF)
    first, second = first_pair(shell.system)
    assert first == pytest.approx(second, rel=1e-3)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom of shells as a gap system: rows of joints, stops, loads and ties; observers."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.excitation import Ramp, Step
from protractile.dynamics.integrator import AdaptiveStep
from protractile.dynamics.motion import Motion
from protractile.geometry.boom import Boom, BoomError, Load, Stop
from protractile.geometry.contact_places import ContactLine
from protractile.geometry.observation import Observation
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.segment.cross_section import Operator, Row
from studies.reference_models.statics import static_response
from tests.shell_model.booms import (
    LAW,
    assert_rests_as_beams,
    bonded_beams,
    flat_boom,
    pressed_rest,
    reduced,
    three_segments,
)
from tests.touching import touching

DASHPOT = 2.0e3


def _dragged(boom: Boom) -> Boom:
    """Return the boom with a dashpot at each station."""
    return replace(boom, joints=(replace(boom.joints[0], dashpot=DASHPOT),))


@pytest.mark.slow
@pytest.mark.parametrize("line", ["near webs", "across"])
def test_a_station_slides_as_the_mean_of_its_contact_rows(line: ContactLine) -> None:
    """Reference: analytic, one top and one bottom row; points with their weights."""
    system = reduced(flat_boom(friction=0.2), 0.5, line).system
    assert system.num_modes == reduced(flat_boom(), 0.5, line).system.num_modes
    assert [(f.station, f.normal_force) for f in system.frictions] == [(0, 4500.0), (1, 5000.0)]
    assert all(f == DryFriction(0.2, f.station, f.normal_force) for f in system.frictions)
    for station, row in enumerate(system.friction_rows):
        mine = system.station_of_row == station
        stiffness = [w.terms[0].stiffness for w, at in zip(system.laws, mine, strict=True) if at]
        mean = np.average(system.rows[mine], axis=0, weights=stiffness)
        assert row == pytest.approx(mean, rel=1.0e-9, abs=1.0e-12)


@pytest.mark.slow
@pytest.mark.parametrize("line", ["near webs", "across"])
def test_a_dashpot_resists_the_mean_of_its_stations_contact_rows(line: ContactLine) -> None:
    """Reference: analytic, √c times the friction row, without additional coordinates."""
    system = reduced(_dragged(flat_boom(friction=0.2)), 0.5, line).system
    assert system.num_modes == reduced(flat_boom(), 0.5, line).system.num_modes
    expected = np.sqrt(DASHPOT) * system.friction_rows
    np.testing.assert_allclose(system.dashpots, expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.slow
@pytest.mark.parametrize("line", ["near webs", "surface"])
def test_dashpots_dissipate_equally_in_shells_and_beams(line: ContactLine) -> None:
    """Reference: other code, Timoshenko elements, with differences of 0.2 and 1.4 % over 0.4 s."""
    boom = _dragged(flat_boom())
    models = finite_element_segments(boom, 0.25, "timoshenko", rotary_inertia=True)
    beam, shell = (
        AdaptiveStep()(Motion(system, 0.4))
        for system in (gap_system(touching(boom, LAW), models), reduced(boom, 0.5, line).system)
    )
    taken, expected = (float(run.data["damping_loss"][-1]) for run in (shell, beam))
    assert expected > 0.02 * float(beam.data["work"][-1])
    assert beam.first_contact < 0.3
    assert taken == pytest.approx(expected, rel=0.03)


@pytest.mark.slow
def test_loads_act_at_their_positions_and_times() -> None:
    """Reference: analytic, force over mass of a free segment; uniform is constant load."""
    boom = flat_boom()
    ramp = Ramp(0.1)
    loads = (Load(1, "z", 55.07, None, Step()), Load(1, "z", 100.0, 14.0, ramp))
    system = reduced(replace(boom, loads=loads), 0.5).system
    uniform, point = (excitation.load for excitation in system.excitations)
    assert system.excitations[1].history is ramp
    free = system.omega2 == 0.0
    inner = system.load.copy()
    inner[: np.flatnonzero(free)[0]] = 0.0
    assert uniform == pytest.approx(inner, rel=1.0e-9, abs=1.0e-12 * np.abs(inner).max())
    tip, tail = (system.observers[name].row[free] for name in ("tip", "tail"))
    mass = boom.segments[1].mass_per_length * boom.segments[1].length
    assert 0.5 * (tip + tail) @ point[free] == pytest.approx(100.0 / mass, rel=1.0e-9)


def test_operators_add_up_over_all_segments() -> None:
    one, other = (
        Operator({0: Row({3: 1.0})}),
        Operator({0: Row({3: 0.5, 4: 2.0}), 1: Row({7: 1.0})}),
    )
    both = {0: {3: 1.5, 4: 2.0}, 1: {7: 1.0}}
    assert one + other == both
    assert other + one == both


def test_stop_reads_the_deflection_of_its_flange() -> None:
    """Reference: other code, beams. The one-sided row at 8 m is the deflection of the flange."""
    stop = Stop(0, 8.0, 0.02, PowerContact(0.0, 1.0, stiffness_below=1.0e8))
    system = reduced(replace(flat_boom(), stops=(stop,)), 0.5).system
    assert list(system.stations) == [9.0, 10.0, 8.0]
    assert system.station_of_row.tolist() == [0, 0, 1, 1, 2]
    assert system.laws[-1].terms == stop.law.terms
    rest = pressed_rest(system, system.station_of_row != 2)
    beams = bonded_beams(replace(flat_boom(), observations=(Observation("seat", 0, 8.0),)))
    expected = beams.observers["seat"].row @ static_response(beams, beams.load)
    assert system.rows[-1] @ rest == pytest.approx(expected, rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("boom", [flat_boom(), three_segments()], ids=["two", "three"])
def test_static_state_with_axial_forces_follows_beams(boom: Boom) -> None:
    """Reference: other code, bonded Timoshenko elements within 0.25 %. Shear contributes 3 %."""
    assert_rests_as_beams(reduced(boom, 0.25).system, boom, 5.0e-3)


@pytest.mark.slow
def test_a_bonded_joint_has_no_play() -> None:
    """Reference: other code, bonded Timoshenko elements within 0.2 %; no rigid motion."""
    boom = three_segments(bonded=True)
    shell = reduced(boom, 0.25)
    system, beams = shell.system, bonded_beams(boom)
    assert system.rows.shape == (0, system.num_modes)
    assert not (system.omega2 == 0.0).any()
    assert system.frequencies[0] == pytest.approx(beams.frequencies[0], rel=2.0e-3)
    rest, expected = (static_response(one, one.load) for one in (system, beams))
    tip = system.observers["tip"].row @ rest
    assert tip == pytest.approx(beams.observers["tip"].row @ expected, rel=2.0e-3)
    # The pictures' modes are those of the coordinates.
    moved = np.tensordot(rest, shell.fields["modes"].values, axes=1)
    at_tip = np.abs(shell.fields["points"].values[:, 0] - boom.tip) < 1.0e-9
    assert moved[at_tip, 2].mean() == pytest.approx(tip, rel=1.0e-3)


@pytest.mark.slow
@pytest.mark.parametrize("line", ["near webs", "across"])
def test_a_uniform_approach_gives_the_law_of_the_paper_exactly(line: ContactLine) -> None:
    """Reference: analytic. Under a rigid translation each station has F(y) of (4) once."""
    system = reduced(flat_boom(), 0.25, line, moments=2).system
    rigid = np.flatnonzero(system.omega2 == 0.0)
    tip, tail = (system.observers[name].row for name in ("tip", "tail"))
    for lift in (7.3e-3, -7.3e-3):
        state = np.zeros(system.num_modes)
        state[rigid] = np.linalg.solve(np.array([tip[rigid], tail[rigid]]), [lift, lift])
        gaps = system.rows @ state
        assert gaps == pytest.approx(np.full(gaps.size, lift), rel=1.0e-9)
        forces = np.array([float(w.force(y)) for w, y in zip(system.laws, gaps, strict=True)])
        for station in (0, 1):
            total = forces[system.station_of_row == station].sum()
            assert total == pytest.approx(np.sign(lift) * 1.0e13 * 0.3e-3**2, rel=1.0e-9)


@pytest.mark.slow
def test_first_contact_follows_the_beam() -> None:
    """Reference: other code, beams: 0.1195 s; shear and distortion delay it by less than 1 %."""
    trajectory = AdaptiveStep()(Motion(reduced(flat_boom(), 0.25, moments=2).system, 0.4))
    assert trajectory.first_contact == pytest.approx(0.1195, rel=0.01)
    assert trajectory.energy_residual < 1.0e-4
    assert float(trajectory.data["contact_force"].sel(station=10.0).max()) > 0.0
    assert trajectory.data["tip_rotation"].attrs["units"] == "rad"


def test_a_shell_needs_a_section() -> None:
    boom = flat_boom()
    bare = replace(boom, segments=(replace(boom.segments[0], section=None), boom.segments[1]))
    message = (
        r"segments\[0\].section: 'outer' has no box section, which a shell needs; give "
        "height_to_width or section"
    )
    with pytest.raises(BoomError, match=message):
        reduced(bare, 0.5)


def test_a_side_without_stiffness_never_touches() -> None:
    """A station with contact above only has a single one-sided row."""
    law = replace(LAW.law, stiffness_below=0.0).with_clearance(LAW.above)
    system = reduced(flat_boom(), 0.5, law=law).system
    assert system.station_of_row.tolist() == [0, 1]
    assert all(row.one_sided(-1) is None for row in system.laws)


def test_a_segment_without_load_is_reduced_like_any_other() -> None:
    """Its zero input must not affect the error of its contact points."""
    boom = flat_boom()
    bare = replace(boom, segments=(boom.segments[0], replace(boom.segments[1], load=0.0)))
    options = ShellOptions(0.5, krylov=KrylovOptions(shifts=(5.0, 300.0), moments=1))
    error, expected = (
        reduce_boom(touching(one, LAW), options, MPI.COMM_WORLD).errors["contact_compliance"]
        for one in (bare, boom)
    )
    assert error == pytest.approx(expected, rel=1e-6)
    assert error > 1.0e-9

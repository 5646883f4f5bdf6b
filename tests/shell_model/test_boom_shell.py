# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom of shells as a gap system: contact rows, their weights and sides, observers."""

from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.dynamics.integrator import AdaptiveStep
from protractile.dynamics.motion import Motion
from protractile.geometry.boom import BoomError
from protractile.geometry.contact_places import ContactLine
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.reduction.krylov import KrylovOptions
from tests.shell_model.booms import LAW, flat_boom
from tests.shell_model.models import reduced
from tests.touching import touching


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

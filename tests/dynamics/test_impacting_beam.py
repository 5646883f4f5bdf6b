# SPDX-License-Identifier: LGPL-3.0-or-later
"""A ball that falls on the tip of a cantilever, as in the tutorials of Siconos."""

import numpy as np
import pytest

from dynamics.contact import PowerContact
from dynamics.integrator import FixedStep
from studies.reference_models.impacting_beam import ELEMENTS, HEIGHT, falling, moreau_jean
from tests.dynamics.reference import errors_in_the_step, runge_kutta, slopes


def test_a_ball_rides_on_a_cantilever() -> None:
    """Reference: other code, the scheme and the data of Siconos' ImpactingEulerBernouilliBeam, in
    steps of 20 µs. A stiff contact with much damping stands for the restitution 0; both chatter,
    and so does the time at which the ball leaves, after 50 ms."""
    stop = PowerContact(1.0e7, 1.0, damping=5.0).lower().behind(HEIGHT)
    run = FixedStep(1e-4)(falling(ELEMENTS, stop, 0.06))
    expected = moreau_jean(2e-5)[::50] - [HEIGHT, 0.0]
    found = np.column_stack([run.data["ball"], run.data["tip"]])
    assert np.abs(found - expected).max() < 0.03 * np.ptp(expected[:, 1])
    assert run.data.attrs["contact_changes"] > 10


def test_blows_of_a_coarse_cantilever() -> None:
    """Reference: other code, scipy's DOP853 with the same contact, through its blows."""
    motion = falling(2, PowerContact(1.0e6, 1.0).lower().behind(HEIGHT), 0.03)
    expected = runge_kutta(motion, 2e-5)
    errors = errors_in_the_step(motion, expected, 4e-5 * 0.5 ** np.arange(4))
    assert FixedStep(5e-6)(motion).data.attrs["contact_changes"] >= 6
    assert slopes(errors)[1:] == pytest.approx(2.0, abs=0.2)
    assert errors[-1] < 2e-5

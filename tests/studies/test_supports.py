# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms on hinges, cylinders, springs and dashpots against closed forms."""

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from studies import supports
from studies.supports import first_frequency, lever, study


@pytest.mark.slow
def test_every_value_meets_its_reference() -> None:
    verifications = study(lambda what: None).verifications
    assert [verification.what for verification in verifications if not verification.holds] == []


def test_the_closed_forms_have_their_limits() -> None:
    """Reference: analytic, a rigid boom on a spring, a cantilever on one (Blevins 1979)."""
    segment = supports._segment()
    mass = segment.mass_per_length * segment.length**3 / 3.0
    soft = np.sqrt(1.0e3 / mass) / (2.0 * np.pi)
    assert first_frequency(segment, 1.0e3) == pytest.approx(soft, rel=1e-4)
    rate = np.sqrt(segment.bending_stiffness / segment.mass_per_length) / (2.0 * np.pi)
    stiff = (1.875104068711961 / segment.length) ** 2 * rate
    assert first_frequency(segment, 1.0e14) == pytest.approx(stiff, rel=1e-5)
    through = supports.Cylinder(0, x=2.0, depth=0.4, ground=(1.0, -0.2), stiffness=1.0)
    assert lever(through) == pytest.approx(0.0, abs=1e-12)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Kinked histories against closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from dynamics.excitation import Table
from studies.histories import response


@pytest.mark.parametrize("omega", [0.0, 3.0])
def test_the_closed_form_is_duhamel_s_integral(omega: float) -> None:
    """Reference: other code, scipy's quadrature of ∫ g(s) sin(ω (t − s))/ω ds."""
    table = Table((0.2, 0.5, 1.1), (0.4, -1.0, 2.0))
    (found,) = response(omega, table, np.array([1.7]))
    expected, _ = quad(
        lambda s: float(table(np.array(s))) * (1.7 - s) * np.sinc(omega * (1.7 - s) / np.pi),
        0.0,
        1.7,
        points=[0.2, 0.5, 1.1],
    )
    assert found == pytest.approx(expected, rel=1e-10)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is to be computed is whole before anything moves."""

import re
from typing import Any

import numpy as np
import pytest

from dynamics.motion import Motion
from tests.dynamics.two_stops import CHAOTIC


def test_rests_unless_told() -> None:
    motion = Motion(CHAOTIC, 1.0, 0.3)
    assert motion.from_rest
    assert motion.outputs == 3
    assert not Motion(CHAOTIC, 1.0, velocity=np.ones(2)).from_rest
    assert Motion(CHAOTIC, 1.0e-3, 1.0).outputs == 1


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"duration": 0.0}, "duration must be finite and positive, got 0.0 s"),
        ({"output_step": -1.0}, "output_step must be finite and positive, got -1.0 s"),
        ({"position": np.ones(3)}, "position must have the shape (2,), got (3,)"),
        ({"velocity": np.array([0.0, np.nan])}, "velocity must be finite"),
    ],
)
def test_bad_motions_are_refused(given: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(message)}$"):
        Motion(CHAOTIC, **{"duration": 1.0, **given})

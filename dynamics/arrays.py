# SPDX-License-Identifier: LGPL-3.0-or-later
"""Array types for annotations, and checks of numbers from Python.

``geometry`` is independent of this package and has its own.
"""

import math
from collections.abc import Sequence
from numbers import Real
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]


def is_finite(value: Any) -> bool:
    """Return whether a value is a number that a float can hold."""
    try:
        return isinstance(value, Real) and math.isfinite(value)
    except OverflowError:
        return False


def are_finite(values: Any) -> bool:
    """Return whether values are a sequence of such numbers."""
    return isinstance(values, Sequence | np.ndarray) and all(map(is_finite, values))


def check_positive(name: str, value: float, unit: str) -> None:
    """Check that an argument is a finite number above 0.

    Raises:
        ValueError: it is none.
    """
    if not (is_finite(value) and value > 0.0):
        raise ValueError(f"{name} must be finite and positive, got {value} {unit}")

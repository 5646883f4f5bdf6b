# SPDX-License-Identifier: LGPL-3.0-or-later
"""Errors of computations that have no reliable result."""

import numpy as np


class NumericsError(RuntimeError):
    """Error for a result that is not finite or exceeds its energy bound.

    The message gives the remedy.
    """


# Errors that extreme data may cause anywhere in a computation.
NUMERICAL_ERRORS = NumericsError, ArithmeticError, np.linalg.LinAlgError, ValueError

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Error of computations whose result is not reliable."""

import numpy as np


class NumericsError(RuntimeError):
    """A result that is not finite or out of its energy bound. The message gives the remedy."""


# Errors that data out of proportion may cause anywhere in a computation.
NUMERICS = NumericsError, ArithmeticError, np.linalg.LinAlgError, ValueError

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The one way in which a computation says that its numbers cannot be trusted."""

import numpy as np


class NumericsError(RuntimeError):
    """The result is not finite, or its energy is out of bound. The message names the remedy."""


# What numbers out of proportion may lead to, wherever they come to light.
NUMERICS = NumericsError, ArithmeticError, np.linalg.LinAlgError, ValueError

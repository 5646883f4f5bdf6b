# SPDX-License-Identifier: LGPL-3.0-or-later
"""Array types for annotations. ``geometry`` is independent of this package and has its own."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Arrays of numpy as annotations name them; ``dynamics``, which is not known here, has its own."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]

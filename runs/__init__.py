# SPDX-License-Identifier: LGPL-3.0-or-later
"""Case files in, trajectories and a report out."""

import os
from pathlib import Path

# Of the cases that come with the program.
CASES = Path(__file__).parent / "cases"

# Before numpy reads it. Parallelism is ranks, members and points; what BLAS sums over threads
# differs in the last bit between one process and several, and contact amplifies that.
os.environ.setdefault("OMP_NUM_THREADS", "1")

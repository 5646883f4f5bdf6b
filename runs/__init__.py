# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs of case files: the command line, the pipeline from cases to results, and reports."""

import os
from pathlib import Path

# Folder of the cases that come with the program.
CASES = Path(__file__).parent / "cases"

# This must be set before numpy is imported. Ranks, ensemble members and sweep points are parallel
# processes. With BLAS threads, sums would differ in the last bit between one process and several,
# and contact amplifies such differences.
os.environ.setdefault("OMP_NUM_THREADS", "1")

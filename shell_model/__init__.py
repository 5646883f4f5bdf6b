# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells as gap systems: FEniCSx forms, contact rows, reduction, stresses."""

import os
from contextlib import suppress

# With its signal handler, PETSc ends a process that writes to a closed connection, such as the
# server of a live page or of a notebook.
os.environ["PETSC_OPTIONS"] = os.environ.get("PETSC_OPTIONS", "") + " -no_signal_handler"

# The wheels of DOLFINx need MPI before every other library of theirs, which this module loads. It
# aborts under the launcher of Open MPI, which `runs.process.ranks` refuses.
if "PMIX_RANK" not in os.environ:
    with suppress(ImportError):
        import dolfinx_solver  # noqa: F401 # its import loads MPI

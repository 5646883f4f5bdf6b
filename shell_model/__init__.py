# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells as gap systems: FEniCSx forms, contact rows, reduction, stresses."""

from contextlib import suppress

# The wheels of DOLFINx need MPI before every other library of theirs, which this module loads.
with suppress(ModuleNotFoundError):
    import dolfinx_solver  # noqa: F401 # its import alone does it

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compiled loops of time integration."""

from protractile.dynamics.kernels.compiled import make_cache_folder

# The folder must be set before numba compiles. It is removed at the end of the process.
_folder = make_cache_folder()

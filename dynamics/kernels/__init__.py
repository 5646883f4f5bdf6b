# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compiled loops of the integrators."""

from dynamics.kernels.compiled import find_folder

# This must be set before a time loop is compiled; the folder is removed at the end of the process.
_folder = find_folder()

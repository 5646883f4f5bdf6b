# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compiled loops of the integrators."""

from dynamics.kernels.compiled import find_folder

# Before a time loop is compiled; it goes when the process does.
_folder = find_folder()

# SPDX-License-Identifier: LGPL-3.0-or-later
"""How gap systems move, and what their motion is worth."""

from dynamics.kernels.compiled import find_folder

# Before the time loops are imported; it goes when the process does.
_folder = find_folder()

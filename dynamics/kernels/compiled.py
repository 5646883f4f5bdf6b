# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where numba keeps the compiled time loops."""

from __future__ import annotations

import os
from tempfile import TemporaryDirectory

from numba import config, njit


def find_folder() -> TemporaryDirectory[str] | None:
    """A folder until the process ends, where neither sources nor the user's caches can be written.

    numba refuses to compile what it cannot keep. Processes started from this one share the folder.
    """
    try:
        njit(cache=True)(find_folder)
    except RuntimeError:
        folder = TemporaryDirectory(prefix="protractile-")
        config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"] = folder.name
        return folder
    return None

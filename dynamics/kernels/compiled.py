# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compilation of the time loops by numba, and their cache."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from tempfile import TemporaryDirectory
from types import MappingProxyType
from typing import Any

from llvmlite.ir import Constant
from numba import config, njit
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

# No C calls a loop, and numba's entry for that takes time to compile.
LOOP: Mapping[str, Any] = MappingProxyType(
    {"cache": True, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
)

# Options of functions that are inlined in their callers.
PART: Mapping[str, Any] = MappingProxyType({**LOOP, "forceinline": True})

# Loops over modes, whose sums may be taken in any order. They are made part of whatever calls them:
# numba optimises a copy that is only called once more, in another order, so that the process which
# compiles would differ in the last bit from those that find its work in the cache.
SUMS: Mapping[str, Any] = MappingProxyType(
    {**PART, "fastmath": {"reassoc", "contract", "arcp", "nsz"}}
)


def find_folder() -> TemporaryDirectory[str] | None:
    """Return a cache folder for this process where no other can be written, else None.

    numba refuses to compile what it cannot keep. Processes started from this one share the folder.
    """
    try:
        njit(cache=True)(find_folder)
    except RuntimeError:
        folder = TemporaryDirectory(prefix="protractile-")
        config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"] = folder.name
        return folder
    return None


@contextmanager
def one_compiles() -> Iterator[None]:
    """Wait while another process compiles: it leaves in the cache what this one needs, too."""
    with open(__file__, encoding="utf-8") as source:
        # Without locks, as on some network disks, each process compiles for itself.
        with suppress(OSError):
            fcntl.flock(source, fcntl.LOCK_EX)
        yield


@intrinsic
def borrow(typing_context: Any, arrays: Any) -> Any:
    """Return the tuple of arrays without reference counts; its owner keeps the arrays alive.

    Counting is atomic, and costs a step of friction as much as its arithmetic.
    """

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        (given,) = arguments
        for position, of_array in enumerate(arrays):
            array = make_array(of_array)(context, builder, builder.extract_value(given, position))
            array.meminfo = Constant(array.meminfo.type, None)
            given = builder.insert_value(given, array._getvalue(), position)
        return given

    return arrays(arrays), codegen

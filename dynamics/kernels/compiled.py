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

# Options of all loops. Nothing calls them from C, and the C wrapper takes time to compile.
LOOP: Mapping[str, Any] = MappingProxyType(
    {"cache": True, "nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}
)

# Options of functions that are inlined in their callers.
PART: Mapping[str, Any] = MappingProxyType({**LOOP, "forceinline": True})

# Options of loops over modes, whose sums may be reordered. They are inlined. Otherwise numba would
# optimise a second call in another order, and the process that compiles would differ in the last
# bit from processes that read the cache.
SUMS: Mapping[str, Any] = MappingProxyType(
    {**PART, "fastmath": {"reassoc", "contract", "arcp", "nsz"}}
)


def make_cache_folder() -> TemporaryDirectory[str] | None:
    """Return a temporary cache folder if numba cannot write to its own folders, else None.

    Without a writable folder, numba does not compile cached functions. Child processes share the
    folder.
    """
    try:
        njit(cache=True)(make_cache_folder)
    except RuntimeError:
        folder = TemporaryDirectory(prefix="protractile-")
        config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"] = folder.name
        return folder
    return None


@contextmanager
def compilation_lock() -> Iterator[None]:
    """Hold the lock of compilation, so that other processes wait and then read the cache."""
    with open(__file__, encoding="utf-8") as source:
        # Without locks, as on some network disks, each process compiles for itself.
        with suppress(OSError):
            fcntl.flock(source, fcntl.LOCK_EX)
        yield


@intrinsic
def borrow(typing_context: Any, arrays: Any) -> Any:
    """Return a tuple of arrays without reference counts; the caller must keep the arrays alive.

    Atomic counting would take as long as the arithmetic of a step with friction.
    """

    def codegen(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        (given,) = arguments
        for position, of_array in enumerate(arrays):
            array = make_array(of_array)(context, builder, builder.extract_value(given, position))
            array.meminfo = Constant(array.meminfo.type, None)
            given = builder.insert_value(given, array._getvalue(), position)
        return given

    return arrays(arrays), codegen

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compilation of the time loops by numba, and their cache."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile
from types import FunctionType, MappingProxyType
from typing import Any

from llvmlite.ir import Constant
from numba import config, njit
from numba.core.caching import CompileResultCacheImpl
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

# Folder of the sources of the loops.
_KERNELS = Path(__file__).parent

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


class LoopLocator:
    """Place of the compiled loops: a folder for all installations with the same sources.

    It has the methods of numba's ``_CacheLocator``.
    It is in ``$NUMBA_CACHE_DIR``, or else in the user's cache folder, and has the hash of all
    sources of :mod:`protractile.dynamics` in its name, since loops inline functions of other files.
    """

    def __init__(self, function: FunctionType) -> None:
        self._line = function.__code__.co_firstlineno

    @classmethod
    def from_function(cls, function: FunctionType, file: str) -> LoopLocator | None:
        """Return the place of a loop; None for functions from elsewhere, or without a folder."""
        locator = cls(function) if Path(file).parent == _KERNELS else None
        with suppress(OSError, RuntimeError):
            if locator is not None:
                locator.ensure_cache_path()
                return locator
        return None

    def ensure_cache_path(self) -> None:
        """Create the folder.

        Raises:
            OSError: it cannot be written.
        """
        folder = self.get_cache_path()
        os.makedirs(folder, exist_ok=True)
        TemporaryFile(dir=folder).close()

    def get_cache_path(self) -> str:
        """Return the folder.

        Raises:
            RuntimeError: the user has no home folder.
        """
        caches = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
        parent = Path(config.CACHE_DIR or Path(caches) / "protractile")
        return str(parent / f"loops-{self.get_source_stamp()}")

    def get_source_stamp(self) -> str:
        """Return the hash of the sources."""
        return _source_hash()

    def get_disambiguator(self) -> str:
        """Return the line of the function, which tells functions of one name apart."""
        return str(self._line)


@cache
def _source_hash() -> str:
    """Return a hash of all sources of :mod:`protractile.dynamics`."""
    sources = sorted(_KERNELS.parent.glob("**/*.py"))
    return sha256(b"".join(source.read_bytes() for source in sources)).hexdigest()[:16]


def make_cache_folder() -> TemporaryDirectory[str] | None:
    """Return a temporary cache folder if numba cannot write to any other, else None.

    Without a writable folder, numba does not compile cached functions. Child processes share the
    folder.
    """
    CompileResultCacheImpl._locator_classes = [
        LoopLocator,
        *CompileResultCacheImpl._locator_classes,
    ]
    try:
        njit(cache=True)(make_cache_folder)
    except RuntimeError:
        folder = TemporaryDirectory(prefix="protractile-")
        config.CACHE_DIR = os.environ["NUMBA_CACHE_DIR"] = folder.name
        return folder
    return None


@contextmanager
def compilation_lock(folder: str) -> Iterator[None]:
    """Hold the lock of compilation into a folder, so that other processes wait and then read it."""
    descriptor = os.open(folder, os.O_RDONLY)
    # Without locks, as on some network disks, each process compiles for itself.
    with suppress(OSError):
        fcntl.flock(descriptor, fcntl.LOCK_EX)
    try:
        yield
    finally:
        os.close(descriptor)


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

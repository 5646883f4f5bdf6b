# SPDX-License-Identifier: LGPL-3.0-or-later
"""Versions of this program and of its libraries."""

from __future__ import annotations

import hashlib
import platform
import sys
from collections.abc import Iterable, Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

# Python packages that influence numerical results.
_LIBRARIES = "protractile", "numpy", "scipy", "numba", "gmsh", "fenics-dolfinx", "petsc4py"


def installed_version(name: str) -> str | None:
    """Return the version of a Python package; None if it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def versions() -> dict[str, str | None]:
    """Return the versions of libraries by name; None for libraries that are not loaded."""
    modules: Sequence[str] = (
        "numpy", "scipy", "numba", "xarray", "gmsh", "dolfinx", "petsc4py", "mpi4py",
    )  # fmt: skip
    return {
        "protractile": installed_version("protractile"),
        "python": platform.python_version(),
        **{name: getattr(sys.modules.get(name), "__version__", None) for name in modules},
    }


@cache
def packages() -> list[Path]:
    """Return the folders of this program's packages, which are links in the source tree."""
    return [path.parent for path in sorted(Path(__file__).parents[2].glob("*/__init__.py"))]


def sources(folders: Iterable[Path]) -> str:
    """Return the SHA-256 of the paths and contents of all Python files of these packages."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in sorted(folder.rglob("*.py")):
            if (path.parent / "__init__.py").is_file():
                content = path.read_bytes()
                place = path.relative_to(folder.parent).as_posix()
                digest.update(f"{place}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


@cache
def program() -> dict[str, str | None]:
    """Return the hash of the sources, and the versions of the libraries that affect results."""
    # Installed versions, since the loaded modules differ between processes.
    libraries = {name: installed_version(name) for name in _LIBRARIES}
    return {"sources": sources(packages()), **libraries}

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Versions of the code that computes: this program's sources, and the libraries."""

from __future__ import annotations

import hashlib
import platform
import sys
from collections.abc import Iterable, Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution, version
from pathlib import Path

# The distributions that compute.
_LIBRARIES = "protractile", "numpy", "scipy", "numba", "gmsh", "fenics-dolfinx", "petsc4py"


def installed_version(name: str) -> str | None:
    """Return the version of a distribution; None where it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def versions() -> dict[str, str | None]:
    """Return versions of loaded modules by name: a beam's run does not load FEniCSx."""
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
    """Return this program's packages: all in the source tree, or the installed ones."""
    top = Path(__file__).parents[2]
    if (top / "pyproject.toml").is_file():
        return [path.parent for path in sorted(top.glob("*/__init__.py"))]
    installed = distribution("protractile").read_text("top_level.txt") or ""
    return [top / name for name in installed.split()]


def sources(folders: Iterable[Path]) -> str:
    """Return the SHA-256 of the Python files of packages and subpackages, with their paths."""
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
    """Return the inputs of a result beside its data: the sources, and libraries that compute."""
    # As installed: the loaded modules of one process do not determine those of another.
    libraries = {name: installed_version(name) for name in _LIBRARIES}
    return {"sources": sources(packages()), **libraries}

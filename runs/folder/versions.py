# SPDX-License-Identifier: LGPL-3.0-or-later
"""What computed."""

from __future__ import annotations

import hashlib
import platform
import sys
from collections.abc import Iterable, Iterator, Sequence
from functools import cache
from importlib.metadata import PackageNotFoundError, distribution, version
from pathlib import Path

# The distributions that compute.
_LIBRARIES = "protractile", "numpy", "scipy", "numba", "gmsh", "fenics-dolfinx", "petsc4py"


def installed_version(name: str) -> str | None:
    """A distribution's; None where it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def versions() -> dict[str, str | None]:
    """By the module's name, which counts if it has been loaded: a beam's run spares FEniCSx."""
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
    """Folders of this program's packages: all in the tree of its sources, or those installed."""
    top = Path(__file__).parents[2]
    if (top / "pyproject.toml").is_file():
        return [path.parent for path in sorted(top.glob("*/__init__.py"))]
    installed = distribution("protractile").read_text("top_level.txt") or ""
    return [top / name for name in installed.split()]


def sources(folders: Iterable[Path]) -> str:
    """SHA-256 of the Python files of packages and of the packages in them, with their places."""
    digest = hashlib.sha256()
    for folder in folders:
        for path in _modules(folder):
            content = path.read_bytes()
            place = path.relative_to(folder.parent).as_posix()
            digest.update(f"{place}\0{len(content)}\0".encode() + content)
    return digest.hexdigest()


@cache
def program() -> dict[str, str | None]:
    """What decides a result beside its data: the sources, and the libraries that compute."""
    # As installed: what a process has loaded says nothing of what another one will compute.
    libraries = {name: installed_version(name) for name in _LIBRARIES}
    return {"sources": sources(packages()), **libraries}


def _modules(package: Path) -> Iterator[Path]:
    yield from sorted(package.glob("*.py"))
    for inner in sorted(package.glob("*/__init__.py")):
        yield from _modules(inner.parent)

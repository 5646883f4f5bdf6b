# SPDX-License-Identifier: LGPL-3.0-or-later
"""What computed."""

from __future__ import annotations

import platform
import sys
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version


def own_version() -> str | None:
    """This program's; None where it is not installed."""
    try:
        return version("protractile")
    except PackageNotFoundError:
        return None


def versions() -> dict[str, str | None]:
    """By the module's name, which counts if it has been loaded: a beam's run spares FEniCSx."""
    modules: Sequence[str] = (
        "numpy", "scipy", "numba", "xarray", "gmsh", "dolfinx", "petsc4py", "mpi4py",
    )  # fmt: skip
    return {
        "protractile": own_version(),
        "python": platform.python_version(),
        **{name: getattr(sys.modules.get(name), "__version__", None) for name in modules},
    }

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a command imports: libraries that take long to load, where they are needed alone."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

from runs import CASES

ROOT = Path(__file__).parents[2]
OF_RUNS = {
    "basix", "dolfinx", "gmsh", "matplotlib", "mpi4py", "numba", "pandas", "petsc4py", "pyvista",
    "scipy.signal", "scipy.stats", "ufl", "vtkmodules", "xarray",
}  # fmt: skip
OF_CHECKS = {"numpy", "pydantic", "scipy"}
PROGRAM = """
import sys
from runs import cli
try:
    cli.main(sys.argv[1:])
except SystemExit as ended:
    print(*sys.modules, file=sys.stderr)
    raise
"""


def answer(*arguments: str) -> tuple[str, set[str]]:
    """What a command that succeeds prints, and the modules that it has imported."""
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *arguments],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        check=True,
        capture_output=True,
        text=True,
    )
    return done.stdout, set(done.stderr.split())


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_an_option_imports_no_library_that_computes(option: str) -> None:
    assert not answer(option)[1] & (OF_RUNS | OF_CHECKS)


def test_check_imports_nothing_that_moves_or_draws() -> None:
    out, modules = answer("check", str(CASES / "spatial.toml"))
    assert "shell" in out
    assert not modules & OF_RUNS


def test_version_is_the_installed_one() -> None:
    try:
        installed = version("protractile")
    except PackageNotFoundError:
        installed = "(not installed)"
    assert answer("--version")[0] == f"protractile {installed}\n"


def test_who_imports_the_package_is_warned_as_before() -> None:
    """The command alone is silent: a notebook hears what concerns it."""
    program = "import warnings, protractile as pt; pt.load_case; warnings.warn('heard')"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, check=True, capture_output=True, text=True
    )
    assert "UserWarning: heard" in done.stderr

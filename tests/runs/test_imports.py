# SPDX-License-Identifier: LGPL-3.0-or-later
"""What modules import: of each other without cycles, of libraries what a command needs."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
from collections.abc import Iterator
from graphlib import TopologicalSorter
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

from runs import CASES

ROOT = Path(__file__).parents[2]
# What each room knows besides itself.
BELOW = {"geometry", "dynamics"}
ROOMS = {
    "geometry": set[str](),
    "dynamics": set[str](),
    "beam_model": BELOW,
    "shell_model": BELOW,
    "runs": BELOW | {"beam_model", "shell_model"},
    "protractile": BELOW | {"beam_model", "shell_model", "runs"},
    "studies": BELOW | {"beam_model", "shell_model", "runs", "protractile"},
}
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


def imported(node: ast.AST, for_types: bool) -> Iterator[str]:
    """Every module, or name of one, that a file imports, inside functions, too."""
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING" and not for_types:
        return
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    if isinstance(node, ast.ImportFrom):
        yield str(node.module)
        yield from (f"{node.module}.{alias.name}" for alias in node.names)
    for child in ast.iter_child_nodes(node):
        yield from imported(child, for_types)


@pytest.fixture(scope="module")
def trees() -> dict[str, ast.Module]:
    """Each of our modules, by its name."""
    return {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): ast.parse(
            path.read_text("utf-8")
        )
        for room in ROOMS
        for path in (ROOT / room).rglob("*.py")
    }


@pytest.fixture(scope="module")
def graph(trees: dict[str, ast.Module]) -> dict[str, set[str]]:
    """Return the imports of each module within the project, without those for types."""
    return {name: {*imported(tree, False)} & trees.keys() for name, tree in trees.items()}


def test_no_module_imports_itself_by_way_of_others(graph: dict[str, set[str]]) -> None:
    TopologicalSorter(graph).prepare()


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_knows_those_below(room: str, trees: dict[str, ast.Module]) -> None:
    """For types, too; no room knows the studies, which prove it."""
    own = (tree for name, tree in trees.items() if name.split(".")[0] == room)
    known = {found.split(".")[0] for tree in own for found in imported(tree, True)}
    assert known & ROOMS.keys() <= ROOMS[room] | {room}


def test_the_paper_is_a_client(graph: dict[str, set[str]]) -> None:
    knowing = {name for name, found in graph.items() if any("runs.paper" in f for f in found)}
    others = {name for name in knowing if not name.startswith(("runs.paper", "studies"))}
    assert others == {"runs.client", "runs.case.schema"}


def answer(*arguments: str) -> tuple[str, set[str]]:
    """Return the output of a successful command, and the modules that it has imported."""
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
def test_options_import_no_numerical_library(option: str) -> None:
    assert not answer(option)[1] & (OF_RUNS | OF_CHECKS)


def test_check_imports_neither_solvers_nor_figures() -> None:
    out, modules = answer("check", str(CASES / "spatial.toml"))
    assert "shell" in out
    assert not modules & OF_RUNS


def test_version_is_the_installed_one() -> None:
    try:
        installed = version("protractile")
    except PackageNotFoundError:
        installed = "(not installed)"
    assert answer("--version")[0] == f"protractile {installed}\n"


def test_importing_the_package_keeps_warnings() -> None:
    """The command alone is silent: a notebook hears what concerns it."""
    program = "import warnings, protractile as pt; pt.load_case; warnings.warn('heard')"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=ROOT, check=True, capture_output=True, text=True
    )
    assert "UserWarning: heard" in done.stderr

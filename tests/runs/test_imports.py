# SPDX-License-Identifier: LGPL-3.0-or-later
"""Imports of modules, versions of the sources, and clients."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from graphlib import TopologicalSorter
from importlib.metadata import version
from pathlib import Path

import pytest

from protractile.runs import CASES, clients
from protractile.runs.folder.versions import packages, sources
from protractile.runs.paper.verdicts import addition
from tests.runs.case_texts import shipped
from tests.system.run_folder import ROOT, python

# What each room knows besides itself.
BELOW = {"geometry", "dynamics"}
ROOMS = {
    "geometry": {"dynamics"},
    "dynamics": set[str](),
    "beam_model": BELOW,
    "shell_model": BELOW,
    "analysis": BELOW | {"beam_model", "shell_model"},
    "runs": BELOW | {"beam_model", "shell_model", "analysis"},
    "protractile": BELOW | {"beam_model", "shell_model", "analysis", "runs"},
    "studies": BELOW | {"beam_model", "shell_model", "analysis", "runs", "protractile"},
}
# Packages of runs, each of which knows those before it.
PARTS = "clients", "options", "process", "folder", "case", "pipeline", "cautions", "report", "sweep"
# At the start of a line, also of one within a text of a program.
OLD_IMPORT = re.compile(
    r"(^\W*|\\n)(from|import) (geometry|dynamics|beam_model|shell_model|runs)\b", re.M
)
OF_RUNS = {
    "basix", "dolfinx", "gmsh", "matplotlib", "mpi4py", "numba", "pandas", "petsc4py", "pyvista",
    "scipy.signal", "scipy.stats", "ufl", "vtkmodules", "xarray",
}  # fmt: skip
OF_CHECKS = {"numpy", "pydantic", "scipy"}
PROGRAM = """
import sys
from protractile.runs import cli
try:
    cli.main(sys.argv[1:])
except SystemExit as ended:
    print(*sys.modules, file=sys.stderr)
    raise
"""


def imported(node: ast.AST, for_types: bool) -> Iterator[str]:
    """Return every module, or name from a module, that a file imports, also inside functions."""
    if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING" and not for_types:
        return
    if isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)
    if isinstance(node, ast.ImportFrom):
        yield str(node.module)
        yield from (f"{node.module}.{alias.name}" for alias in node.names)
    for child in ast.iter_child_nodes(node):
        yield from imported(child, for_types)


def module_name(path: Path) -> str:
    """Return the name by which a module is imported; the folders are linked in ``protractile``."""
    name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    return name if name.startswith(("protractile", "studies")) else f"protractile.{name}"


def room_of(name: str) -> str:
    """Return the room of a module, which for public names is ``protractile`` itself."""
    parts = name.split(".")
    return parts[1] if len(parts) > 1 and parts[1] in ROOMS else parts[0]


@pytest.fixture(scope="module")
def trees() -> dict[str, ast.Module]:
    return {
        module_name(path): ast.parse(path.read_text("utf-8"))
        for room in ROOMS
        for path in (ROOT / room).rglob("*.py")
    }


@pytest.mark.slow
def test_imports_point_downwards(trees: dict[str, ast.Module]) -> None:
    """Nothing imports itself by way of others, also for types. Geometry knows contact laws only."""
    graph, typed = (
        {name: {*imported(tree, types)} for name, tree in trees.items()} for types in (False, True)
    )
    for found in (graph, typed):
        TopologicalSorter({name: found[name] & trees.keys() for name in trees}).prepare()
    # From the folders at the top level, modules would be imported a second time.
    names = {name.partition(".")[0] for found in typed.values() for name in found}
    assert names & ROOMS.keys() == {"protractile", "studies"}
    for path in (
        path for room in ("tests", "docs", "examples") for path in (ROOT / room).rglob("*")
    ):
        if path.suffix in {".py", ".md", ".ipynb"}:
            assert not OLD_IMPORT.search(path.read_text("utf-8")), path
    for room, below in ROOMS.items():
        known = {room_of(x) for name in trees if room_of(name) == room for x in typed[name]}
        assert known & ROOMS.keys() <= below | {room}, room
    of_geometry = {x for name in graph if room_of(name) == "geometry" for x in graph[name]}
    laws = "protractile.dynamics.contact"
    assert {x for x in of_geometry & trees.keys() if room_of(x) == "dynamics"} == {laws}
    assert graph[laws] & trees.keys() == {"protractile.dynamics.arrays"}
    # A part of runs knows those before it.
    parts = {name: name.split(".")[2] for name in trees if name.startswith("protractile.runs.")}
    order = (*PARTS, "check", "cli", *clients.CLIENTS)
    assert {*parts.values()} == {*order}
    for name, part in parts.items():
        known = {parts[x] for x in typed[name] if x in parts}
        assert known <= {*order[: order.index(part) + 1]}, name
    # Studies and tests may import clients: they prove the product. Texts may hide imports, too.
    texts = {name: ast.unparse(tree) for name, tree in trees.items()}
    for client in clients.CLIENTS:
        package = f"protractile.runs.{client}"
        others = [name for name in trees if not name.startswith((package, "studies"))]
        assert 150 < len(others) < len(trees)
        assert [name for name in others if package in texts[name]] == []


def answer(*arguments: str, program: str = PROGRAM) -> tuple[str, set[str]]:
    """Return the output of a successful command, and the modules that it has imported."""
    done = python("-c", program, *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout, set(done.stderr.split())


def test_options_import_no_numerical_library() -> None:
    out, modules = answer("--version")
    assert out == f"protractile {version('protractile')}\n"
    assert not modules & (OF_RUNS | OF_CHECKS)


@pytest.mark.slow
def test_keys_and_commands_of_clients_exist_by_registration() -> None:
    """Reference: by construction."""
    alone = f"from protractile.runs import clients; clients.CLIENTS = ()\n{PROGRAM}"
    words, keys = [], []
    for text in (PROGRAM, alone):
        words.append({*answer("--help", program=text)[0].split()})
        keys.append({*json.loads(answer("schema", program=text)[0])["properties"]})
    assert words[0] - words[1] >= {"live", "export", "identify"}
    assert keys[0] - keys[1] == {"chart", "measured", "statements", "demand"}


@pytest.mark.slow
@pytest.mark.parametrize(("command", "case"), [("check", "spatial"), ("prove", "inspection-arm")])
def test_check_and_prove_import_neither_solvers_nor_figures(command: str, case: str) -> None:
    out, modules = answer(command, str(CASES / f"{case}.toml"))
    assert "static" in out.lower()
    assert not modules & OF_RUNS


def test_modules_in_all_folders_count(tmp_path: Path) -> None:
    """Reference: by construction. Results are no source."""
    (tmp_path / "inner").mkdir()
    for folder in (tmp_path, tmp_path / "inner"):
        (folder / "__init__.py").touch()
    found = [sources([tmp_path])]
    for name in ("a.py", "inner/b.py", "out/c.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("x = 1\n")
        found.append(sources([tmp_path]))
    assert len({*found[:3]}) == 3
    assert found[3] == found[2]
    assert {package.name for package in packages()} == ROOMS.keys() - {"protractile", "studies"}


CLIENT = (ROOT / "runs" / "paper").glob("**/*")
KNOWS = re.compile(r"\"S\d+\"|\bstatements?\b|\bverdicts?\b|reproduced|contradicted|undecided")


def test_no_other_module_knows_the_paper() -> None:
    modules = [path for room in ROOMS.keys() - {"studies"} for path in (ROOT / room).rglob("*.py")]
    general = {*modules, *(ROOT / "runs/report/templates").iterdir()}.difference(CLIENT)
    assert len(general) > 150
    lines = [(path, line) for path in general for line in path.read_text("utf-8").splitlines()]
    assert [(path, line) for path, line in lines if KNOWS.search(line)] == []


MOST_LINES, MOST_LINES_OF_A_FUNCTION = 450, 80
# The time loop: its parts would share two dozen work arrays, each an argument.
LONG = ["march"]
FUNCTION = ast.FunctionDef | ast.AsyncFunctionDef


def test_modules_and_functions_are_short(trees: dict[str, ast.Module]) -> None:
    paths = [path for room in ROOMS.keys() - {"studies"} for path in (ROOT / room).rglob("*.py")]
    lines = {path: path.read_text("utf-8").count("\n") for path in paths}
    assert [path for path, number in lines.items() if number > MOST_LINES] == []
    product = (tree for name, tree in trees.items() if room_of(name) != "studies")
    functions = (node for tree in product for node in ast.walk(tree) if isinstance(node, FUNCTION))
    lengths = ((node.name, (node.end_lineno or 0) - node.lineno) for node in functions)
    assert [name for name, length in lengths if length >= MOST_LINES_OF_A_FUNCTION] == LONG


def test_figures_name_their_counterparts() -> None:
    """Reference: external, Figs. 6 and 7 of the paper; with friction, Figs. 8 and 9."""
    for case, numbers in ((shipped("paper"), (6, 7)), (shipped("paper-friction"), (8, 9))):
        remarks = addition(case, []).remarks
        for place, number in zip(("tip", "head"), numbers, strict=True):
            assert f"counterpart of Fig. {number} of the paper" in remarks[f"figure-{place}"]
        assert addition(case.without_client_keys(), []).remarks == {}

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
from tests.system.run_folder import ROOT, protractile, python

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
STATEMENTS = ast.stmt | ast.ExceptHandler | ast.match_case


def imported(tree: ast.Module, for_types: bool) -> Iterator[str]:
    """Return every module, or name from a module, that a file imports, also inside functions."""
    nodes: list[ast.AST] = [tree]
    for node in nodes:
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING" and not for_types:
            continue
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        if isinstance(node, ast.ImportFrom):
            yield str(node.module)
            yield from (f"{node.module}.{alias.name}" for alias in node.names)
        nodes += [child for child in ast.iter_child_nodes(node) if isinstance(child, STATEMENTS)]


def module_name(path: Path) -> str:
    """Return the name by which a module is imported; the folders are linked in ``protractile``."""
    name = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    return name if name.startswith(("protractile", "studies")) else f"protractile.{name}"


def room_of(name: str) -> str:
    """Return the room of a module, which for public names is ``protractile`` itself."""
    parts = name.split(".")
    return parts[1] if len(parts) > 1 and parts[1] in ROOMS else parts[0]


def modules_of(*rooms: str) -> list[Path]:
    return [path for room in rooms for path in (ROOT / room).rglob("*.py")]


PRODUCT = modules_of(*ROOMS.keys() - {"studies"})


@pytest.fixture(scope="module")
def trees() -> dict[str, ast.Module]:
    return {module_name(path): ast.parse(path.read_text("utf-8")) for path in modules_of(*ROOMS)}


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
    texts = {module_name(path): path.read_text("utf-8") for path in modules_of(*ROOMS)}
    for client in clients.CLIENTS:
        package = f"protractile.runs.{client}"
        others = [name for name in trees if not name.startswith((package, "studies"))]
        assert 150 < len(others) < len(trees)
        assert [name for name in others if package in texts[name]] == []


PROGRAM = """
import sys
from protractile.runs import clients
if sys.argv[1] == "alone":
    clients.CLIENTS = ()
from protractile.runs import cli
for command in sys.argv[2:]:
    try:
        cli.main(command.split())
    except SystemExit as ended:
        assert not ended.code
    for stream, last in ((sys.stdout, ""), (sys.stderr, " ".join(sys.modules))):
        print(last, end="\f", file=stream)
"""


def answers(clients: str, *commands: str) -> Iterator[tuple[str, set[str]]]:
    """Return the output of each successful command, and the modules imported so far."""
    done = python("-c", PROGRAM, clients, *commands)
    assert done.returncode == 0, done.stderr
    told, modules = (text.split("\f")[:-1] for text in (done.stdout, done.stderr))
    return zip(told, (set(names.split()) for names in modules), strict=True)


@pytest.mark.slow
def test_keys_and_commands_of_clients_exist_by_registration(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """Reference: by construction."""
    commands = "--help", "schema"
    both = []
    for command in commands:
        assert not protractile(command)
        both.append(capsys.readouterr().out)
    (words, schema), (words_alone, alone) = both, (out for out, _ in answers("alone", *commands))
    assert {*words.split()} - {*words_alone.split()} >= {"live", "export", "identify"}
    keys, others = (json.loads(text)["properties"].keys() for text in (schema, alone))
    assert keys - others == {"chart", "measured", "statements", "demand"}


@pytest.mark.slow
def test_check_and_prove_import_neither_solvers_nor_figures() -> None:
    """Options import no numerical library."""
    cases = f"check {CASES / 'spatial.toml'}", f"prove {CASES / 'inspection-arm.toml'}"
    (out, modules), *others = answers("all", "--version", *cases)
    assert out == f"protractile {version('protractile')}\n"
    assert not modules & (OF_RUNS | OF_CHECKS)
    for out, modules in others:
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
    general = {*PRODUCT, *(ROOT / "runs/report/templates").iterdir()}.difference(CLIENT)
    assert len(general) > 150
    assert [path for path in general if KNOWS.search(path.read_text("utf-8"))] == []


MOST_LINES, MOST_LINES_OF_A_FUNCTION = 450, 80
# The time loop: its parts would share two dozen work arrays, each an argument.
LONG = ["march"]
FUNCTION = ast.FunctionDef | ast.AsyncFunctionDef


def test_modules_and_functions_are_short(trees: dict[str, ast.Module]) -> None:
    lines = {path: path.read_text("utf-8").count("\n") for path in PRODUCT}
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

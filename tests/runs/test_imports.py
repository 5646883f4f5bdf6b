# SPDX-License-Identifier: LGPL-3.0-or-later
"""Imports of modules, versions of the sources, and clients."""

from __future__ import annotations

import ast
import json
import re
from collections.abc import Iterator
from graphlib import TopologicalSorter
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

import pytest

from protractile.runs import CASES, clients
from protractile.runs.folder.versions import packages, program, sources
from protractile.runs.paper.statements import STATEMENTS
from protractile.runs.paper.verdicts import addition, evidence
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


@pytest.fixture(scope="module")
def graph(trees: dict[str, ast.Module]) -> dict[str, set[str]]:
    """Return the imports of each module within the project, without those for types."""
    return {name: {*imported(tree, False)} & trees.keys() for name, tree in trees.items()}


def test_no_module_imports_itself_by_way_of_others(
    graph: dict[str, set[str]], trees: dict[str, ast.Module]
) -> None:
    """Imports for types form no cycle either."""
    TopologicalSorter(graph).prepare()
    typed = {name: {*imported(tree, True)} & trees.keys() for name, tree in trees.items()}
    TopologicalSorter(typed).prepare()


@pytest.mark.parametrize("room", ROOMS)
def test_a_room_knows_those_below(room: str, trees: dict[str, ast.Module]) -> None:
    own = (tree for name, tree in trees.items() if room_of(name) == room)
    known = {room_of(found) for tree in own for found in imported(tree, True)}
    assert known & ROOMS.keys() <= ROOMS[room] | {room}


def test_a_part_of_runs_knows_those_before_it(trees: dict[str, ast.Module]) -> None:
    parts = {name: name.split(".")[2] for name in trees if name.startswith("protractile.runs.")}
    order = (*PARTS, "check", "cli", *clients.CLIENTS)
    assert {*parts.values()} == {*order}
    for name, part in parts.items():
        known = {parts[found] for found in imported(trees[name], True) if found in parts}
        assert known <= {*order[: order.index(part) + 1]}, name


@pytest.mark.parametrize("client", clients.CLIENTS)
def test_nothing_imports_a_client(client: str, trees: dict[str, ast.Module]) -> None:
    """Studies and tests may: they prove the product. Names in texts are imports in functions."""
    package = f"protractile.runs.{client}"
    others = [name for name in trees if not name.startswith((package, "studies"))]
    assert 150 < len(others) < len(trees)
    assert [name for name in others if package in ast.unparse(trees[name])] == []


def test_geometry_knows_contact_laws_only(graph: dict[str, set[str]]) -> None:
    known = {one for name in graph if room_of(name) == "geometry" for one in graph[name]}
    assert {one for one in known if room_of(one) == "dynamics"} == {"protractile.dynamics.contact"}
    assert graph["protractile.dynamics.contact"] == {"protractile.dynamics.arrays"}


def answer(*arguments: str, program: str = PROGRAM) -> tuple[str, set[str]]:
    """Return the output of a successful command, and the modules that it has imported."""
    done = python("-c", program, *arguments)
    assert done.returncode == 0, done.stderr
    return done.stdout, set(done.stderr.split())


@pytest.mark.parametrize("option", ["--help", "--version"])
def test_options_import_no_numerical_library(option: str) -> None:
    assert not answer(option)[1] & (OF_RUNS | OF_CHECKS)


def test_keys_and_commands_of_clients_exist_by_registration() -> None:
    """Reference: by construction."""
    alone = f"from protractile.runs import clients; clients.CLIENTS = ()\n{PROGRAM}"
    words, keys = [], []
    for text in (PROGRAM, alone):
        words.append({*answer("--help", program=text)[0].split()})
        keys.append({*json.loads(answer("schema", program=text)[0])["properties"]})
    assert words[0] - words[1] >= {"live", "export", "identify"}
    assert keys[0] - keys[1] == {"chart", "measured", "statements", "demand"}


@pytest.mark.parametrize(("command", "case"), [("check", "spatial"), ("prove", "inspection-arm")])
def test_check_and_prove_import_neither_solvers_nor_figures(command: str, case: str) -> None:
    out, modules = answer(command, str(CASES / f"{case}.toml"))
    assert "static" in out.lower()
    assert not modules & OF_RUNS


def test_version_is_the_installed_one() -> None:
    try:
        installed = version("protractile")
    except PackageNotFoundError:
        installed = "(not installed)"
    assert answer("--version")[0] == f"protractile {installed}\n"


def test_importing_the_package_keeps_warnings() -> None:
    program = "import warnings, protractile as pt; pt.load_case; warnings.warn('heard')"
    assert "UserWarning: heard" in python("-c", program).stderr


def test_modules_in_all_folders_count(tmp_path: Path) -> None:
    package = tmp_path / "package"
    deep = package / "inner" / "innermost"
    deep.mkdir(parents=True)
    for folder in (package, package / "inner", deep):
        (folder / "__init__.py").touch()
    found = {sources([package])}
    for change in (
        lambda: (deep / "a.py").write_text("x = 1\n"),
        lambda: (deep / "a.py").write_text("x = 2\n"),
        lambda: (deep / "a.py").rename(deep / "b.py"),
        lambda: (deep / "b.py").rename(package / "b.py"),
    ):
        change()
        found.add(sources([package]))
    assert len(found) == 5
    # Results are no source.
    before = sources([package])
    (package / "a.txt").touch()
    (package / "out").mkdir()
    (package / "out" / "a.py").touch()
    assert sources([package]) == before


def test_the_packages_are_found_by_themselves() -> None:
    names = {package.name for package in packages()}
    assert names == ROOMS.keys() - {"protractile", "studies"}
    assert program()["sources"] == sources(packages())


# At the start of a line, also of one within a text of a program.
OLD_IMPORT = re.compile(
    r"(^\W*|\\n)(from|import) (geometry|dynamics|beam_model|shell_model|runs)\b", re.M
)


def test_all_imports_begin_with_the_name_of_the_program() -> None:
    """The folders are at the top level, and would be imported a second time from there."""
    files = [
        path for room in (*ROOMS, "tests", "docs", "examples") for path in (ROOT / room).rglob("*")
    ]
    texts = [path for path in files if path.suffix in {".py", ".pyi", ".md", ".ipynb"}]
    assert len(texts) > 400
    assert [path for path in texts if OLD_IMPORT.search(path.read_text("utf-8"))] == []


PACKAGES = ("beam_model", "dynamics", "geometry", "protractile", "runs", "shell_model")
CLIENT = (ROOT / "runs" / "paper").glob("**/*")
KNOWS = re.compile(r"\"S\d+\"|\bstatements?\b|\bverdicts?\b|reproduced|contradicted|undecided")


def test_no_other_module_knows_the_paper() -> None:
    modules = [path for room in PACKAGES for path in (ROOT / room).glob("**/*.py")]
    general = {*modules, *(ROOT / "runs/report/templates").iterdir()}.difference(CLIENT)
    assert len(general) > 150
    lines = [(path, line) for path in general for line in path.read_text("utf-8").splitlines()]
    assert [(path, line) for path, line in lines if KNOWS.search(line)] == []


MOST_LINES, MOST_LINES_OF_A_FUNCTION = 450, 80
# The time loop: its parts would share two dozen work arrays, each an argument.
LONG = ["march"]


def test_modules_and_functions_are_short(trees: dict[str, ast.Module]) -> None:
    paths = [path for room in ROOMS.keys() - {"studies"} for path in (ROOT / room).rglob("*.py")]
    lines = {path: path.read_text("utf-8").count("\n") for path in paths}
    assert [path for path, number in lines.items() if number > MOST_LINES] == []
    functions = (
        node
        for name, tree in trees.items()
        if room_of(name) != "studies"
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef)
    )
    long = [
        one.name
        for one in functions
        if (one.end_lineno or 0) - one.lineno >= MOST_LINES_OF_A_FUNCTION
    ]
    assert long == LONG


TIP, CLOSE_UP, HEAD = "figure-tip", "figure-tip-close-up", "figure-head"
SLOW = "table-horizons", "table-slow-peaks"


@pytest.mark.parametrize(
    ("case", "expected"),
    [
        ("paper", {"S2": [TIP, *SLOW], "S6": [CLOSE_UP, HEAD], "S8": []}),
        ("paper-friction",
         {
             "S2": [*SLOW], "S7": [TIP, HEAD, "table-whole"],
             "S8": ["table-models", "table-steps"], "S11": [],
         }),
        ("three-segments", {"S6": [CLOSE_UP, HEAD, "figure-head-2"], "S11": [TIP, CLOSE_UP]}),
    ],
)  # fmt: skip
def test_evidence_follows_the_case(case: str, expected: dict[str, list[str]]) -> None:
    """Reference: the statements. A case with friction has other statements."""
    found = evidence(shipped(case))
    assert {key: [*found[key]] for key in expected} == expected
    assert [*found] == [*STATEMENTS]


@pytest.mark.parametrize(("case", "numbers"), [("paper", (6, 7)), ("paper-friction", (8, 9))])
def test_figures_name_their_counterparts(case: str, numbers: tuple[int, int]) -> None:
    """Reference: external, Figs. 6 and 7 of the paper; with friction, Figs. 8 and 9."""
    found = shipped(case)
    remarks = addition(found, []).remarks
    for place, number in zip(("tip", "head"), numbers, strict=True):
        assert f"counterpart of Fig. {number} of the paper" in remarks[f"figure-{place}"]
    assert addition(found.without_client_keys(), []).remarks == {}

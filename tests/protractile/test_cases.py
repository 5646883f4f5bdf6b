# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cases from Python, the public names of the package, and wrong objects as arguments."""

import doctest
import inspect
import sys
import tomllib
from collections.abc import Callable
from dataclasses import replace
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest
import xarray as xr

import protractile as pt
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import simulate
from protractile.runs.report import output
from tests.system.run_folder import COARSE, files, protractile, python, write_coarse

BEAM = ["beam-fe-bonded"]
TABLES = tomllib.loads(Path(COARSE).read_text("utf-8"))
SHORT = TABLES | {"time": TABLES["time"] | {"duration": 0.02}}


@pytest.fixture(scope="module")
def results() -> pt.Results:
    return pt.run_case(pt.load_case(SHORT), BEAM)


def test_tables_of_python_are_those_of_a_file() -> None:
    assert pt.load_case(TABLES) == pt.load_case(COARSE)
    with pytest.raises(
        pt.BadInput, match=r"^case: time.duration: must be a number greater than 0, got -1.0$"
    ):
        pt.load_case(TABLES | {"time": {"duration": -1.0}})


def test_check_returns_the_output_of_the_command(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: other code path."""
    assert protractile("check", COARSE, "--all") == 0
    printed = capsys.readouterr().out
    lines, words = printed.splitlines(), " ".join(printed.split())
    found = pt.check(pt.load_case(COARSE))
    # The last one is the estimate of the computing time.
    assert all(line in words for line in found.lines[:-1])
    assert repr(found).splitlines()[0] == lines[0]
    assert {*found.frames} <= {*map(str.strip, lines)}
    page = found._repr_html_()
    assert all(f"<b>{title}</b>" in page for title in found.frames)


@pytest.mark.slow
@pytest.mark.usefixtures("in_this_process", "few_figures", "unprinted")
def test_python_writes_the_files_of_the_commands(tmp_path: Path) -> None:
    """Reference: other code path, a run and a sweep, to the bit."""
    case = write_coarse(tmp_path, 0.02)
    assert protractile("run", case, "--models", BEAM[0], "--out", tmp_path / "run") == 0
    pt.run_case(pt.load_case(case), BEAM, folder=tmp_path / "ours")
    assert files(tmp_path / "ours") == files(tmp_path / "run")
    command, ours = tmp_path / "command", tmp_path / "python"
    vary = ["--vary", "joint.play=0.007,0.014", "--models", "kantorovich-4", "--out", command]
    assert protractile("sweep", case, *vary) == 0
    values = {"joint.play": [0.007, 0.014]}
    data = pt.sweep(pt.load_case(case), values, ["kantorovich-4"], folder=ours)
    assert files(ours) == files(command)
    xr.testing.assert_identical(xr.load_dataset(ours / "sweep.nc"), data)
    assert (ours / "sweep.csv").read_bytes() == (command / "sweep.csv").read_bytes()


def test_frequencies_of_one_case_and_of_several() -> None:
    """Reference: analytic, (ω₁/ω₂)² = E₁/E₂; without variations there is the case alone."""
    case = pt.load_case(COARSE)
    vary = {"material.youngs_modulus": [1.0e11, 4.0e11]}
    found = pt.frequencies(case, vary, BEAM)["frequency"].sel(joints="bonded", model=BEAM[0])
    np.testing.assert_allclose(found[1], 2.0 * found[0], rtol=1e-9)
    alone = pt.frequencies(case, models=BEAM)["frequency"]
    assert alone.dims == ("model", "joints", "mode")
    with pytest.raises(pt.BadInput, match=r"^case: --vary joint.ply: "):
        pt.frequencies(case, {"joint.ply": [0.0, 1.0]}, BEAM)


@pytest.mark.usefixtures("unprinted")
def test_results_are_saved_reported_and_put_into_a_workbook(
    results: pt.Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: the DataFrames, and the results of the run."""
    folder = tmp_path / "kept"
    for _ in range(2):  # the second time it replaces the first one
        results.save(folder)
    again = pt.report(folder, excel=True)
    assert again.case == results.case
    assert again.summary.models == results.summary.models
    xr.testing.assert_identical(again.trajectories, results.trajectories)
    assert (folder / "report.html").is_file()
    book = openpyxl.load_workbook(folder / output.WORKBOOK)
    tables = pt.tables(again)
    assert book.sheetnames == ["quantities", *tables]
    rows = {row[0]: row for row in book["quantities"].iter_rows(min_row=4, values_only=True)}
    tip = again.quantities.loc["tip"]
    assert rows["tip"] == ("tip", "m", pytest.approx(tip[BEAM[0]], rel=1e-12))
    assert tip[BEAM[0]] == float(np.abs(again.trajectories["tip"]).max())
    headings = [cell.value for cell in book["models"][1 + output.ABOVE]]
    assert headings == [*tables["models"].columns]
    assert "<b>The paper's boom" in results._repr_html_().replace("&#x27;", "'")
    (folder / "mine.txt").touch()
    (folder / "trajectories.nc").unlink()
    with pytest.raises(pt.BadInput, match="contains other files"):
        results.save(folder)


@pytest.mark.usefixtures("unprinted")
def test_without_openpyxl_one_line_says_so(
    results: pt.Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    results.save(tmp_path / "kept")
    monkeypatch.setitem(sys.modules, "openpyxl.workbook", None)
    assert protractile("report", tmp_path / "kept", "--excel") == 2
    assert capsys.readouterr().err == (
        f"protractile: {tmp_path / 'kept'}: --excel: openpyxl is missing, which writes workbooks; "
        "install it with pip\n"
    )
    assert not (tmp_path / "kept" / "report.html").exists()


HEAVY = "dolfinx", "pyvista", "matplotlib", "numba", "numpy"
ROOT = Path(__file__).parents[2]
ROOMS = "geometry", "dynamics", "beam_model", "analysis", "runs", ""
EXPLAINED = sorted(
    ".".join(path.relative_to(ROOT).with_suffix("").parts)
    for room in ROOMS
    for path in (ROOT / "protractile" / room).rglob("*.py")
    if ">>>" in path.read_text("utf-8")
)


@pytest.mark.parametrize("values", ["30", 30.0, ["30"]])
def test_values_of_a_sweep_are_a_list_of_numbers(values: Any) -> None:
    """Reference: exact words. The digits of a text were taken as values, others were tracebacks."""
    message = f"case: gravity.angle: must be a list of numbers, got {values!r}"
    for study in (pt.sweep, pt.frequencies):
        with pytest.raises(pt.BadInput) as refused:
            study(pt.load_case(SHORT), {"gravity.angle": values}, BEAM)
        assert str(refused.value) == message


def test_senseless_arguments_are_named() -> None:
    """Reference: by construction. Python has the messages of case files."""
    case = pt.load_case(COARSE)
    with pytest.raises(pt.BadInput, match="--models: names no model; give 'kantorovich-4', "):
        pt.run_case(case, models=[])
    for value in (float("nan"), float("inf")):
        with pytest.raises(pt.BadInput, match=f"joint.play: must be a finite number, got {value}$"):
            pt.change(case, **{"joint.play": value})


def test_nothing_heavy_comes_with_the_import() -> None:
    told = f"import sys, protractile; print(sorted({set(HEAVY)} & set(sys.modules)))"
    assert python("-c", told).stdout.strip() == "[]"


def test_every_name_is_documented_and_no_other_is_known() -> None:
    assert [name for name in dir(pt) if not inspect.getdoc(getattr(pt, name))] == []
    with pytest.raises(AttributeError, match=r"^module 'protractile' has no attribute 'bom'$"):
        _ = pt.bom


def examples_of(thing: object) -> list[doctest.DocTest]:
    return [test for test in doctest.DocTestFinder().find(thing) if test.examples]


@pytest.fixture(scope="module")
def at_hand() -> dict[str, Any]:
    """Return the names for all examples: the packages, a ball as ``GapSystem``, a ``Boom``."""
    names: dict[str, Any] = {"np": np, "pt": pt, "replace": replace, "simulate": simulate}
    for described in (GapSystem, pt.Boom):
        example = examples_of(described)[0]
        example.globs |= names
        doctest.DocTestRunner().run(example, clear_globs=False)
        names |= {name: example.globs[name] for name in ("ball", "boom") if name in example.globs}
    return names


@pytest.mark.parametrize("name", EXPLAINED)
def test_examples_in_docstrings_hold(name: str, at_hand: dict[str, Any]) -> None:
    for example in examples_of(import_module(name)):
        example.globs |= at_hand
        assert doctest.DocTestRunner().run(example).failed == 0


STEEL = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
BOX = pt.BoxSection(height=0.4, width=0.3, flange=0.01, web=0.01)
ARM = pt.Segment.of_section("arm", 0.0, 8.0, STEEL, BOX, supports=(pt.Support(0.0, "clamped"),))
BOOM = pt.Boom([ARM])
HEXAGON = {"height": 0.36, "width": 0.26, "top": 0.006, "bottom": 0.006, "web": 0.006}
COARSE_CASE = pt.load_case(pt.CASES / "coarse.toml")
NO_CASE = "case: case: must be a Case, such as load_case returns, got {!r}"
NO_NAMES = "case: models: must be a list of names, got 'beam'"


@pytest.mark.parametrize(
    ("call", "line"),
    [
        *((lambda call=call: call(None), NO_CASE.format(None))
          for call in (pt.change, pt.check, pt.run_case, pt.frequencies)),
        (lambda: pt.sweep("x", {"time.duration": [1.0]}), NO_CASE.format("x")),
        (lambda: pt.sweep(COARSE_CASE, {"time.duration": [1.0]}, "beam"), NO_NAMES),
        (lambda: pt.sweep(COARSE_CASE, "time.duration=1"),
         "case: vary: must be a dictionary of keys and lists of numbers, got 'time.duration=1'"),
        (lambda: pt.run_case(COARSE_CASE, "beam"), NO_NAMES),
        (lambda: pt.frequencies(COARSE_CASE, models="beam"), NO_NAMES),
        (lambda: pt.load_case(None),
         "case: source: must be a path or a dictionary, got None"),
        (lambda: pt.tables("x"), "results: results: must be Results, got 'x'"),
        (lambda: pt.Boom(None), "segments: must be a list or a tuple, got None"),
        (lambda: pt.Boom([ARM], loads=[pt.Load(3, "z", 1.0, 8.0, pt.Step())]),
         "loads[0].segment: 3 is no segment; give 'arm'"),
        (lambda: pt.Segment.of_section("arm", 0.0, 8.0, STEEL, None),
         "Segment.section: must be a section such as a BoxSection, got None"),
        (lambda: pt.hexagon(flat="0.1", **HEXAGON),
         "hexagon.flat: must be a finite number, got '0.1'"),
        (lambda: pt.closed_polygon(None, [0.01]), "corners must be a sequence, got None"),
        (lambda: pt.BoxSection(None, 0.3, 0.01, 0.01),
         "height must be a positive number of m, got None"),
        (lambda: pt.with_weight("x"), "with_weight.boom: must be a Boom, got 'x'"),
        (lambda: pt.with_weight(BOOM, angle=[30.0]),
         "with_weight.angle: must be a finite number, got [30.0]"),
        (lambda: pt.with_weight(BOOM, acceleration=-1.0),
         "GravityTable.acceleration: must be a number not less than 0, got -1.0"),
        (lambda: pt.BeamElements(BOOM).simulate(0.1, at_rest="no"),
         "at_rest must be True or False, got 'no'"),
        *((lambda ratio=ratio: pt.BeamElements(BOOM).simulate(0.1, damping_ratio=ratio),
           f"damping_ratio must be at least 0 and below 1, got {ratio!r}") for ratio in (2.0, "x")),
        (lambda: pt.TableContact("x", (1.0,)),
         "depths and forces must be sequences of finite numbers"),
    ],
)  # fmt: skip
def test_another_object_is_refused(call: Callable[[], object], line: str) -> None:
    """Reference: exact words."""
    with pytest.raises((pt.BadInput, ValueError)) as error:
        call()
    assert str(error.value) == line


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"name": ()}, r"the motion has no output \(\); it has tip, "),
        ({"name": "mast"}, "the motion has no output 'mast'; it has tip, "),
        ({"other": None}, "other must be a Trajectory, got None"),
        ({"until": "end"}, "until must be after the first time, got 'end' s"),
    ],
)
def test_motions_are_compared_by_an_output(change: dict[str, Any], line: str) -> None:
    """Reference: exact words."""
    motion = pt.BeamElements(BOOM).simulate(0.01)
    with pytest.raises(ValueError, match=line):
        motion.compare(**{"other": motion, **change})

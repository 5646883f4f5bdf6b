# SPDX-License-Identifier: LGPL-3.0-or-later
"""Calibrated beams, from the case file to the motion."""

import json
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="a shell calibrates them")

from mpi4py import MPI

from protractile.beam_model.calibration import elastic_compliance
from protractile.cases import run_case
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.runs.case import reading as case_file
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext, BuiltModel
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.run import run_case as run_models
from protractile.runs.report.additions import Addition
from protractile.runs.report.output import write
from studies.motions import move
from studies.working_load import Point, set_point
from tests.runs.case_texts import COARSE, elements, read_case, table

pytestmark = pytest.mark.slow

CONTACT = {"contact": {"stiffness": 1e9, "exponent": 1.0}}
SHELL = {"calibrated_by": "shell"} | CONTACT
SERIES = {"kind": "kantorovich", "terms": [12, 12], "base": "complete"}
CALIBRATED = (
    table("[[model]]", name="series", **SERIES, **CONTACT)
    + elements("sprung", **SHELL)
    + elements("fielded", section_fields=True, **SHELL)
    + table("[[model]]", name="sprung-series", **SERIES, **SHELL)
)
# What rubs makes motions comparable pointwise.
RUBBING = COARSE.replace(
    "exponent = 2.0\n", "exponent = 2.0\nfriction = 0.2\nnormal_forces = [4500.0, 5000.0]\n", 1
)


@pytest.fixture(name="case", scope="module")
def _case(tmp_path_factory: pytest.TempPathFactory) -> Case:
    return read_case(tmp_path_factory.mktemp("case"), RUBBING + CALIBRATED)


@pytest.fixture(name="built", scope="module")
def _built(case: Case, tmp_path_factory: pytest.TempPathFactory) -> dict[str, BuiltModel]:
    boom, cache = build_boom(case), Cache(tmp_path_factory.mktemp("cache"))
    wanted = ("timoshenko", "series", "shell", "sprung", "fielded", "sprung-series")
    return {
        model.name: build(case, boom, model, BuildContext(MPI.COMM_SELF, cache=cache))
        for model in case.models
        if model.name in wanted
    }


def tip(system: GapSystem) -> Array:
    """Return the tip at a small play and ten times the load."""
    point = set_point(system, Point(play=4.0e-3, load=10.0))
    return np.asarray(move(point, 1.5).data["tip"].values)


def test_a_calibrated_beam_gives_way_as_the_shell(built: dict[str, BuiltModel]) -> None:
    """Reference: other code, the static compliance of the shell at contact and friction rows."""
    shell = elastic_compliance(built["shell"].system)
    sizes = np.sqrt(np.outer(np.diag(shell), np.diag(shell)))

    def error(name: str) -> float:
        return float(np.abs((elastic_compliance(built[name].system) - shell) / sizes).max())

    assert error("sprung") < 1e-3
    assert error("sprung-series") < 1e-3
    assert error("fielded") < 1e-9


def test_it_moves_as_the_shell(built: dict[str, BuiltModel]) -> None:
    """Reference: other code, the shell's tip, by its range. Textbook beams err much more."""
    shell = tip(built["shell"].system)

    def error(name: str) -> float:
        return float(np.abs(tip(built[name].system) - shell).max() / np.ptp(shell))

    names = ("timoshenko", "series", "sprung", "fielded", "sprung-series")
    errors = {name: error(name) for name in names}
    assert errors["sprung"] < 0.012, errors
    assert errors["timoshenko"] > 2.5 * errors["sprung"], errors
    assert errors["fielded"] < 1e-3, errors
    assert errors["series"] > 1.5 * errors["sprung-series"], errors


def test_all_read_the_same_shell(built: dict[str, BuiltModel]) -> None:
    """Reference: non-regression, a single entry of the cache."""
    assert "reduction" in built["shell"].seconds
    for name in ("sprung", "fielded", "sprung-series"):
        assert "cache" in built[name].seconds
        assert built[name].seconds["calibration"] < 10.0


def test_a_case_without_its_shell_still_has_it(case: Case, tmp_path: Path) -> None:
    """Reference: the table of the named shell, after writing and reading the case."""
    alone = case_file.select(case, "", ["sprung"], 0.5)
    (model,) = alone.models
    assert model.needs_shell
    (read,) = read_case(tmp_path, toml.dumps(alone)).models
    shell = read.model_dump()["calibrated_by"]
    assert (shell["name"], shell["mesh_size"]) == ("shell", 0.5)
    assert isinstance(read.calibrated_by, Shell)


def test_runs_answer_as_the_shell(case: Case) -> None:
    """Reference: other code, the first modes of the shell with closed contacts."""
    case = case.model_copy(update={"time": case.time.model_copy(update={"duration": 0.02})})
    results = run_case(case, ["shell", "sprung", "fielded"])
    assert results.summary.failures == {}
    shell, sprung, fielded = (
        [row.value for row in results.rows.where(model=name, play=True, quantity="frequency")[:2]]
        for name in ("shell", "sprung", "fielded")
    )
    assert sprung == pytest.approx(shell, rel=1e-3)
    assert fielded == pytest.approx(shell, rel=1e-6)


@pytest.mark.usefixtures("few_figures")
def test_a_run_leaves_its_card(case: Case, tmp_path: Path) -> None:
    """Reference: non-regression, the calibration in the summary."""
    alone = case_file.select(case, "", ["sprung"])
    run = run_models(alone, "", RunContext(MPI.COMM_SELF))
    run.evaluate()
    write(run, Addition(), tmp_path)
    told = json.loads((tmp_path / "calibration.json").read_text(encoding="utf-8"))
    summary = run.results.summary.models["sprung"].calibration
    assert told == {"sprung": summary.model_dump()}
    report = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Local springs of the stations, for sprung" in report
    assert "Equivalent beam stiffnesses of the segments, for sprung" in report

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Equal results on two ranks, error messages printed once, and short runs of all shipped cases."""

import subprocess
from collections.abc import Callable
from html import unescape
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.run import run_case
from protractile.runs.report import figures
from protractile.runs.report.additions import Addition
from protractile.runs.report.document import render
from protractile.runs.report.figures import figures_of
from tests import at_once
from tests.system.run_folder import (
    COARSE,
    ROOT,
    protractile,
    summary_of,
)
from tests.unprinted import ONE_BLANK_FIGURE

pytestmark = pytest.mark.slow


Ranks = Callable[..., subprocess.CompletedProcess[str]]

# Commands one after another, with pictures and most figures left out for the sake of time.
COMMANDS = f"""
{ONE_BLANK_FIGURE}
import sys
from protractile.runs import cli
from protractile.runs.process import workers
from protractile.runs.report import snapshots
from tests import at_once

workers.workers = at_once.workers
snapshots.render_files = lambda *_: []
for command in sys.argv[1:]:
    try:
        cli.main(command.split())
    except SystemExit as ended:
        if ended.code:
            raise
"""

# One rank fails while the other waits for it, and does not wait long for the other to speak.
LONELY_FAILURE = """
from mpi4py import MPI
from protractile.dynamics.failure import NumericsError
from protractile.runs.process.ranks import end_all_ranks_on_error
from protractile.runs.process import ending

ending._GRACE_OF_RANKS = 0.5
comm = MPI.COMM_WORLD
with end_all_ranks_on_error(comm):
    if comm.rank == 1:
        raise NumericsError("case.toml: model[1]: no number is finite")
    comm.Barrier()
"""


def complaints(answer: subprocess.CompletedProcess[str]) -> list[str]:
    """Return the messages of the command, without those of the launcher."""
    return [line for line in answer.stderr.splitlines() if line.startswith("protractile: ")]


def test_two_ranks_run_shells_and_beams_as_one_does(
    two_ranks: Ranks, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: one rank, to the last bit, while the boom slews."""
    monkeypatch.setattr("protractile.runs.process.workers.workers", at_once.workers)
    monkeypatch.setattr("protractile.runs.report.snapshots.render_files", lambda *arguments: [])
    monkeypatch.setattr(figures, "FIGURES", figures.FIGURES[-1:])
    text = Path(COARSE).read_text(encoding="utf-8").replace("duration = 0.6", "duration = 0.02")
    text = text.replace("play = 0.014", "play = 0.014\nlateral_play = 0.01")
    text += "\n[gravity]\nangle = 30.0\n\n[slew]\ntravel = 1.0\nspeed = 10.0\nramp = 0.05\n"
    (tmp_path / "slew.toml").write_text(text, encoding="utf-8")
    options = "--models beam-fe,shell --mesh-size 1 --no-cache --out"
    one, two = tmp_path / "one", tmp_path / "two"
    assert protractile("run", tmp_path / "slew.toml", *options.split(), one) == 0
    answer = two_ranks(COMMANDS, f"run slew.toml {options} two")
    assert (answer.returncode, complaints(answer)) == (0, [])
    assert answer.stdout.count("two/report.html") == 1
    alone, shared = (summary_of(folder)["models"] for folder in (one, two))
    for model in (*alone.values(), *shared.values()):
        del model["wall_time"], model["seconds"]
    assert alone == shared
    for file in ("trajectories.nc", "fields.nc", "stress.nc"):
        found, expected = (xr.load_dataset(run / file, engine="scipy") for run in (two, one))
        xr.testing.assert_equal(found, expected)


# Commands, what each prints once, and its exit status.
PRINTING = (
    ("--version", "protractile 0.", 0),
    ("prove runs/cases/crane-proof.toml", "Proof of a truck crane boom", 1),
    ("check runs/cases/coarse.toml", "The paper's boom, coarse and short", 0),
    ("export runs/cases/coarse.toml --to opensees --model beam-fe --out x.py", "x.py", 0),
    ("run nowhere.toml", "", 2),
)
STATUSES = f"""
import sys
from protractile.runs import cli
for command in sys.argv[1:]:
    try:
        cli.main(command.replace("runs/", "{ROOT}/runs/").split())
    except SystemExit as ended:
        print(f"status {{ended.code}}")
"""


def test_two_ranks_print_once(two_ranks: Ranks) -> None:
    """Reference: one rank, which prints each line once. The first rank has the exit status."""
    answer = two_ranks(STATUSES, *(command for command, _, _ in PRINTING))
    assert answer.returncode == 0
    lines = [line for line in answer.stdout.splitlines() if line.startswith("status ")]
    assert lines == [f"status {status}" for _, _, status in PRINTING]
    for command, once, _ in PRINTING:
        assert not once or answer.stdout.count(once) == 1, command
    assert complaints(answer)[-1] == (
        "protractile: nowhere.toml: file: does not exist; give the path of a case file"
    )
    assert len(complaints(answer)) == len({*complaints(answer)})


def test_failure_of_one_rank_ends_both(two_ranks: Ranks) -> None:
    answer = two_ranks(LONELY_FAILURE)
    assert answer.returncode == 3
    assert complaints(answer) == ["protractile: case.toml: model[1]: no number is finite"]


@pytest.mark.usefixtures("unprinted")
@pytest.mark.parametrize("name", ["friction-walk", "spatial"])
def test_a_case_runs_and_is_reported(name: str, tmp_path: Path) -> None:
    """Reference: the other models, which agree up to the first contact."""
    file = str(CASES / f"{name}.toml")
    whole = case_file.load(file)
    mesh_size = 0.5 if any(model.needs_shell for model in whole.models) else None
    case = case_file.select(whole, file, mesh_size=mesh_size, members=0)
    short = case.time.model_copy(update={"duration": 0.15})
    # As the command does it: a shell that calibrates beams is reduced once.
    means = RunContext(MPI.COMM_SELF, cache=Cache(tmp_path / "cache"))
    run = run_case(case.model_copy(update={"time": short}), file, means)
    run.evaluate()
    results = run.results
    page = render(results, Addition(), figures_of(results), [])
    assert case.title in unescape(page)
    assert ("Tip, lateral (y)" in page) == (name == "spatial")
    models = results.summary.models
    assert list(models) == [model.name for model in case.models]
    assert max(model.energy_residual for model in models.values()) < 1e-3
    with_play = [
        str(model)
        for model in results.trajectories["model"].values
        if not str(model).endswith("bonded")
    ]
    tips = results.trajectories["tip"].sel(model=with_play).values
    before = results.trajectories["time"].values < 0.11
    # Nothing touches yet. The inner segment is free, or bends under friction, for which the
    # shortest series have no function.
    falling = tips[:, before]
    alike = 0.1 if any(joint.friction > 0.0 for joint in case.joints) else 0.02
    assert np.ptp(falling, axis=0).max() < alike * np.ptp(falling)

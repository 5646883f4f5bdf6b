# SPDX-License-Identifier: LGPL-3.0-or-later
"""Equal results on two ranks, on one and on several cores, and messages that are printed once."""

import json
import re
import subprocess
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import xarray as xr
from PIL import Image

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from tests.conftest import ranks_in
from tests.shell_model.on_ranks import everything
from tests.system.run_folder import ROOT, files, protractile, summary_of, write_coarse
from tests.unprinted import ONE_BLANK_FIGURE

pytestmark = pytest.mark.slow


# Commands one after another, with one figure for the sake of time, and the results of shells.
COMMANDS = f"""
{ONE_BLANK_FIGURE}
import json, sys
from mpi4py import MPI
from protractile.runs import cli
from tests.shell_model.on_ranks import everything
for command in sys.argv[1:]:
    try:
        cli.main(command.replace("runs/", "{ROOT}/runs/").split())
    except SystemExit as ended:
        print(f"status {{ended.code}}")
answer = everything(MPI.COMM_WORLD)
if MPI.COMM_WORLD.rank == 0:
    print(json.dumps(answer))
"""
RUN = "run slew.toml --models beam-fe,shell --mesh-size 1 --no-cache --no-pictures --out"
MODELS = "--models", "kantorovich-4,beam-fe-bonded"
PLAYS = "--vary", "joint.play=0.006:0.014:3"
# Commands, what each prints once, and its exit status.
PRINTING = (
    (f"{RUN} two", "two/report.html", 0),
    (f"sweep case.toml {' '.join((*PLAYS, *MODELS))} --out swept", "swept/sweep.csv", 0),
    ("--version", "protractile 0.", 0),
    ("prove runs/cases/crane-proof.toml", "Proof of a truck crane boom", 1),
    ("check runs/cases/coarse.toml", "The paper's boom, coarse and short", 0),
    ("export runs/cases/coarse.toml --to opensees --model beam-fe --out x.py", "x.py", 0),
    ("run nowhere.toml", "", 2),
)

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


class OnRanks(NamedTuple):
    """All commands on two ranks, in one start, since each start imports for seconds."""

    folder: Path
    answer: subprocess.CompletedProcess[str]


@pytest.fixture(scope="module")
def on_ranks(tmp_path_factory: pytest.TempPathFactory) -> OnRanks:
    folder = tmp_path_factory.mktemp("ranks")
    text = write_coarse(folder, 0.02).read_text(encoding="utf-8")
    text = text.replace("play = 0.014", "play = 0.014\nlateral_play = 0.01")
    text += "\n[gravity]\nangle = 30.0\n\n[slew]\ntravel = 1.0\nspeed = 10.0\nramp = 0.05\n"
    (folder / "slew.toml").write_text(text, encoding="utf-8")
    write_coarse(folder, 0.2)
    answer = ranks_in(folder)(2, COMMANDS, *(command for command, _, _ in PRINTING))
    assert answer.returncode == 0, answer.stderr
    return OnRanks(folder, answer)


@pytest.mark.usefixtures("few_figures", "unprinted")
def test_two_ranks_run_shells_and_beams_as_one_does(
    on_ranks: OnRanks, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: one rank, to the last bit, while the boom slews."""
    monkeypatch.chdir(on_ranks.folder)
    assert protractile(*RUN.split(), "one") == 0
    one, two = (summary_of(Path(folder)) for folder in ("one", "two"))
    for model in (*one["models"].values(), *two["models"].values()):
        del model["wall_time"], model["seconds"]
    assert one["models"] == two["models"]
    # Pictures can be left to later.
    later = "not requested; protractile snapshot draws them"
    assert one["snapshots"] == two["snapshots"] == {"written": {}, "skipped": later}
    assert on_ranks.answer.stdout.count(f"\nno snapshots: {later}\n") == 1
    for file in ("trajectories.nc", "fields.nc", "stress.nc"):
        alone, shared = (xr.load_dataset(f"{run}/{file}", engine="scipy") for run in ("one", "two"))
        xr.testing.assert_equal(alone, shared)


def test_two_ranks_print_once(on_ranks: OnRanks) -> None:
    """Reference: one rank, which prints each line once. The first rank has the exit status."""
    said = re.split("^status (.*)\n", on_ranks.answer.stdout, flags=re.MULTILINE)
    assert said[1::2] == [str(status) for _, _, status in PRINTING]
    for (command, once, _), text in zip(PRINTING, said[::2], strict=False):
        assert not once or text.count(once) == 1, command
    *of_proof, of_file = complaints(on_ranks.answer)
    assert len(of_proof) == len({*of_proof})
    assert all("/crane-proof.toml: " in line for line in of_proof)
    assert of_file == (
        "protractile: nowhere.toml: file: does not exist; give the path of a case file"
    )


def test_ranks_give_the_serial_results_of_shells(on_ranks: OnRanks) -> None:
    """Reference: one rank, to the last bit; buckling factors to 1e-8."""
    serial = everything(MPI.COMM_SELF)
    found = json.loads(on_ranks.answer.stdout.strip().splitlines()[-1])
    assert found["rubbing"] == serial["rubbing"]
    assert np.count_nonzero(serial["rubbing"]["friction_rows"]) > 0
    assert np.abs(serial["rubbing"]["stresses"]).max() > 1.0e4
    assert found["accelerated"] == serial["accelerated"]
    assert 0.0 < serial["buckled"][0] < serial["buckled"][1]
    assert found["buckled"] == pytest.approx(serial["buckled"], rel=1.0e-8)
    # Analytic: the dofs of vertices and edges, each once for any partition.
    assert found["dofs"] == serial["dofs"] == [780, 2220]


def test_failure_of_one_rank_ends_both(tmp_path: Path) -> None:
    answer = ranks_in(tmp_path)(2, LONELY_FAILURE)
    assert answer.returncode == 3
    assert complaints(answer) == ["protractile: case.toml: model[1]: no number is finite"]


def stamps(folder: Path) -> dict[str, int]:
    """Return the inode of each point's file, which changes when the file is written again."""
    return {path.name: path.stat().st_ino for path in (folder / "points").glob("[!.]*")}


def test_a_sweep_leaves_its_files_on_cores_and_ranks_and_is_taken_up(
    on_ranks: OnRanks,
    here: Path,
    capsys: pytest.CaptureFixture[str],
    request: pytest.FixtureRequest,
) -> None:
    case, out, of_ranks = write_coarse(here, 0.2), Path("out"), on_ranks.folder / "swept"
    assert protractile("sweep", case, *PLAYS, *MODELS, "--out", "out") == 0
    said = capsys.readouterr().out
    assert said.splitlines()[0] == "out/sweep.csv"
    assert "Sweep over joint.play: 3 points" in said
    before = stamps(out)
    assert len(before) == 3
    assert before.keys() == stamps(of_ranks).keys()
    assert (out / "sweep.csv").read_bytes() == (of_ranks / "sweep.csv").read_bytes()
    expected = {".manifest", "report.html", "sweep.nc", "sweep.csv"}
    expected |= {"figures/sweep-lines.png", *(f"points/{name}" for name in before)}
    assert files(out) == expected
    with Image.open("out/figures/sweep-lines.png") as image:
        image.verify()
    request.getfixturevalue("in_this_process")
    more = "--vary", "joint.play=0.006:0.014:5"
    assert protractile("sweep", case, *more, *MODELS, "--out", "out") == 0
    assert capsys.readouterr().err == ""
    after = stamps(out)
    assert len(after) == 5
    assert before.items() <= after.items()

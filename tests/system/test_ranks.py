# SPDX-License-Identifier: LGPL-3.0-or-later
"""Equal results on two ranks, and messages that are printed once."""

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
import xarray as xr

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")


from tests.system.run_folder import (
    ROOT,
    protractile,
    summary_of,
    write_coarse,
)
from tests.unprinted import ONE_BLANK_FIGURE

pytestmark = pytest.mark.slow


Ranks = Callable[..., subprocess.CompletedProcess[str]]

# Commands one after another, with one figure for the sake of time.
COMMANDS = f"""
{ONE_BLANK_FIGURE}
import sys
from protractile.runs import cli
for command in sys.argv[1:]:
    try:
        cli.main(command.replace("runs/", "{ROOT}/runs/").split())
    except SystemExit as ended:
        print(f"status {{ended.code}}")
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


@pytest.mark.usefixtures("few_figures")
def test_two_ranks_run_shells_and_beams_as_one_does(two_ranks: Ranks, here: Path) -> None:
    """Reference: one rank, to the last bit, while the boom slews."""
    text = write_coarse(here, 0.02).read_text(encoding="utf-8")
    text = text.replace("play = 0.014", "play = 0.014\nlateral_play = 0.01")
    text += "\n[gravity]\nangle = 30.0\n\n[slew]\ntravel = 1.0\nspeed = 10.0\nramp = 0.05\n"
    Path("slew.toml").write_text(text, encoding="utf-8")
    run = "run slew.toml --models beam-fe,shell --mesh-size 1 --no-cache --no-pictures --out "
    assert protractile(*f"{run}one".split()) == 0
    answer = two_ranks(COMMANDS, f"{run}two")
    assert complaints(answer) == []
    assert answer.stdout.count("status 0\n") == answer.stdout.count("two/report.html") == 1
    one, two = (summary_of(Path(folder))["models"] for folder in ("one", "two"))
    for model in (*one.values(), *two.values()):
        del model["wall_time"], model["seconds"]
    assert one == two
    for file in ("trajectories.nc", "fields.nc", "stress.nc"):
        alone, shared = (xr.load_dataset(f"{run}/{file}", engine="scipy") for run in ("one", "two"))
        xr.testing.assert_equal(alone, shared)


# Commands, what each prints once, and its exit status.
PRINTING = (
    ("--version", "protractile 0.", 0),
    ("prove runs/cases/crane-proof.toml", "Proof of a truck crane boom", 1),
    ("check runs/cases/coarse.toml", "The paper's boom, coarse and short", 0),
    ("export runs/cases/coarse.toml --to opensees --model beam-fe --out x.py", "x.py", 0),
    ("run nowhere.toml", "", 2),
)


def test_two_ranks_print_once(two_ranks: Ranks) -> None:
    """Reference: one rank, which prints each line once. The first rank has the exit status."""
    answer = two_ranks(COMMANDS, *(command for command, _, _ in PRINTING))
    assert answer.returncode == 0
    statuses = re.findall("^status (.*)$", answer.stdout, re.MULTILINE)
    assert statuses == [str(status) for _, _, status in PRINTING]
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

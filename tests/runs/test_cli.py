# SPDX-License-Identifier: LGPL-3.0-or-later
"""All commands, and one line on stderr and an exit status for each error of a user."""

import errno
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple
from unittest.mock import Mock

import pytest

from protractile.dynamics.trajectory import Trajectory
from protractile.runs import cli
from protractile.runs.folder.cache import VARIABLE
from protractile.runs.paper.rules import judge
from protractile.runs.pipeline.models import MotionPlan
from protractile.runs.pipeline.results import Results
from protractile.runs.process.ranks import launcher
from tests.runs.case_texts import COARSE, edited
from tests.system.run_folder import python, write_coarse
from tests.unprinted import ONE_BLANK_FIGURE

pytestmark = pytest.mark.usefixtures("few_figures")

SERIES = "--models kantorovich-4,kantorovich-5"


class Answer(NamedTuple):
    status: int | str | None
    out: str
    err: str


Protractile = Callable[[str], Answer]


def told(status: int, line: str) -> Answer:
    return Answer(status, "", f"protractile: {line}\n")


@pytest.fixture
def protractile(here: Path, capsys: pytest.CaptureFixture[str]) -> Protractile:
    """Return a runner of commands in an empty folder with case.toml, the coarse case."""
    Path("case.toml").write_text(COARSE, encoding="utf-8")

    def run(command: str) -> Answer:
        with pytest.raises(SystemExit) as ended:
            cli.main(command.split())
        return Answer(ended.value.code, *capsys.readouterr())

    return run


def edit(*edits: tuple[str, str]) -> None:
    Path("case.toml").write_text(edited(COARSE, *edits), encoding="utf-8")


def in_a_process(
    folder: Path, *arguments: str, limit: int | None = None, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run Python in a folder with the coarse case, with limited memory in bytes if given."""
    write_coarse(folder, 0.2)
    keep = limit and partial(resource.setrlimit, resource.RLIMIT_AS, (limit, limit))
    return python(*arguments, folder=folder, prepare=keep, **environment)


MISTAKES = {
    "": "Missing command. (protractile --help tells more)",
    "run": "Missing argument 'CASE.toml'. (protractile --help tells more)",
    "fly case.toml": "No such command 'fly'. (protractile --help tells more)",
    f"run case.toml {SERIES} --out case.toml": "case.toml: --out case.toml: is a file; give a "
    "folder",
    f"run case.toml {SERIES} --out /proc/nowhere": "case.toml: --out /proc/nowhere: cannot be "
    "written (No such file or directory); give a folder that can",
    f"run case.toml {SERIES} --out .": "case.toml: --out .: contains other files; give a new "
    "folder or one of an earlier run",
    "run case.toml --mesh-size fine": "Invalid value for '--mesh-size': Input should be a valid "
    "number, unable to parse string as a number (protractile --help tells more)",
    "check case.toml --picture boom.pdf": "case.toml: --picture boom.pdf: must end in .png",
    "report nowhere": "nowhere: folder: does not exist; give the folder of a run",
    "report case.toml": "case.toml: folder: is a file; give the folder of a run",
}  # fmt: skip


@pytest.mark.parametrize("command", MISTAKES)
def test_a_mistake_is_one_line(protractile: Protractile, command: str) -> None:
    assert protractile(command) == told(2, MISTAKES[command])
    assert [path.name for path in Path.cwd().iterdir()] == ["case.toml"]


def test_failing_numerics_are_one_line_and_no_results(protractile: Protractile) -> None:
    edit(("duration = 0.6", "duration = 0.6\nstep = 1e-12"))
    line = "model[1]: a step of 1e-12 s makes 6e+11 steps; make it longer"
    assert protractile(f"run case.toml {SERIES} --out out --large") == told(3, f"case.toml: {line}")
    assert [path.name for path in Path.cwd().iterdir()] == ["case.toml"]
    edit(("load = 83.16", "load = 1e150"))
    line = "model[1]: a result is not finite; look for an extreme number of the case, for example "
    status, _, err = protractile("run case.toml --models beam-fe-bonded --out out")
    assert (status, err) == (3, f"protractile: case.toml: {line}in another unit\n")


@pytest.mark.parametrize("command", [f"run case.toml {SERIES}", "export case.toml --to opensees"])
def test_a_loop_of_links_is_one_line(protractile: Protractile, command: str) -> None:
    Path("loop").symlink_to("loop")
    line = "loop: file: cannot be used (Too many levels of symbolic links)"
    assert protractile(f"{command} --out loop") == told(2, line)
    assert Path("loop").is_symlink()


def test_a_temporary_folder_without_room_is_one_line(
    protractile: Protractile, monkeypatch: pytest.MonkeyPatch
) -> None:
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    monkeypatch.setenv("TMPDIR", "full")
    Path("full").mkdir()
    monkeypatch.setattr(os, "posix_fallocate", Mock(side_effect=full))
    what = "a shell needs 16 MB in 'full' (No space left on device); make room there, or set TMPDIR"
    line = f"case.toml: TMPDIR: {what} to another folder"
    assert protractile("run case.toml --models shell --out out") == told(2, line)
    assert sorted(path.name for path in Path.cwd().iterdir()) == ["case.toml", "full"]


def test_imports_without_memory_are_one_line(tmp_path: Path) -> None:
    command = "-m", "protractile", "check", "case.toml"
    ended = in_a_process(tmp_path, *command, limit=250_000 * 1024)
    assert ended.stderr.count("\n") == 1
    # Debian 13's OpenBLAS ends the process itself.
    if not ended.stderr.startswith("OpenBLAS error: Memory allocation still failed"):
        assert ended.returncode == 3
        assert ended.stderr.startswith("protractile: out of memory (")


@pytest.mark.usefixtures("unprinted")
def test_failed_demand_is_printed_and_sets_the_exit_status(protractile: Protractile) -> None:
    edit(("[time]", 'demand = ["S1", "S11"]\n\n[time]'))
    opening = "demand: S11 is undecided, and the case demands that it is reproduced: "
    for command, place in (
        (f"run case.toml {SERIES} --out out", "case.toml"),
        ("report out", "out"),
    ):
        status, _, err = protractile(command)
        assert (status, err.count("\n")) == (1, 1)
        assert err.startswith(f"protractile: {place}: {opening}")
    assert Path("out/report.html").exists()


@pytest.fixture
def without_fenicsx(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "dolfinx", None)
    monkeypatch.setitem(sys.modules, "mpi4py", None)


@pytest.mark.usefixtures("without_fenicsx")
def test_without_fenicsx_shells_are_refused_and_beams_exported(protractile: Protractile) -> None:
    """Reference: by hand, the last model of beam elements with play; a shell calibrates another."""
    status, out, err = protractile("run case.toml --out out")
    assert (status, out, err.count("\n")) == (2, "", 1)
    line = "model[6].kind: a shell needs FEniCSx, which cannot be imported "
    assert err.startswith(f"protractile: case.toml: {line}")
    line = "install it (pip install 'protractile[shell]', or Debian's python3-dolfinx), or run the "
    assert err.endswith(f"; {line}other models with --models\n")
    assert not Path("out").exists()
    assert protractile("export case.toml --to opensees") == (0, "case.py\n", "")
    edit(('name = "beam-fe"\n', 'name = "beam-fe"\ncalibrated_by = "shell"\n'))
    to = "export case.toml --to opensees --model"
    assert protractile(f"{to} beam-fe").err.endswith("or export another one with --model\n")
    line = "'shell' is no beam elements with play; give 'beam-fe' or 'timoshenko'"
    assert protractile(f"{to} shell") == told(2, f"case.toml: --model: {line}")


class WithoutLibrary:
    """A finder of modules that finds gmsh without a library of the system."""

    def find_spec(self, name: str, *_: object) -> None:
        if name == "gmsh":
            raise OSError("libGLU.so.1: cannot open shared object file: No such file or directory")


def test_a_missing_library_of_gmsh_is_one_line(
    protractile: Protractile, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Reference: the error of the loader without the library."""
    pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")
    for name in ("gmsh", "protractile.geometry.mesh", "protractile.shell_model.boom_shell"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setattr(sys, "meta_path", [WithoutLibrary(), *sys.meta_path])
    assert protractile("run case.toml --models shell --out out") == told(
        2,
        "case.toml: model[1].kind: a shell needs gmsh, which misses libGLU.so.1; "
        "install libgl1 libglu1-mesa libxft2 libxcursor1 libxinerama1, or a gmsh without X (pip "
        "install --force-reinstall -i https://gmsh.info/python-packages-dev-nox gmsh), or run the "
        "other models with --models",
    )


ENTER = "from protractile.runs.process.ranks import enter_mpi; enter_mpi(1, 'case.toml')"


def test_ranks_of_another_mpi_are_refused(tmp_path: Path) -> None:
    """Each of two processes that MPICH starts is the only rank of Open MPI."""
    pytest.importorskip("mpi4py", reason="ranks need mpi4py")
    variables = {"PMI_RANK": "0", "PMI_SIZE": "2"} if launcher() == "mpirun" else {"PMIX_RANK": "0"}
    ended = in_a_process(tmp_path, "-c", ENTER, **variables)
    line = "mpirun: the ranks were started by another MPI; start them by"
    assert ended.stderr.endswith(f"BadInput: case.toml: {line} {launcher()}\n")


@pytest.mark.slow
def test_beams_need_neither_fenicsx_nor_a_clean_environment(tmp_path: Path) -> None:
    """Reference: the first bytes of a PNG file (W3C 2003). Variables name a notebook's backend that
    is not installed, and a rank without a launcher.
    """
    program = f"""
import sys
for name in ("dolfinx", "mpi4py", "petsc4py", "ufl", "basix", "slepc4py"):
    sys.modules[name] = None
from protractile.runs.cli import main
try:
    main(["check", "case.toml", "--picture", "boom.png"])
except SystemExit as end:
    assert not end.code
{ONE_BLANK_FIGURE}
from protractile.runs.process import terminal
terminal.EVERY = float("inf")
main(["run", "case.toml", "--models", "timoshenko", "--out", "out"])
"""
    backend = {"MPLBACKEND": "module://matplotlib_inline.backend_inline"}
    ended = in_a_process(tmp_path, "-c", program, **backend, OMPI_COMM_WORLD_RANK="abc")
    assert (ended.returncode, ended.stderr) == (0, "")
    assert (tmp_path / "boom.png").read_bytes().startswith(b"\x89PNG")
    assert (tmp_path / "out" / "report.html").exists()


@pytest.fixture
def moved(monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory) -> list[int]:
    """Return the numbers of modes of integrated systems with play, with a cache of their own."""
    monkeypatch.setenv(VARIABLE, str(tmp_path_factory.mktemp("cache")))
    modes: list[int] = []
    move = MotionPlan.trajectory

    def count(plan: MotionPlan, progress: Any = None) -> Trajectory:
        if plan.motion.system.laws:
            modes.append(plan.motion.system.num_modes)
        return move(plan, progress)

    monkeypatch.setattr(MotionPlan, "trajectory", count)
    return modes


@pytest.mark.usefixtures("unprinted", "moved")
def test_other_models_are_written_and_the_failure_is_reported(protractile: Protractile) -> None:
    edit(('base = "as printed"', 'base = "as printed"\nstep = 1e-12'))
    why = "a step of 1e-12 s makes 6e+11 steps; make it longer"
    status, out, err = protractile(f"run case.toml {SERIES} --out out --large")
    assert (status, err) == (3, f"protractile: case.toml: model[1]: {why}\n")
    assert f"failed: kantorovich-4: {why}" in out
    results = Results.load(Path("out"))
    assert results.trajectories["model"].values.tolist() == ["kantorovich-5"]
    first = judge(results)[0]
    assert (first.id, first.verdict) == ("S1", "undecided")
    assert first.why == f"'kantorovich-4' failed: {why}."
    assert ">failed</td>" in Path("out/report.html").read_text(encoding="utf-8")
    assert protractile("report out").status == 0


@pytest.mark.usefixtures("unprinted")
def test_the_next_run_goes_on(
    protractile: Protractile, moved: list[int], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The first run is interrupted in its second model. Reference: an uninterrupted run."""
    command = f"run case.toml {SERIES} --out out"
    short = "duration = 0.6", "duration = 0.3\nstep = 1e-4"
    edit(short)
    assert protractile(f"{command} --no-cache").status == 0
    undisturbed = Path("out/trajectories.nc").read_bytes()
    assert moved == [4, 5]
    move = MotionPlan.trajectory

    def break_off(plan: MotionPlan, progress: Any = None) -> Trajectory:
        if plan.motion.system.num_modes == 5:
            raise OSError("broken off")
        return move(plan, progress)

    with monkeypatch.context() as patch:
        patch.setattr(MotionPlan, "trajectory", break_off)
        assert protractile(command).status == 2
    assert protractile(command).status == 0
    assert moved == [4, 5, 4, 5]
    assert Path("out/trajectories.nc").read_bytes() == undisturbed
    edit(short, ("load = 55.07", "load = 55.08"))
    assert protractile(command).status == 0
    assert moved == [4, 5, 4, 5, 4, 5]

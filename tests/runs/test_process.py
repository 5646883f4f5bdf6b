# SPDX-License-Identifier: LGPL-3.0-or-later
"""Output of commands on streams, the end of all ranks, and complete or absent files of a run."""

import io
import os
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from protractile.runs import CASES
from protractile.runs.folder.files import (
    MANIFEST,
    atomic_folder,
    atomic_path,
    find_damaged_file,
    folder_lock,
    modified_folder,
)
from protractile.runs.process import ending, terminal
from protractile.runs.process.terminal import LONGEST, message, shorten

ROOT = Path(__file__).parents[2]


@pytest.mark.slow
def test_closed_and_full_outputs_end_in_one_line_at_most() -> None:
    """The reader of the long schema closes the pipe early; letters of no terminal are replaced."""

    def in_a_shell(line: str) -> tuple[int, str, str]:
        done = subprocess.run(
            ["bash", "-o", "pipefail", "-c", f"{sys.executable} -m protractile {line}"],
            env=os.environ | {"PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "ascii"},
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stderr, done.stdout

    line = "protractile: output: file: cannot be used (No space left on device)\n"
    assert in_a_shell("schema >/dev/full") == (2, line, "")
    assert in_a_shell("schema | true") == (0, "", "")
    *ended, said = in_a_shell(f"check {CASES / 'coarse.toml'} 2>&-")
    assert ended == [0, ""]
    assert "The paper's boom, coarse and short" in said
    assert "\\u2212" in said


@given(st.text(st.characters(), max_size=2000))
def test_a_message_is_one_short_printable_line(text: str) -> None:
    line = message(text)
    assert line.startswith("protractile: ")
    assert line.isprintable()
    assert len(line) < LONGEST


def test_the_middle_goes_and_both_ends_stay() -> None:
    """Reference: analytic, the name of a file at the end of a long path; controls are escaped."""
    path = "/" + "long/" * 100 + "case.toml"
    assert shorten(path, 41) == "/long/long/long/lo ... ong/long/case.toml"
    assert shorten("a" * 41, 41) == "a" * 41
    assert shorten("a\x1b[31mb\u202ec\udcff é") == "a\\x1b[31mb\\u202ec\\udcff é"


def test_progress_shows_stage_and_remaining_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: by hand. After 40 % in 12 s, 18 s remain; nothing is printed again within 5 s."""
    every = 5.0
    monkeypatch.setattr(terminal, "EVERY", every)
    said: list[str] = []
    times: list[float] = [0.0]
    lines = terminal.ProgressLines(["beam", "shell"], "lift", said.append, lambda: times[-1])
    for now, model, stage, part in (
        (0.0, "beam", "build", 0.0),
        (0.1, "beam", "build", 1.0),
        (0.2, "shell", "reduction", 0.0),
        (12.2, "shell", "reduction", 0.4),
        (12.2 + 0.9 * every, "shell", "reduction", 0.5),
        (30.2, "shell", "reduction", 1.0),
        (40.0, "shell", "motion", 0.0),
        (50.0, "shell", "fields", 1.0),
        (60.0, "report", "pictures", 0.0),
    ):
        times.append(now)
        lines(model, stage, part)
    assert said == [
        "lift: shell (2 of 2): reduction 40 %, 18 s left",
        "lift: shell (2 of 2): reduction took 30 s",
        "lift: shell (2 of 2): motion started",
        "lift: shell (2 of 2): fields finished",
        "lift: report: pictures started",
    ]


def test_ranks_abort_after_their_line_is_read(monkeypatch: pytest.MonkeyPatch) -> None:
    """The reader is late, so that an immediate abort would precede the reading of the line."""
    reader, writer = os.pipe()
    read: list[bytes] = []
    at_abort: list[list[bytes]] = []

    def read_late() -> None:
        time.sleep(0.1)
        read.append(os.read(reader, 100))

    comm = SimpleNamespace(size=2, rank=0, Abort=lambda code: at_abort.append(list(read)))
    with os.fdopen(writer, "w") as stderr, ThreadPoolExecutor(1) as pool:
        pool.submit(read_late)
        for stream in (stderr, io.StringIO()):
            monkeypatch.setattr("sys.stderr", stream)
            with pytest.raises(AssertionError, match="MPI_Abort returned"):
                ending.fail("protractile: no number is finite", 3, comm)
    os.close(reader)
    assert at_abort == [[b"protractile: no number is finite\n"]] * 2


def contents(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): path.read_text(encoding="utf-8")
        for path in folder.rglob("*")
        if path.is_file() and path.name != MANIFEST
    }


def write(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(" ".join(names), encoding="utf-8")


@pytest.mark.parametrize("disk", ["Linux's own", "another"])
def test_a_folder_is_replaced_as_a_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, disk: str
) -> None:
    if disk == "another":
        monkeypatch.setattr("ctypes.PyDLL", lambda *_, **__: object())
    folder = tmp_path / "figures"
    for names in (("a.png", "b.png"), ("b.png", "deep/c.png")):
        with atomic_folder(folder) as part:
            write(part, *names)
        assert contents(folder) == dict.fromkeys(names, " ".join(names))
        write(folder, "mine")
        folder.chmod(0o750)
    assert folder.stat().st_mode & 0o777 == 0o750
    assert [p.name for p in tmp_path.iterdir()] == ["figures"]


@pytest.mark.parametrize("kind", ["file", "folder"])
def test_failing_write_keeps_the_old_file(tmp_path: Path, kind: str) -> None:
    """Only complete files get their names."""
    place = tmp_path / "place.json"
    file = Path("") if kind == "file" else Path("a.png")

    def write_and(fail: Callable[[], object]) -> None:
        with (atomic_path if kind == "file" else atomic_folder)(place) as part:
            assert (part.suffix == place.suffix) == (kind == "file")
            (part / file).write_text(f"by {fail}", encoding="utf-8")
            fail()

    def fill_the_disk() -> None:
        raise OSError(28, "No space left on device")

    write_and(list)
    with pytest.raises(OSError, match="No space left on device") as failed:
        write_and(fill_the_disk)
    assert failed.value.filename == str(place)
    assert (place / file).read_text(encoding="utf-8") == f"by {list}"
    assert [p.name for p in tmp_path.iterdir()] == [place.name]


def test_changed_folder_keeps_other_files(tmp_path: Path) -> None:
    folder = tmp_path / "out"
    with atomic_folder(folder) as part:
        write(part, "data", "report")
    write(folder, "mine", "deep/mine")
    (folder / "empty").mkdir()
    (folder / "link").symlink_to("nowhere")
    os.mkfifo(folder / "pipe")
    with (
        folder_lock(folder),
        modified_folder(folder) as part,
        atomic_path(part / "report") as report,
    ):
        report.write_text("again", encoding="utf-8")
    mine = dict.fromkeys(("mine", "deep/mine"), "mine deep/mine")
    assert contents(folder) == {"data": "data report", "report": "again", **mine}
    assert (folder / "empty").is_dir()
    assert os.readlink(folder / "link") == "nowhere"
    assert (folder / "pipe").is_fifo()
    *listed, _ = (folder / MANIFEST).read_text(encoding="utf-8").splitlines()
    assert [line.split()[1] for line in listed] == ["data", "report"]
    assert find_damaged_file(folder) is None
    (folder / "data").write_text("other", encoding="utf-8")
    assert find_damaged_file(folder) == "data"


@pytest.mark.parametrize(
    "damage",
    [
        lambda manifest, content: manifest.write_bytes(content[: len(content) // 2]),
        lambda manifest, content: manifest.write_bytes(b""),
        lambda manifest, content: manifest.write_bytes(content.replace(b"d", b"e", 1)),
        lambda manifest, content: os.mkfifo(manifest),
        lambda manifest, content: manifest.mkdir(),
    ],
)
def test_a_damaged_manifest_hides_no_damage(
    tmp_path: Path, damage: Callable[[Path, bytes], object]
) -> None:
    """Reference: by construction. The manifest is cut, changed, or no regular file."""
    folder = tmp_path / "out"
    with atomic_folder(folder) as new:
        write(new, "data", "report")
    manifest = folder / MANIFEST
    content = manifest.read_bytes()
    (folder / "data").write_text("other", encoding="utf-8")
    manifest.unlink()
    assert find_damaged_file(folder) is None
    damage(manifest, content)
    assert find_damaged_file(folder) == MANIFEST


def test_folder_is_restored_after_a_killed_exchange(tmp_path: Path) -> None:
    """The process is killed between the two renames of a file system without exchange."""
    folder = tmp_path / "out"
    with atomic_folder(folder) as part:
        write(part, "earlier")
    folder.rename(tmp_path / ".out.away")
    with folder_lock(folder):
        assert contents(folder) == {"earlier": "earlier"}


def test_folder_changes_exclude_each_other(tmp_path: Path) -> None:
    """Reference: by construction. The folder is replaced after the lock is released."""
    folder = tmp_path / "out"

    def replace() -> None:
        with atomic_folder(folder) as part:
            write(part, "later")

    with ThreadPoolExecutor(1) as pool:
        with folder_lock(folder):
            other = pool.submit(replace)
            time.sleep(0.1)
            assert not other.done()
        other.result()
    assert contents(folder) == {"later": "later"}


def test_leftovers_of_killed_processes_only_are_removed(tmp_path: Path) -> None:
    """Processes create a folder, print its path, and continue at a line of input."""
    folder, mine = tmp_path / "out", tmp_path / ".out.mine"
    mine.mkdir()
    program = f"""
from pathlib import Path
from protractile.runs.folder.files import scratch_folder
with scratch_folder(Path({str(folder)!r})) as part:
    (part / "half").write_text("half")
    print(part, flush=True)
    input()
"""
    keys: dict[str, Any] = dict.fromkeys(("stdin", "stdout"), subprocess.PIPE) | {"text": True}
    keys["env"] = os.environ | {"PYTHONPATH": str(ROOT)}
    killed, live = (subprocess.Popen([sys.executable, "-c", program], **keys) for _ in range(2))
    parts = [Path(process.stdout.readline().strip()) for process in (killed, live)]
    killed.kill()
    killed.wait()
    assert all((part / "half").exists() for part in parts)
    with atomic_folder(folder) as part:
        write(part, "whole")
    assert sorted(tmp_path.iterdir()) == sorted([folder, mine, parts[1]])
    live.communicate("\n")
    assert sorted(tmp_path.iterdir()) == sorted([folder, mine])

# SPDX-License-Identifier: LGPL-3.0-or-later
"""A file of a run is whole or not there, whatever interrupts the writing."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from runs.files import whole, whole_folder

pytestmark = pytest.mark.quick

ROOT = Path(__file__).parents[2]


def test_a_file_gets_its_name_when_it_is_complete(tmp_path: Path) -> None:
    path = tmp_path / "summary.json"
    with whole(path) as part:
        part.write_text("{}", encoding="utf-8")
        assert part.suffix == path.suffix
        assert not path.exists()
    assert [p.name for p in tmp_path.iterdir()] == ["summary.json"]


def test_a_failing_write_leaves_the_file_that_was_there(tmp_path: Path) -> None:
    path = tmp_path / "summary.json"
    path.write_text("earlier", encoding="utf-8")

    def fill_the_disk() -> None:
        with whole(path) as part:
            part.write_text("half", encoding="utf-8")
            raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space left on device") as failed:
        fill_the_disk()
    assert failed.value.filename == str(path)
    assert path.read_text(encoding="utf-8") == "earlier"
    assert [p.name for p in tmp_path.iterdir()] == ["summary.json"]


def test_a_killed_write_leaves_the_file_that_was_there(tmp_path: Path) -> None:
    path = tmp_path / "summary.json"
    path.write_text("earlier", encoding="utf-8")
    program = f"""
import os, signal
from pathlib import Path
from runs.files import whole
with whole(Path({str(path)!r})) as part:
    part.write_text("half")
    os.kill(os.getpid(), signal.SIGKILL)
"""
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    killed = subprocess.run([sys.executable, "-c", program], env=environment, check=False)
    assert killed.returncode == -signal.SIGKILL
    assert path.read_text(encoding="utf-8") == "earlier"


def test_a_folder_is_replaced_as_a_whole(tmp_path: Path) -> None:
    folder = tmp_path / "figures"
    for names in (("a.png", "b.png"), ("b.png", "c.png")):
        with whole_folder(folder) as part:
            for name in names:
                (part / name).write_text(" ".join(names), encoding="utf-8")
        assert sorted(p.name for p in folder.iterdir()) == list(names)
    assert (folder / "b.png").read_text(encoding="utf-8") == "b.png c.png"
    assert [p.name for p in tmp_path.iterdir()] == ["figures"]


def test_a_failing_folder_leaves_the_one_that_was_there(tmp_path: Path) -> None:
    folder = tmp_path / "figures"
    with whole_folder(folder) as part:
        (part / "a.png").write_text("earlier", encoding="utf-8")

    def fail() -> None:
        with whole_folder(folder) as part:
            (part / "a.png").write_text("half", encoding="utf-8")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail()
    assert (folder / "a.png").read_text(encoding="utf-8") == "earlier"
    assert [p.name for p in tmp_path.iterdir()] == ["figures"]


def test_a_folder_without_files_is_none(tmp_path: Path) -> None:
    folder = tmp_path / "mesh"
    with whole_folder(folder) as part:
        (part / "outer.msh").write_text("mesh", encoding="utf-8")
    with whole_folder(folder):
        pass
    assert not folder.exists()

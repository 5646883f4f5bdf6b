# SPDX-License-Identifier: LGPL-3.0-or-later
"""Refusal of special and oversized files, without waiting."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from runs.case.messages import BadInput
from runs.case.reading import load
from runs.case.user_files import MAX_BYTES, check_not_working_folder
from runs.folder.files import MANIFEST
from runs.pipeline.results import prepare
from tests.runs.case_texts import refused
from tests.runs.coarse_case import COARSE

GUST = '[[base]]\nacceleration = 1.0\nfile = "gust.csv"\n\n[[model]]'


pytestmark = pytest.mark.usefixtures("here")


def complaint(file: str) -> str:
    with pytest.raises(BadInput) as error:
        load(file)
    return str(error.value)


@pytest.mark.parametrize(
    ("file", "make", "why"),
    [
        ("pipe", os.mkfifo, "not a regular file"),
        ("/dev/zero", lambda path: None, "not a regular file"),
        ("huge", lambda path: os.truncate(os.open(path, os.O_CREAT | os.O_RDWR), MAX_BYTES + 1),
         "larger than 16 MB"),
    ],
)  # fmt: skip
def test_special_and_oversized_files_are_refused(
    file: str, make: Callable[[str], object], why: str
) -> None:
    """Reading a pipe would wait for its writer, and a device has no end."""
    make(file)
    assert complaint(file) == f"{file}: file: cannot be read ({why}); give a case file that can"


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (os.mkfifo, "'gust.csv' cannot be read (not a regular file); "),
        (lambda path: os.symlink("/dev/zero", path), "'gust.csv' cannot be read (not a regular"),
        (os.mkdir, "'gust.csv' cannot be read (Is a directory); "),
        (lambda path: os.symlink(path, path), "'gust.csv' cannot be read (Too many levels of "),
        (lambda path: Path(path).write_bytes(b""), "'gust.csv' has fewer than two lines of num"),
        (lambda path: Path(path).write_bytes(b"0,1\n1,\xff"), "'gust.csv' has no finite number in"),
        (lambda path: Path(path).write_bytes(b"0,1\n" * 100_001), "'gust.csv' has 100001 lines; "),
    ],
)
def test_a_history_s_file_is_read_with_same_care(make: Callable[[str], object], what: str) -> None:
    make("gust.csv")
    Path("case.toml").write_text(COARSE.replace("[[model]]", GUST, 1), encoding="utf-8")
    assert complaint("case.toml").startswith(f"case.toml: base[1].file: {what}")


def test_a_history_s_file_is_a_printable_path() -> None:
    text = COARSE.replace("[[model]]", GUST.replace("gust", "a\\u0000b"), 1)
    Path("case.toml").write_text(text, encoding="utf-8")
    assert complaint("case.toml") == (
        "case.toml: base[1].file: must be a line of printable characters, got 'a\\x00b.csv'"
    )


@pytest.mark.parametrize("inside", ["", "figures"])
def test_nobody_s_folder_is_replaced_around_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, inside: str
) -> None:
    folder = tmp_path / "out"
    (folder / "figures").mkdir(parents=True)
    for name in (MANIFEST, "trajectories.nc"):
        (folder / name).touch()
    monkeypatch.chdir(folder / inside)
    for other in (folder / "other", tmp_path / "other", tmp_path / "ou"):
        check_not_working_folder(other, "case.toml", "--out other")
    with refused(
        f"case.toml: --out {folder}: is where you are, and will be replaced; start from another "
        "folder"
    ):
        prepare(str(folder), "case.toml")

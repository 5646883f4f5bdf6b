# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs of beams: readable files, and refusal of incomplete folders."""

import json
import os
import shutil
import subprocess
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from PIL import Image

from protractile.runs.case.reading import load
from protractile.runs.pipeline.results import Results
from tests.runs.case_texts import CLAMPED, table
from tests.runs.test_actions import CANTILEVER
from tests.system.run_folder import (
    COARSE,
    SERIES,
    check_common_files,
    files,
    protractile,
    trajectories,
)

# What a command says of a folder that it refuses.
Refusal = Callable[[str, Path], str]


@pytest.fixture(scope="module")
def series(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a run of the series alone."""
    folder = tmp_path_factory.mktemp("series") / "out"
    assert protractile("run", COARSE, "--models", ",".join(SERIES), "--out", folder) == 0
    return folder


@pytest.fixture
def again(series: Path, tmp_path: Path) -> Path:
    """Return a copy of this folder."""
    return shutil.copytree(series, tmp_path / "out")


@pytest.fixture
def refusal(capsys: pytest.CaptureFixture[str]) -> Refusal:
    """Return a function for the message of a refusal, after the name of the folder."""

    def refuse(command: str, folder: Path) -> str:
        assert protractile(command, folder) == 2
        out, err = capsys.readouterr()
        assert out == ""
        return err.removeprefix(f"protractile: {folder}: ")

    return refuse


def test_every_file_of_a_series_run_opens(series: Path, refusal: Refusal) -> None:
    check_common_files(series, SERIES)
    assert files(series) == {
        "case.toml", "results.csv", "curves.nc", "trajectories.nc", "trajectories.csv",
        "summary.json", "verdicts.json", "report.html", "viewer.html", ".manifest",
    }  # fmt: skip
    missing = "fields.nc: missing; give the folder of a run with a shell\n"
    assert refusal("snapshot", series) == missing
    results = Results.load(series)
    chosen = tuple(model for model in load(COARSE).models if model.name in SERIES)
    assert results.case == load(COARSE).model_copy(update={"models": chosen})
    xr.testing.assert_identical(results.trajectories, trajectories(series))


@pytest.mark.usefixtures("unprinted")
def test_a_repeated_run_leaves_the_same_and_nothing_else(series: Path, again: Path) -> None:
    """Reference: the first run. Equal arithmetic gives equal numbers."""
    (again / "figures").mkdir()
    (again / "figures" / "stale.png").write_bytes(b"of an earlier version")
    (again / "fields.nc").write_bytes(b"of a shell that is not run now")
    with (again / ".manifest").open("a") as manifest:
        manifest.write("figures/stale.png\nfields.nc\n")
    case = again / "case.toml"
    assert protractile("run", case, "--out", again) == 0
    assert files(again) == files(series)
    for name in ("trajectories.nc", "trajectories.csv", "case.toml", "verdicts.json"):
        assert (again / name).read_bytes() == (series / name).read_bytes()


@pytest.mark.usefixtures("unprinted")
def test_report_and_figures_are_rendered_again_from_the_data(series: Path, again: Path) -> None:
    """Reference: the figures of the report; without a request there are no files."""
    report = again / "report.html"
    few = report.read_text("utf-8").count("data:image/svg+xml")
    report.unlink()
    assert protractile("report", again) == 0
    assert files(again) == files(series)
    assert protractile("report", "--figures", again) == 0
    names = {path.stem for path in (again / "figures").iterdir()}
    assert {"boom", "tip", "head", "modes"} < names
    assert report.read_text("utf-8").count("data:image/svg+xml") == len(names) > few > 1
    (again / "figures" / "tip.png").unlink()
    assert protractile("report", again) == 0
    with Image.open(again / "figures" / "tip.png") as image:
        image.verify()


def test_other_versions_and_mixed_runs_have_different_messages(
    again: Path, refusal: Refusal
) -> None:
    """Reference: a folder of an earlier version without one of the current keys."""
    (again / ".manifest").unlink()
    case, path = again / "case.toml", again / "summary.json"
    now, summary = case.read_bytes(), path.read_text("utf-8")
    case.write_bytes(now.replace(b"play = 0.014", b"play = 0.013"))
    assert refusal("report", again) == (
        "trajectories.nc: is not of the case in case.toml; run the case again\n"
    )
    assert b"\ndemand = []\n" in now
    case.write_bytes(now.replace(b"demand = []\n", b"", 1))
    marks = [sha256(text).hexdigest() for text in (now, case.read_bytes())]
    path.write_text(summary.replace(*marks), encoding="utf-8")
    assert refusal("report", again) == (
        "case.toml: was written by another version with other keys; run the case again\n"
    )
    case.write_bytes(now)
    older = json.loads(summary)
    del older["models"]["kantorovich-5"]["contact_changes"]
    path.write_text(json.dumps(older), encoding="utf-8")
    for command in ("report", "snapshot"):
        assert refusal(command, again) == (
            "summary.json: models: kantorovich-5: contact_changes: Field required; is damaged or "
            "of another version; run the case again\n"
        )


def flip(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[-40] ^= 1
    path.write_bytes(content)


def cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 3])


def pipe(path: Path) -> None:
    path.unlink()
    os.mkfifo(path)


@pytest.mark.parametrize(
    ("damage", "names", "told"),
    [
        (flip, ["trajectories.nc", "viewer.html"],
         "is damaged, its SHA-256 differs from .manifest; remove it, or run the case again\n"),
        (cut, ["trajectories.nc", "summary.json", "case.toml"], ""),
        (Path.unlink, ["trajectories.nc", "summary.json", "case.toml"],
         "missing; give the folder of a run that has finished\n"),
        # Reading a pipe would wait for its writer for ever. Long paths are cut in the middle.
        (pipe, ["trajectories.nc"], "cannot be understood ([Errno 22] not a regul"),
        (pipe, [".manifest"], "is damaged; remove it, or run the case again\n"),
    ],
)  # fmt: skip
def test_a_damaged_folder_is_one_line(
    again: Path, refusal: Refusal, damage: Callable[[Path], object], names: list[str], told: str
) -> None:
    """``sha256sum -c .manifest`` also finds a flipped bit of a file that can still be read."""
    for name in names:
        whole = (again / name).read_bytes()
        damage(again / name)
        message = refusal("report", again)
        assert message.startswith(f"{name}: {told}" if told else "")
        assert (name in message, message.count("\n")) == (True, 1)
        if damage is flip:
            assert refusal("snapshot", again) == message
            check = "sha256sum", "--quiet", "-c", ".manifest"
            found = subprocess.run(check, cwd=again, capture_output=True, text=True)
            assert found.stdout == f"{name}: FAILED\n"
        if damage is not pipe:
            (again / name).write_bytes(whole)


@pytest.mark.usefixtures("few_figures")
def test_a_case_without_play_runs(tmp_path: Path) -> None:
    """Files of a boom without stations are readable."""
    folder = tmp_path / "out"
    assert protractile("run", COARSE, "--models", "beam-fe-bonded", "--out", folder) == 0
    check_common_files(folder, ["beam-fe-bonded"])
    assert np.isnan(trajectories(folder)["contact_force"].values).all()


@pytest.mark.usefixtures("few_figures")
def test_a_beam_without_joints_runs(tmp_path: Path) -> None:
    """Reference: analytic. The midspan of a pinned beam reaches nearly twice 5 q L⁴ / 384 E J."""
    series = table("[[model]]", name="beam", kind="kantorovich", terms=[6], base="pinned")
    text = CANTILEVER.replace("duration = 2.0", "duration = 0.6") + "load = 83.16\n" + series
    case, folder = tmp_path / "case.toml", tmp_path / "out"
    case.write_text(text.replace(CLAMPED, "supports = [0.0, 10.0]"), encoding="utf-8")
    assert protractile("run", case, "--out", folder) == 0
    check_common_files(folder, ["beam"])
    data = trajectories(folder)
    assert "station" not in data.sizes
    assert protractile("report", folder) == 0
    static_energy = 83.16**2 * 10.0**5 / (240.0 * 2.1e11 * 3.7986e-4)
    # The work of a suddenly applied load peaks at four times the static strain energy.
    assert float(data["work"].max()) == pytest.approx(4.0 * static_energy, rel=0.01)

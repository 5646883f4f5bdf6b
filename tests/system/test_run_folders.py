# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs of beams and shells: readable, consistent files, and refusal of incomplete folders."""

import json
import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path
from unittest.mock import Mock
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure
from PIL import Image

from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import load
from protractile.runs.pipeline.results import Results
from protractile.runs.report.opengl import RenderingUnavailable
from protractile.runs.report.scene import Scene
from protractile.runs.report.sheet import Snapshot
from protractile.shell_model.stress.stresses import ShellStress
from studies.reference_models.shell_readings import wall_forces
from tests import at_once
from tests.runs.case_texts import CLAMPED, table
from tests.runs.test_actions import CANTILEVER
from tests.short_film import render_short
from tests.system.run_folder import (
    COARSE,
    SERIES,
    check_common_files,
    files,
    protractile,
    summary_of,
    trajectories,
    write_coarse,
)
from tests.unprinted import blank

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("unprinted")]

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
        assert protractile(*command.split(), folder) == 2
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


BEAMS = [*SERIES, "beam-fe", "timoshenko", "beam-fe-bonded"]


@pytest.fixture
def _short_film(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shorten the film, which other tests check."""
    monkeypatch.setattr("protractile.runs.report.snapshots.render_motion", render_short)
    monkeypatch.setattr("protractile.runs.process.workers.workers", at_once.workers)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a run of all models."""
    pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")
    folder = tmp_path_factory.mktemp("whole") / "out"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("protractile.runs.report.snapshots.render_motion", render_short)
        patch.setattr(Figure, "savefig", blank)
        assert protractile("run", COARSE, "--out", folder) == 0
    return folder


@pytest.fixture
def shells(whole: Path, tmp_path: Path) -> Path:
    """Return a copy of this folder."""
    return shutil.copytree(whole, tmp_path / "out")


def test_every_file_of_a_whole_run_opens(whole: Path) -> None:
    check_common_files(whole, [*BEAMS, "shell"])
    summary = summary_of(whole)
    assert summary["models"]["shell"]["degrees_of_freedom"] > 10_000
    assert summary["versions"]["dolfinx"] is not None
    for name in ("outer", "inner"):
        groups = meshio.read(whole / "mesh" / f"{name}.msh").field_data
        assert {"bottom", "right", "top", "left", "station-1:top"} <= set(groups)
        assert meshio.read(whole / "mesh" / f"{name}.vtu").cell_data["wall"]
    kinds = {picture.split("-")[0] for picture in summary["snapshots"]["written"]}
    assert {"boom", "overlap", "motion.gif"} <= kinds or summary["snapshots"]["skipped"]
    for picture in summary["snapshots"]["written"]:
        with Image.open(whole / "snapshots" / picture) as image:
            image.verify()
    entries = ElementTree.parse(whole / "fields" / "shell.pvd").getroot().iter("DataSet")
    times = {float(entry.attrib["timestep"]): entry.attrib["file"] for entry in entries}
    assert (len(times), min(times), max(times)) == (51, 0.0, pytest.approx(0.6))
    last = meshio.read(whole / "fields" / times[max(times)])
    at_tip = np.abs(last.points[:, 0] - 19.0) < 1e-6
    tip = float(trajectories(whole)["tip"].sel(model="shell")[-1])
    assert last.point_data["displacement (m)"][at_tip, 2].mean() == pytest.approx(tip, rel=1e-3)


def test_stresses_beside_a_support_are_those_of_a_beam(whole: Path) -> None:
    """Reference: analytic, σ = M z / J beside the support at 2 m, within 5 % on a coarse mesh."""
    stress = summary_of(whole)["models"]["shell"]["stress"]
    with xr.open_dataset(whole / "stress.nc", engine="scipy") as data:
        assert data["place"].values.tolist() == [0.0, 2.0, 9.0, 10.0]
        near, patch = (data[name].load() for name in ("von_mises", "von_mises_patch"))
    assert near.sel(segment="inner", place=2.0).isnull().all()
    assert stress["von_mises"] >= float(near.max()) * (1.0 - 1e-6)
    assert stress["patch"]["von_mises"] == pytest.approx(float(patch.max()))
    beside = patch.sel(segment="outer", place=2.0)
    worst = float(beside["time"][int(beside.argmax("time"))])
    with xr.open_dataset(whole / "fields.nc", engine="scipy") as fields:
        shell = ShellStress.from_fields(fields.load())
    forces = [force for x in (1.9, 2.1) for force in wall_forces(shell, worst, 0, x).values()]
    moment = 0.5 * sum(force.moment for force in forces)
    section = build_boom(Results.load(whole).case).segments[0].section
    expected = abs(moment) * 0.5 * section.height / section.second_moment_of_area
    assert float(beside.max()) == pytest.approx(expected, rel=0.05)


def test_the_inner_segment_falls_freely_until_the_first_contact(whole: Path) -> None:
    """Reference: analytic. Its load is its mass times 1 m/s², so its tip moves by t²/2. Shell and
    shear-flexible beam touch at equal times.
    """
    data, models = trajectories(whole), summary_of(whole)["models"]
    touched = {name: model["first_contact"] for name, model in models.items()}
    for name in (*SERIES, "beam-fe", "timoshenko", "shell"):
        free = data.sel(model=name).where(data["time"] < touched[name], drop=True)
        assert free["tip"].values == pytest.approx(0.5 * free["time"].values ** 2, abs=1e-9)
        # The energy put in is the energy held.
        assert models[name]["energy_residual"] < 1e-3
    shell, beam = touched["shell"], touched["timoshenko"]
    assert shell == pytest.approx(beam, rel=1e-3)
    assert abs(shell - beam) < 0.5 * abs(shell - touched["beam-fe"])


@pytest.mark.usefixtures("few_figures", "opengl", "_short_film")
def test_snapshots_of_given_times_join_the_others(whole: Path, shells: Path) -> None:
    assert protractile("snapshot", shells, "--time", "0.25") == 0
    names = {path.name for path in (shells / "snapshots").iterdir()}
    assert names == {path.name for path in (whole / "snapshots").iterdir()} | {
        "boom-0.25s.png", "overlap-0.25s.png",
    }  # fmt: skip
    check_common_files(shells, [*BEAMS, "shell"])


def test_a_time_outside_the_run_and_other_fields_are_one_line(
    shells: Path, refusal: Refusal
) -> None:
    """Reference: a folder with fields without names of plates, as in an earlier version."""
    assert (
        refusal("snapshot --time 0.7", shells) == "--time: must be between 0 and 0.6 s, got 0.7\n"
    )
    fields = xr.load_dataset(shells / "fields.nc", engine="scipy")
    fields.drop_vars("plate_1").to_netcdf(shells / "fields.nc", engine="scipy")
    (shells / ".manifest").unlink()
    assert refusal("snapshot", shells) == (
        "fields.nc: cannot be understood ('plate_1'); run the case again\n"
    )


@pytest.mark.usefixtures("opengl", "few_figures", "_short_film")
def test_a_run_without_opengl_says_so_and_goes_on(
    shells: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    refusal: Refusal,
) -> None:
    refuse = Mock(side_effect=RenderingUnavailable("no OpenGL"))
    monkeypatch.setattr("protractile.runs.report.snapshots.render_motion", refuse)
    run = "run", write_coarse(tmp_path, 0.02), "--models", "shell", "--mesh-size", "1"
    assert protractile(*run, "--out", shells) == 0
    assert "\nno snapshots: no OpenGL\n" in capsys.readouterr().out
    assert summary_of(shells)["snapshots"] == {"written": {}, "skipped": "no OpenGL"}
    assert not (shells / "snapshots").exists()
    assert refusal("snapshot", shells) == "snapshots: cannot be made: no OpenGL\n"


@pytest.mark.usefixtures("few_figures", "_short_film")
def test_two_shells_of_a_case_keep_their_files_apart(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

    def draw(views: Sequence[Scene], folder: Path, *settings: object) -> list[Snapshot]:
        path = folder / "boom-end.png"
        Image.new("RGB", (8, 8)).save(path)
        return [Snapshot(path, "The end", "The boom at its end.")]

    monkeypatch.setattr("protractile.runs.report.snapshots.render_motion", draw)
    short = write_coarse(tmp_path, 0.02)
    text = short.read_text(encoding="utf-8").replace("mesh_size = 0.25", "mesh_size = 1.0")
    shell = text[text.index('[[model]]\nname = "shell"') :].replace('name = "shell"', 'name = "a"')
    text += f"\n{shell}\n" + shell.replace('"a"', '"a-b"').replace("near webs", "across")
    text = text.replace('"outer"', '"b-c"').replace('"inner"', '"c"')
    short.write_text(text, encoding="utf-8")
    folder = tmp_path / "out"
    assert protractile("run", short, "--models", "a,a-b", "--out", folder) == 0
    found = files(folder)
    for model in ("a", "a-b"):
        assert {f"{model}-fields.nc", f"snapshots/{model}-boom-end.png"} <= found
        meshes = {f"{segment}.{kind}" for segment in ("b-c", "c") for kind in ("msh", "vtu")}
        assert {f"mesh/{model}/{name}" for name in meshes} <= found
        assert {f"{model}-stress.nc", f"fields/{model}.pvd", f"fields/{model}-00.vtu"} <= found

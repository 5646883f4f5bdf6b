# SPDX-License-Identifier: LGPL-3.0-or-later
"""A run of every kind of model, with readable and consistent files."""

import shutil
from collections.abc import Sequence
from pathlib import Path
from unittest.mock import Mock
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
import xarray as xr
from PIL import Image

from protractile.runs.case.build import build_boom
from protractile.runs.pipeline.results import Results
from protractile.runs.report.opengl import RenderingUnavailable
from protractile.runs.report.scene import Scene
from protractile.runs.report.sheet import Snapshot
from protractile.shell_model.stress.stresses import ShellStress
from studies.reference_models.shell_readings import wall_forces
from tests import at_once
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

pytestmark = pytest.mark.slow


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
        assert protractile("run", COARSE, "--out", folder) == 0
    return folder


@pytest.fixture
def again(whole: Path, tmp_path: Path) -> Path:
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
def test_snapshots_of_given_times_join_the_others(whole: Path, again: Path) -> None:
    assert protractile("snapshot", again, "--time", "0.25") == 0
    names = {path.name for path in (again / "snapshots").iterdir()}
    assert names == {path.name for path in (whole / "snapshots").iterdir()} | {
        "boom-0.25s.png", "overlap-0.25s.png",
    }  # fmt: skip
    check_common_files(again, [*BEAMS, "shell"])


def test_a_time_outside_the_run_and_other_fields_are_one_line(
    again: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Reference: a folder with fields without names of plates, as in an earlier version."""
    assert protractile("snapshot", again, "--time", "0.7") == 2
    assert capsys.readouterr().err == (
        f"protractile: {again}: --time: must be between 0 and 0.6 s, got 0.7\n"
    )
    fields = xr.load_dataset(again / "fields.nc", engine="scipy")
    fields.drop_vars("plate_1").to_netcdf(again / "fields.nc", engine="scipy")
    (again / ".manifest").unlink()
    assert protractile("snapshot", again) == 2
    assert capsys.readouterr().err == (
        f"protractile: {again}: fields.nc: cannot be understood ('plate_1'); run the case again\n"
    )


@pytest.mark.usefixtures("opengl", "few_figures", "_short_film")
def test_a_run_without_opengl_says_so_and_goes_on(
    again: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    refuse = Mock(side_effect=RenderingUnavailable("no OpenGL"))
    monkeypatch.setattr("protractile.runs.report.snapshots.render_motion", refuse)
    run = "run", write_coarse(tmp_path, 0.02), "--models", "shell", "--out", again
    assert protractile(*run) == 0
    assert "\nno snapshots: no OpenGL\n" in capsys.readouterr().out
    assert summary_of(again)["snapshots"] == {"written": {}, "skipped": "no OpenGL"}
    assert not (again / "snapshots").exists()
    assert protractile("snapshot", again) == 2
    assert capsys.readouterr().err == (
        f"protractile: {again}: snapshots: cannot be made: no OpenGL\n"
    )
    # Pictures can be left to later.
    assert protractile(*run, "--no-pictures") == 0
    later = "not requested; protractile snapshot draws them"
    assert f"\nno snapshots: {later}\n" in capsys.readouterr().out
    assert summary_of(again)["snapshots"] == {"written": {}, "skipped": later}


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
    text = short.read_text(encoding="utf-8").replace("mesh_size = 0.25", "mesh_size = 0.5")
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

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Field series: readable files, with displacements and stresses at their times."""

from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
import xarray as xr

from protractile.runs.pipeline.model_output import write_field_series
from protractile.shell_model.stress.stresses import ShellStress


@pytest.fixture
def fields() -> xr.Dataset:
    """Return two plates of a triangle each, of two segments with separate coordinates."""
    stress = np.zeros((1, 1, 6), dtype=np.float32)
    stress[0, 0] = [3.0e6, 0.0, 0.0, 1.0e6, 0.0, 0.0]
    modes = np.zeros((2, 6, 3), dtype=np.float32)
    modes[0, :3, 2], modes[1, 3:, 1] = 1.0, 1.0
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [3, 0, 0], [2, 1, 0]])
    return xr.Dataset(
        {
            "points": (("point", "component"), points.astype(float)),
            "triangles": (("triangle", "corner"), np.int32([[0, 1, 2], [3, 4, 5]])),
            "segment": ("triangle", np.int32([0, 1])),
            "wall": ("triangle", np.int32([2, 2])),
            "thickness": ("triangle", [0.01, 0.01]),
            "modes": (("mode", "point", "component"), modes),
            "coordinates_1": (("own_1", "mode"), [[1.0, 0.0]]),
            "coordinates_2": (("own_2", "mode"), [[0.0, 1.0]]),
            "stress_1": (("own_1", "triangle_1", "stress"), stress),
            "stress_2": (("own_2", "triangle_2", "stress"), 2.0 * stress),
            "state": (("time", "mode"), np.float32([[0, 0], [1, 0], [2, 1], [3, -1]])),
        },
        coords={
            "time": [0.0, 0.1, 0.2, 0.3],
            **{f"plate_{k}": ["bottom", "right", "top", "left"] for k in (1, 2)},
        },
        attrs={"model": "shell"},
    )


def test_a_series_reads_back_as_it_was(fields: xr.Dataset, tmp_path: Path) -> None:
    """Reference: analytic. A tension σ with bending b gives |σ ± b| at the faces."""
    written = write_field_series(fields, tmp_path, [0.0, 0.19, 0.3])
    assert sorted(tmp_path.iterdir()) == sorted(written)
    entries = ElementTree.parse(tmp_path / "shell.pvd").getroot().findall("Collection/DataSet")
    assert [float(entry.attrib["timestep"]) for entry in entries] == [0.0, 0.2, 0.3]
    for entry, state in zip(entries, ([0.0, 0.0], [2.0, 1.0], [3.0, -1.0]), strict=True):
        frame = meshio.read(tmp_path / entry.attrib["file"])
        assert frame.points.shape == (6, 3)
        moved = frame.point_data["displacement (m)"]
        assert moved[:3, 2] == pytest.approx(state[0])
        assert moved[3:, 1] == pytest.approx(state[1])
        (segment,) = frame.cell_data["segment"]
        assert segment.tolist() == [1, 2]
        pull = np.array([state[0], 2.0 * state[1]])
        for face, factor in (("outer", 4.0e6), ("middle", 3.0e6), ("inner", 2.0e6)):
            (found,) = frame.cell_data[f"von Mises, {face} (Pa)"]
            assert found == pytest.approx(np.abs(pull) * factor)
        (bending,) = frame.cell_data["bending x (Pa)"]
        assert bending == pytest.approx(1.0e6 * pull)


def test_a_time_outside_the_run_is_refused(fields: xr.Dataset, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"^time must be between 0 and 0\.3 s, got 0\.4$"):
        write_field_series(fields, tmp_path, [0.1, 0.4])
    assert not list(tmp_path.iterdir())


def test_stress_series_equals_the_stress_of_each_instant(fields: xr.Dataset) -> None:
    """Reference: single instants. Means over triangles are means of stress components."""
    shell = ShellStress.from_fields(fields)
    second = np.array([1])
    ((part, stress),) = shell.over_time(second, slice(1, None, 2))
    assert part == slice(0, 2)
    for i, t in enumerate((0.1, 0.3)):
        assert stress.membrane[i] == pytest.approx(shell.at(t).membrane[second])
    ((_, mean),) = shell.over_time(second, means=np.array([[0.5], [1.0]]))
    assert mean.membrane[3, :, 0] == pytest.approx([-3.0e6, -6.0e6])

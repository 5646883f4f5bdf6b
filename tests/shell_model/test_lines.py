# SPDX-License-Identifier: LGPL-3.0-or-later
"""Section forces along shells, and fields over time."""

from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
import xarray as xr

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.lines import lines as lines_of_beams
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Step
from protractile.dynamics.line import Line
from protractile.geometry.arrays import Array
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Load, Support
from protractile.geometry.box import BoxSection
from protractile.runs.pipeline.model_output import write_field_series
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.stress.lines import band_boundaries, lines
from protractile.shell_model.stress.stresses import ShellStress
from studies.reference_models.statics import static_response
from tests.shell_model.booms import LATERAL_LAW, LAW, boom_in_space, box_segment, flat_boom
from tests.touching import touching


@cache
def at_rest(boom: Boom, options: ShellOptions) -> list[tuple[Line, Array]]:
    """Return the lines along each segment of a shell, and the equilibrium."""
    lateral = [LATERAL_LAW] if boom.spatial else []
    shell = reduce_boom(touching(boom, LAW, lateral), options, MPI.COMM_SELF)
    position = equilibrium(shell.system, shell.system.load)
    return [(line, position) for line in lines(shell.fields, boom)]


@pytest.mark.slow
@pytest.mark.parametrize("tolerance", [None, 0.02])
def test_section_forces_of_a_shell_follow_statics(tolerance: float | None) -> None:
    """Reference: by hand, V = 55.07 s, M = −55.07 s²/2, s = 19 − x, on two meshes."""
    options = ShellOptions(mesh_size=0.2, contact_tolerance=tolerance)
    line, position = at_rest(flat_boom(), options)[1]
    found = line.read(position)
    s = 19.0 - line.x
    outside = s < 8.7
    np.testing.assert_allclose(found["shear"][outside], 55.07 * s[outside], atol=3.0)
    np.testing.assert_allclose(found["moment"][outside], -27.535 * s[outside] ** 2, atol=15.0)


@pytest.mark.slow
def test_a_pressed_shell_bears_its_loads_across() -> None:
    """Reference: by hand, −500 N/m and −44,049 N on a column under half of Euler's force. Shear
    forces normal to the deflected axis are up to 2.2 times as large.
    """
    clamp = Support(0.0, "clamped")
    box = BoxSection(height=0.4, width=0.3, flange=0.02, web=0.02)
    free = box_segment("boom", 0.0, 10.0, box, load=-500.0, supports=(clamp,))
    force = 0.5 * np.pi**2 * free.bending_stiffness / (4.0 * 10.0**2)
    pressed = with_compression([free], [], [Thrust(0, 10.0, force)])
    boom = Boom(pressed, (), (Load(0, "z", -44049.0, 10.0, Step()),))
    shell = reduce_boom(boom, ShellOptions(mesh_size=0.2), MPI.COMM_SELF)
    system = shell.system.gather_loads()
    (line,) = lines(shell.fields, boom)
    found = line.read(static_response(system, system.load))
    inside = (line.x > 1.0) & (line.x < 9.0)
    expected = -44049.0 - 500.0 * (10.0 - line.x)
    np.testing.assert_allclose(found["shear"][inside], expected[inside], rtol=1e-2)


@pytest.mark.slow
def test_a_shell_in_space_bends_and_twists_as_beams_do() -> None:
    """Reference: another model, shear-flexible elements: forces 1 %, deflections 2 %."""
    boom = boom_in_space(sideways=0.4)
    models = finite_element_segments(boom, 0.25, "timoshenko", rotary_inertia=True)
    system = gap_system(touching(boom, LAW, LATERAL_LAW), models)
    position = equilibrium(system, system.load)
    beams = lines_of_beams(boom, models)
    shells = at_rest(boom, ShellOptions(mesh_size=0.25))
    for beam, (line, state), far in zip(beams, shells, ((2.5, 8.5), (10.5, 19.0)), strict=True):
        of_beam, found = beam.read(position), line.read(state)
        outside = (line.x > far[0]) & (line.x < far[1])
        for name, values in found.items():
            expected = np.interp(line.x, beam.x, of_beam[name])
            largest = np.abs(of_beam[name]).max()
            share = 0.02 if name in ("deflection", "lateral") else 0.01
            if name in ("twist", "torque") and largest < 1e-3:
                continue
            off = np.abs(values - expected)[outside].max() / largest
            assert off < share, name


def test_cuts_pass_no_triangle() -> None:
    """Reference: by hand. Triangles at 0 to 2 m and 1 to 3 m permit lines at 0, 3, 4 m."""
    spans = np.array([[0.0, 2.0], [1.0, 3.0], [3.0, 4.0]])
    assert band_boundaries(spans, []).tolist() == [0.0, 3.0, 4.0]


def test_band_boundaries_are_at_loads() -> None:
    """Reference: by hand. Loads stay boundaries; near lines that leave short bands do not."""
    edges = np.linspace(0.0, 10.0, 1001)
    spans = np.column_stack([edges[:-1], edges[1:]])
    cuts = band_boundaries(spans, [2.01])
    assert 2.01 in cuts.round(9)
    assert np.diff(cuts).min() > 10.0 / 60.0 - 1e-9
    assert cuts.size == 59


@pytest.mark.slow
def test_support_reaction_of_a_shell() -> None:
    """Reference: by hand, as in tests/beam_model/test_statics.py: −5933.9 N at 2 m."""
    line, position = at_rest(flat_boom(), ShellOptions(mesh_size=0.2, contact_tolerance=0.02))[0]
    before, behind = (line.one_sided_row("shear", 2.0, side) @ position for side in (-1, 1))
    assert before - behind == pytest.approx(-5933.9, rel=0.02)


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

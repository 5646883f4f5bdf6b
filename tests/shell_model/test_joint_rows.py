# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom of shells as a gap system: rows, observers, section forces along it, and fields."""

from dataclasses import replace
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import pytest
import xarray as xr

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.lines import lines as lines_of_beams
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.excitation import Ramp, Step
from protractile.dynamics.failure import NumericsError
from protractile.geometry.boom import Boom, BoomError, Load, Pad, Stop
from protractile.geometry.box import BoxSection
from protractile.geometry.contact_places import ContactLine
from protractile.geometry.observation import Observation
from protractile.runs.pipeline.model_output import write_field_series
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.stress.lines import band_boundaries, lines
from studies import sections
from studies.reference_models.statics import static_response
from tests.shell_model.booms import (
    LATERAL_LAW,
    LAW,
    bonded_beams,
    boom_in_space,
    contact_forces,
    flat_boom,
    pressed_rest,
    reduce_quickly,
    reduced,
    rigid_state,
    three_segments,
)
from tests.shell_model.conftest import UNEQUAL
from tests.shell_model.test_cylinder import column
from tests.touching import touching


@pytest.mark.slow
@pytest.mark.parametrize("line", ["near webs", "across"])
def test_a_station_slides_as_the_mean_of_its_contact_rows(line: ContactLine) -> None:
    """Reference: analytic, one top and one bottom row with weights; a dashpot has √c of it."""
    boom = flat_boom(friction=0.2)
    boom = replace(boom, joints=(replace(boom.joints[0], dashpot=2.0e3),))
    system = reduced(boom, 0.5, line).system
    assert system.num_modes == reduced(flat_boom(), 0.5, line).system.num_modes
    dashpots = np.sqrt(2.0e3) * system.friction_rows
    np.testing.assert_allclose(system.dashpots, dashpots, atol=1e-9 * np.abs(dashpots).max())
    assert system.frictions == [DryFriction(0.2, 0, 4500.0), DryFriction(0.2, 1, 5000.0)]
    for station, row in enumerate(system.friction_rows):
        mine = system.station_of_row == station
        stiffness = [w.terms[0].stiffness for w, at in zip(system.laws, mine, strict=True) if at]
        mean = np.average(system.rows[mine], axis=0, weights=stiffness)
        assert row == pytest.approx(mean, rel=1.0e-9, abs=1.0e-12)


@pytest.mark.slow
def test_loads_act_at_their_positions_and_times() -> None:
    """Reference: analytic, force over mass of a free segment; uniform is constant load."""
    boom = flat_boom()
    loads = (Load(1, "z", 55.07, None, Step()), Load(1, "z", 100.0, 14.0, Ramp(0.1)))
    system = reduced(replace(boom, loads=loads), 0.5).system
    uniform, point = (excitation.load for excitation in system.excitations)
    free = system.omega2 == 0.0
    inner = system.load * (np.arange(free.size) >= free.argmax())
    assert uniform == pytest.approx(inner, rel=1.0e-9, abs=1.0e-12 * np.abs(inner).max())
    tip, tail = (system.observers[name].row[free] for name in ("tip", "tail"))
    mass = boom.segments[1].mass_per_length * boom.segments[1].length
    assert 0.5 * (tip + tail) @ point[free] == pytest.approx(100.0 / mass, rel=1.0e-9)


def test_stop_reads_the_deflection_of_its_flange() -> None:
    """Reference: other code, beams. The one-sided row at 8 m is the deflection of the flange."""
    stop = Stop(0, 8.0, 0.02, PowerContact(0.0, 1.0, stiffness_below=1.0e8))
    system = reduced(replace(flat_boom(), stops=(stop,)), 0.5).system
    assert list(system.stations) == [9.0, 10.0, 8.0]
    assert system.station_of_row.tolist() == [0, 0, 1, 1, 2]
    assert system.laws[-1].terms == stop.law.terms
    rest = pressed_rest(system, system.station_of_row != 2)
    beams = bonded_beams(replace(flat_boom(), observations=(Observation("seat", 0, 8.0),)))
    expected = beams.observers["seat"].row @ static_response(beams, beams.load)
    assert system.rows[-1] @ rest == pytest.approx(expected, rel=5e-3)


*_, U = sections.SHAPES.values()
INNER_UNEQUAL = BoxSection(0.46, 0.28, flange=0.008, web=0.005, bottom_flange=0.005)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("boom", "size", "law", "rel"),
    [
        (sections.boom_of(*U), 0.25, sections.LAW, 1.5e-2),
        (sections.boom_of(UNEQUAL, INNER_UNEQUAL), 0.25, sections.LAW, 5.0e-3),
        (three_segments(), 0.5, LAW, 5.0e-3),
    ],
    ids=["u", "unequal box", "three boxes"],
)
def test_a_pressed_boom_rests_as_its_beams_do(
    boom: Boom, size: float, law: PowerContact, rel: float
) -> None:
    """Reference: other code, bonded Timoshenko elements; boxes are 0.25 % apart."""
    system, beams = reduced(boom, size, law=law).system, bonded_beams(boom)
    rest, expected = pressed_rest(system), static_response(beams, beams.load)
    for name, observer in beams.observers.items():
        found = system.observers[name].row @ rest
        assert found == pytest.approx(observer.row @ expected, rel=rel), name


@pytest.mark.slow
def test_a_bonded_joint_has_no_play() -> None:
    """Reference: other code, bonded Timoshenko elements within 0.2 %; no rigid motion."""
    boom = three_segments(bonded=True)
    shell = reduced(boom, 0.5, whole=True)
    system, beams = shell.system, bonded_beams(boom)
    assert not system.laws
    assert system.frequencies[0] == pytest.approx(beams.frequencies[0], rel=2.0e-3)
    rest, expected = (static_response(one, one.load) for one in (system, beams))
    tip = system.observers["tip"].row @ rest
    assert tip == pytest.approx(beams.observers["tip"].row @ expected, rel=2.0e-3)
    # The pictures' modes are those of the coordinates.
    moved = np.tensordot(rest, shell.fields["modes"].values, axes=1)
    at_tip = np.abs(shell.fields["points"].values[:, 0] - boom.tip) < 1.0e-9
    assert moved[at_tip, 2].mean() == pytest.approx(tip, rel=1.0e-3)


@pytest.mark.slow
@pytest.mark.parametrize("line", ["near webs", "across"])
def test_a_uniform_approach_gives_the_law_of_the_paper_exactly(line: ContactLine) -> None:
    """Reference: analytic. Under a rigid translation each station has F(y) of (4) once."""
    system = reduced(flat_boom(), 0.5, line).system
    for lift in (7.3e-3, -7.3e-3):
        state = rigid_state(system, {"tip": lift, "tail": lift})
        assert system.rows @ state == pytest.approx(np.full(len(system.laws), lift), rel=1.0e-9)
        forces = np.bincount(system.station_of_row, contact_forces(system, state))
        assert forces == pytest.approx(2 * [np.sign(lift) * 1.0e13 * 0.3e-3**2], rel=1.0e-9)


OUTER, INNER = flat_boom().segments
BARE = replace(OUTER, section=None)
TAPER = replace(OUTER, head_section=replace(OUTER.section, flange=0.005))
PADDED = replace(flat_boom().joints[0], pad=Pad(0.1, 0.06))


@pytest.mark.parametrize(
    ("boom", "line", "message"),
    [
        (
            replace(flat_boom(), segments=(BARE, INNER)), "near webs",
            "segments[0].section: 'outer' has no box section, which a shell needs; give "
            "height_to_width or section",
        ),
        (
            boom_in_space(), "across",
            "contact_line: 'across' spreads the force over the flanges of a flat boom; in space "
            "the pads sit in the corners: give 'near webs' or 'surface'",
        ),
        (
            replace(flat_boom(), joints=(PADDED,)), "surface",
            "contact_line: 'surface' leaves no place to the joints' pads; give 'near webs', or "
            "leave pad out",
        ),
        (
            replace(flat_boom(), segments=(TAPER, INNER)), "surface",
            "contact_line: 'surface' lets parallel walls touch, and 'outer' tapers; give 'near "
            "webs', or 'across'",
        ),
        (
            column(1.25), "near webs",
            "the shell of the boom buckles under 0.799 times its axial forces; make these smaller, "
            "or the sections larger",
        ),
    ],
    ids=["no section", "across", "pads", "taper", "buckles"],
)  # fmt: skip
def test_a_boom_without_a_shell_is_refused(boom: Boom, line: ContactLine, message: str) -> None:
    """Reference: exact message."""
    with pytest.raises((BoomError, NumericsError)) as caught:
        reduced(boom, 0.4, line)
    assert str(caught.value) == message


@pytest.mark.slow
def test_section_forces_of_a_shell_follow_statics() -> None:
    """Reference: by hand, V = 55.07 s, M = −55.07 s²/2, s = 19 − x; −5933.9 N at 2 m."""
    boom = touching(flat_boom(), LAW)
    shell = reduce_quickly(boom, ShellOptions(0.2, contact_tolerance=0.02), fields=True)
    position = equilibrium(shell.system, shell.system.load)
    outer, inner = lines(shell.fields, boom)
    before, behind = (outer.one_sided_row("shear", 2.0, side) @ position for side in (-1, 1))
    assert before - behind == pytest.approx(-5933.9, rel=0.02)
    found, s = inner.read(position), 19.0 - inner.x
    outside = s < 8.7
    np.testing.assert_allclose(found["shear"][outside], 55.07 * s[outside], atol=3.0)
    np.testing.assert_allclose(found["moment"][outside], -27.535 * s[outside] ** 2, atol=15.0)


@pytest.mark.slow
def test_a_pressed_shell_bears_its_loads_across() -> None:
    """Reference: by hand, −100 N/m and −2000 N on a column under half of Euler's force."""
    boom = replace(column(0.5), loads=(Load(0, "z", -2000.0, 8.0, Step()),))
    shell = reduce_quickly(boom, ShellOptions(mesh_size=0.2), fields=True)
    system = shell.system.gather_loads()
    (line,) = lines(shell.fields, boom)
    found = line.read(static_response(system, system.load))
    inside = (line.x > 1.0) & (line.x < 7.0)
    expected = -2000.0 - 100.0 * (8.0 - line.x)
    np.testing.assert_allclose(found["shear"][inside], expected[inside], rtol=1e-2)


@pytest.mark.slow
def test_a_shell_in_space_bends_and_twists_as_beams_do() -> None:
    """Reference: another model, shear-flexible elements: forces 1 %, deflections 2 %."""
    boom = touching(boom_in_space(sideways=0.4), LAW, LATERAL_LAW)
    models = finite_element_segments(boom, 0.25, "timoshenko", rotary_inertia=True)
    shell = reduce_quickly(boom, ShellOptions(mesh_size=0.25), fields=True)
    position, state = (
        equilibrium(system, system.load) for system in (gap_system(boom, models), shell.system)
    )
    pairs = zip(lines_of_beams(boom, models), lines(shell.fields, boom), strict=True)
    for (beam, line), (start, end) in zip(pairs, ((2.5, 8.5), (10.5, 19.0)), strict=True):
        of_beam, found = beam.read(position), line.read(state)
        outside = (line.x > start) & (line.x < end)
        for name, values in found.items():
            expected = np.interp(line.x, beam.x, of_beam[name])
            largest = np.abs(of_beam[name]).max()
            if name in ("twist", "torque") and largest < 1e-3:
                continue
            off = np.abs(values - expected)[outside].max() / largest
            assert off < (0.02 if name in ("deflection", "lateral") else 0.01), name


def test_band_boundaries_pass_no_triangle_and_are_at_loads() -> None:
    """Reference: by hand. Near loads, lines that leave short bands are no boundaries."""
    spans = np.array([[0.0, 2.0], [1.0, 3.0], [3.0, 4.0]])
    assert band_boundaries(spans, []).tolist() == [0.0, 3.0, 4.0]
    # A sixtieth of 61 lines is more than one.
    lines = np.arange(62.0)
    cuts = band_boundaries(np.column_stack([lines[:-1], lines[1:]]), [])
    assert cuts.tolist() == [*range(0, 60, 2), 61]
    edges = np.linspace(0.0, 10.0, 1001)
    cuts = band_boundaries(np.column_stack([edges[:-1], edges[1:]]), [2.01])
    assert 2.01 in cuts.round(9)
    assert np.diff(cuts).min() > 10.0 / 60.0 - 1e-9


@pytest.fixture
def fields() -> xr.Dataset:
    """Return a triangle of each of two segments, which move by their own coordinate."""
    stress = np.float32([[[3.0e6, 0.0, 0.0, 1.0e6, 0.0, 0.0]]])
    modes = np.zeros((2, 6, 3), dtype=np.float32)
    modes[0, :3, 2], modes[1, 3:, 1] = 1.0, 1.0
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [2, 0, 0], [3, 0, 0], [2, 1, 0]])
    plates = ["bottom", "right", "top", "left"]
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
        coords={"time": [0.0, 0.1, 0.2, 0.3], "plate_1": plates, "plate_2": plates},
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

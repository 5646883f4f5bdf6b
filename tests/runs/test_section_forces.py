# SPDX-License-Identifier: LGPL-3.0-or-later
"""Section forces along the boom, stresses in the report, and pairs of numbers."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

import matplotlib
import numpy as np
import pytest
import xarray as xr
from pydantic import AfterValidator

from protractile.analysis.curves import Curves, histories
from protractile.analysis.model import section_forces
from protractile.analysis.rows import BEAM, MOTION, Row
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.lines import lines
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.excitation import Step
from protractile.dynamics.line import Line
from protractile.geometry.boom import Boom, Load
from protractile.geometry.box import BoxSection
from protractile.geometry.compression import Compression
from protractile.geometry.fields import fields_of, names_of
from protractile.runs.case import messages
from protractile.runs.case import reading as case_file
from protractile.runs.case.schema import BucklingTable
from protractile.runs.pipeline.results import Results
from protractile.runs.report import theme
from protractile.runs.report.figure_context import FigureContext
from protractile.runs.report.force_figures import stress_history
from studies.telescoping_column import END, LAW, LENGTH, STIFFNESS, column
from tests.booms import cantilever
from tests.runs.case_texts import (
    CANTILEVER,
    COARSE,
    STEEL,
    box,
    edited,
    elements,
    read_case,
    refusal,
    shipped,
    table,
)
from tests.runs.summaries import answers_of, model_summary, printed_check, summary_of
from tests.touching import touching

BOX = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)

# A pin at 1 m, 100 kg/m under 30 degrees, and a cylinder of the triangle 3, 4, 5 at 4 m.
CASE = f"""
title = "An arm on its cylinder"
time = {{ duration = 0.1, output_step = 1e-2 }}
start = {{ state = "equilibrium" }}
gravity = {{ acceleration = 10.0, angle = 30.0 }}
{STEEL}
{box("arm", (0.0, 10.0), (0.40, 0.30, 0.008, 0.006), "mass_per_length = 100.0")}
supports = [{{ x = 1.0 }}]
{table("[[cylinder]]", segment="arm", x=4.0, depth=0.0, ground=[0.0, -3.0], stiffness=1e8)}
{elements("beam", theory="timoshenko", element_length=0.5)}
"""


def test_shear_force_uses_the_extended_axial_forces() -> None:
    """Reference: by hand, 1 kN on a column under 20 % of Euler's force, extended from 2 to 5 m."""
    force = 0.2 * np.pi**2 * STIFFNESS / (4.0 * LENGTH**2)
    boom = replace(column(force), loads=(Load(0, "z", -1.0e3, LENGTH, Step()),))
    models = finite_element_segments(boom, 0.25, "euler-bernoulli", False)
    system = gap_system(touching(boom, LAW), models).gather_loads()
    outer = lines(boom, models)[0]
    found = section_forces(boom, 0, outer, equilibrium_at(system, 1.0), np.array(1.0))
    before = outer.x < END
    np.testing.assert_allclose(found["shear"][before], -1.0e3, rtol=2e-3)
    # A normal force has both sides of a jump.
    pressed = Compression((0.0, 4.0, 10.0), ((9e3, 7e3), (2e3, 2e3)))
    (arm,) = cantilever(end=10.0).segments
    boom = Boom((replace(arm, compression=pressed),), ())
    line = Line(np.array([0.0, 4.0, 4.0, 10.0]), {}, paired=True)
    normal = section_forces(boom, 0, line, np.zeros(1), np.zeros(()))["normal"]
    np.testing.assert_allclose(normal, [-9e3, -7e3, -2e3, -2e3], rtol=1e-6)


@pytest.fixture(scope="module")
def answers(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return answers_of(read_case(tmp_path_factory.mktemp("arm"), CASE))


ALONG, ACROSS = 500.0, 1000.0 * np.cos(np.pi / 6.0)  # N/m
# Of the cylinder, about the pin: F 3/5 on an arm of 3 m holds 10 m whose middle is at 4 m.
FORCE = ACROSS * 10.0 * 4.0 / (0.6 * 3.0)


def reactions(results: Results) -> dict[str, float]:
    """Return the axial reactions at rest by place."""
    rows = results.rows.where(model=BEAM, play=True, quantity="axial_reaction")
    return {row.place: row.value for row in rows}


def moved(results: Results, quantity: str) -> Row:
    (row,) = results.rows.where(model="beam", state=MOTION, quantity=quantity)
    return row


def test_a_cylinder_pulls_the_boom_off_its_pin(answers: Results) -> None:
    """Reference: by hand. 4/5 of its force act along the boom, between the pin and the lug."""
    (force,) = answers.rows.where(model="beam", state="rest", quantity="cylinder_force")
    assert force.value == pytest.approx(FORCE, rel=1e-3)
    (arm,) = answers.curves.where(model="beam", state="rest")
    for x, normal in ((0.5, 0.5 * ALONG), (2.0, -8.0 * ALONG + 0.8 * FORCE), (6.0, -4.0 * ALONG)):
        assert np.interp(x, arm.x, arm.values["normal"]) == pytest.approx(normal, rel=2e-3)


def test_pin_carries_axial_forces(answers: Results, tmp_path: Path) -> None:
    """Reference: by hand, both components and the resultant, at rest and in a motion from rest."""
    along, across = 10.0 * ALONG - 0.8 * FORCE, 10.0 * ACROSS - 0.6 * FORCE
    assert reactions(answers) == {
        "at 1 m": pytest.approx(along, rel=1e-3),
        "lug at 4 m": pytest.approx(0.8 * FORCE, rel=1e-3),
    }
    for quantity, force in (
        ("reaction", across),
        ("axial_reaction", along),
        ("foot_reaction", np.hypot(along, across)),
    ):
        row = moved(answers, quantity)
        assert abs(row.value) == pytest.approx(abs(force), rel=2e-3)
        assert answers.rows.at_rest(row) == pytest.approx(abs(force), rel=2e-3)
    # Without the part before the pin, and with 200 kg at the pin, which have no moment.
    masses = "masses = [{ x = 1.0, mass = 200.0 }]\n[[cylinder]]"
    text = edited(CASE, ("span = [0.0, 10.0]", "span = [1.0, 10.0]"), ("[[cylinder]]", masses))
    lug = 0.8 * ACROSS * 9.0 * 4.5 / (0.6 * 3.0)
    found = reactions(answers_of(read_case(tmp_path, text)))["at 1 m"]
    assert found == pytest.approx(9.0 * ALONG + 1000.0 - lug, rel=2e-3)


def test_the_fibre_feels_the_normal_force(answers: Results) -> None:
    """Reference: by hand, M z/J + N/A before the lug, with M = q 6²/2."""
    fibre = moved(answers, "stress")
    bent = 0.5 * ACROSS * 6.0**2 * 0.204 / BOX.second_moment_of_area
    pulled = (0.8 * FORCE - 6.0 * ALONG) / BOX.area
    assert fibre.x == pytest.approx(4.0)
    assert fibre.value == pytest.approx(bent + pulled, rel=2e-3)


def test_stress_figure_states_the_largest_stresses() -> None:
    """Reference: the given stresses of an element and of a patch."""
    where = {"segment": "inner", "x": 9.0, "time": 0.4}
    patch = {"von_mises": 3.1e7, **where}
    of_element = {"wall": "right", "face": "outer", "y": 0.1, "z": 0.0, "band": 0.25}
    stress = {"von_mises": 9.16e7, **where, **of_element, "patch": patch}
    stresses = np.array([[[1e7], [1e7]], [[9e7], [3.1e7]]])
    dims = ("time", "segment", "place")
    near = xr.Dataset(
        {"von_mises": (dims, stresses), "von_mises_patch": (dims, 31.0 / 90.0 * stresses)},
        coords={"time": [0.15, 0.45], "segment": ["outer", "inner"], "place": [9.0]},
    )
    tip = (("model", "time"), np.zeros((1, 601)))
    data = xr.Dataset({"tip": tip}, {"model": ["shell"], "time": np.arange(601) / 1000})
    case = case_file.select(shipped("coarse"), "", ["shell"], None)
    summary = summary_of({"shell": model_summary(stress=stress)})
    results = Results(case, data, summary, curves=Curves(histories(near, "shell")))
    with matplotlib.rc_context(theme.RC):
        (figure,) = stress_history(FigureContext(results))
    assert figure.title == "shell: local plate stress up to 31 MPa, in one element up to 91.6 MPa"


def test_check_shows_the_cylinder_and_the_axial_forces(tmp_path: Path) -> None:
    """Reference: by hand, 5 m, 3/5 of 3 m to the pin, and 6 m of weight beyond the lug."""
    told = printed_check(read_case(tmp_path, CASE)).replace("−", "-")

    def row(heading: str) -> list[float]:
        lines = told.split(heading)[1].splitlines()
        return [float(cell) for cell in next(line for line in lines if "arm" in line).split()[1:]]

    assert row("cylinder of") == pytest.approx([4.0, 5.0, 1.8, FORCE / 1e3], rel=1e-3)
    assert row("Extreme axial")[0] == pytest.approx((0.8 * FORCE - 6.0 * ALONG) / 1e3, rel=1e-3)


LAW_OF_JOINT = "stiffness = 1e13\nexponent = 2.0\n"


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (f"{CANTILEVER}[buckling]\ncurve = [[2.0, 0.3], [0.0, 1.0]]",
         "buckling.curve: slendernesses must rise; entry 2 is below entry 1: sort them"),
        (f"{CANTILEVER}[buckling]\ncurve = [[0.0, 0.8], [1.0, 0.8], [2.0, 0.9]]",
         "buckling.curve: reduction factors must not rise; entry 3 is above entry 2"),
        # Its factor would hold for every slenderness.
        (f"{CANTILEVER}[buckling]\ncurve = [[0.0, 1.0]]",
         "buckling.curve: must have 2 pairs at least, got 1"),
        (f"{CANTILEVER}[slew]\ntable = [[0.0, 0.0], [2.0, 9.0], [1.0, 5.0]]",
         "slew.table: times must rise; entry 3 is below entry 2: sort them"),
        (f"{CANTILEVER}[[load]]\nsegment = 'beam'\nmagnitude = 1.0\ntable = [[0, 1], [0, 2]]",
         "load[1].table: times must rise; entry 2 repeats that of entry 1"),
        (CANTILEVER.replace("7850.0", "7850.0, yield_by_thickness = [[0.01, 3e8], [0.02, 4e8]]"),
         "material.yield_by_thickness: strengths must not rise; entry 2 is above entry 1"),
        (edited(COARSE, (LAW_OF_JOINT, "force_table = [[2e-3, 9.0], [1e-3, 2.0]]\n")),
         "joint[1].force_table: depths must rise; entry 2 is below entry 1: sort them"),
    ],
)  # fmt: skip
def test_pairs_out_of_order_are_refused(tmp_path: Path, text: str, line: str) -> None:
    """Reference: exact words."""
    assert refusal(tmp_path, text) == line


# Pairs without an order: points around a section, and modes.
UNORDERED = {"corners", "shaper"}


def parts_of(annotation: Any) -> Iterator[Any]:
    """Yield all parts of a type, also the metadata of annotated types."""
    yield annotation
    for part in get_args(annotation):
        yield from parts_of(part)


def test_every_table_of_pairs_is_checked() -> None:
    """Reference: exhaustive, all keys of the schema whose values are pairs of numbers. A curve may
    stay level.
    """
    tables = [messages.schema.Case, *dict.fromkeys(messages._TABLES.values())]
    pairs, checked = set(), set()
    for schema in tables:
        for key, name in names_of(schema).items():
            field = fields_of(schema)[name]
            for part in (*field.metadata, *parts_of(field.annotation)):
                inner = get_args(part)
                of_pair = get_args(inner[0]) if len(inner) == 2 and inner[1] is ... else ()
                if len(of_pair) == 2 and all(float in {*parts_of(one)} for one in of_pair):
                    pairs.add(key)
                if isinstance(part, AfterValidator) and part.func.__qualname__.startswith(
                    "rising."
                ):
                    checked.add(key)
    assert {"curve", "table", "force_table", "yield_by_thickness"} <= pairs
    assert pairs - checked == UNORDERED
    assert BucklingTable(curve=((0.0, 1.0), (0.5, 1.0), (2.0, 0.3)))

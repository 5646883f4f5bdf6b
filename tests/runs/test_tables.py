# SPDX-License-Identifier: LGPL-3.0-or-later
"""Printed tables, numbers and units of cases and results."""

import base64
import json
import math
import re
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, get_args, get_origin

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from protractile.cases import change, run_case
from protractile.geometry.fields import declared_units, describe, fields_of
from protractile.geometry.typography import fixed, number, scientific
from protractile.geometry.units import System, Unit
from protractile.runs.case import toml
from protractile.runs.case.amounts import convert_to_si
from protractile.runs.case.build import build_boom
from protractile.runs.case.contact import ContactTable, JointTable
from protractile.runs.case.messages import _tables as tables_of
from protractile.runs.case.reading import load_checked
from protractile.runs.case.schema import Case, case_schema
from protractile.runs.case.starting_points import write_case
from protractile.runs.cautions import rules
from protractile.runs.cautions.context import Context
from protractile.runs.options import Kind, Standard
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.model_quality import main_models
from protractile.runs.pipeline.proofs import prove
from protractile.runs.report import theme
from protractile.runs.report.charts import MOST, Chart, Curve, extremes, pack_charts
from protractile.runs.report.output import WORKBOOK, write_workbook
from protractile.runs.report.tables import Amount, Column, Table
from protractile.runs.sweep.points import plan
from tests.runs.case_texts import CANTILEVER, STEEL, edited, elements, read_case, refused, shipped
from tests.runs.summaries import printed, printed_check
from tests.touching import contact_laws


def test_markdown_has_one_line_a_row_and_the_terminal_all_cells() -> None:
    """Reference: by hand, characters of the columns and three spaces between them."""
    rows = [("beam", "1 s\n2 mm"), ("[b]", "–")]
    table = Table.of_rows("peaks", "Peaks", ("model", "first\nmm"), rows, ("A note.",))
    assert table.markdown().splitlines() == [
        "## Peaks", "", "| model | first mm |", "| :-- | --: |", "| beam | 1 s 2 mm |",
        "| [b] | – |", "", "A note.",
    ]  # fmt: skip
    lines = [line.split() for line in printed(table.show, width=60).splitlines()]
    assert ["beam", "1", "s"] in lines
    assert ["[b]", "–"] in lines
    headings = ["contact", "dynamic", "factor", "mode"]
    narrow = Table("", [Column(one, [1.0], ".2f") for one in headings])
    assert printed(narrow.show, width=30).split()[:4] == headings
    # This table needs 24 characters with whole cells, 19 with whole words.
    columns = [Column("long heading of", ["41.3 bending"]), Column("two words", ["2 × 10⁻¹²"])]
    wide, thin = (printed(Table("", columns).show, width=width) for width in (24, 20))
    assert "41.3 bending" in wide
    assert "2 × 10⁻¹²" in thin


def test_rows_are_in_the_units_of_their_headings_as_json_says_them() -> None:
    """Reference: by hand. Half the range of repetitions, 10 ms, leaves two digits of the median."""
    columns = (
        Column("model", ["beam", "shell"]),
        Column("steps", [7, np.int64(8)]),
        Column("wall", [[0.5, math.inf], 0.25], ".1f", "ms"),
        Column("peak", [2, math.nan], ".1f", "mm"),
        Column("shorter", [None]),
    )
    assert json.dumps(Table("Found", columns).data) == (
        '[{"model": "beam", "steps": 7, "wall\\nms": [500.0, null], "peak\\nmm": 2000.0, '
        '"shorter": null}, {"model": "shell", "steps": 8.0, "wall\\nms": 250.0, '
        '"peak\\nmm": null, "shorter": null}]'
    )
    assert Column("wall", [[0.41, 0.42, 0.43]], ".1f", "ms").text == ["420"]
    twice = Table("Peaks", (Column("mm", [1.0]), Column("mm", [2.0])))
    with pytest.raises(ValueError, match="two columns have the same heading"):
        assert twice.data


@pytest.mark.parametrize(
    ("shown", "expected"),
    [
        (scientific(8.3e-5, 1), "8 × 10⁻⁵"), (scientific(2.41e6, 3), "2.41 × 10⁶"),
        (scientific(1e-6, 3), "1 × 10⁻⁶"), (number(None), "–"), (number(math.nan), "–"),
        (number(0.0), "0"), (number(0.498484), "0.498"), (number(8.7669), "8.77"),
        (number(2000), "2000"), (number(45485.3), "45500"), (number(2.41e6), "2.41 × 10⁶"),
        (number(6.4836e-15), "6.48 × 10⁻¹⁵"), (number(-0.00042), "−4.2 × 10⁻⁴"),
        (number(-3.5), "−3.5"), (fixed(None, 1, 1000.0), "–"), (fixed(math.inf, 1, 1000.0), "–"),
        (fixed(0.1684, 1, 1000.0), "168.4"), (fixed(-0.002, 1, 1000.0), "−2.0"),
        (fixed(-4e-5, 1, 1000.0), "0.0"),
    ],
)  # fmt: skip
def test_numbers_have_so_many_digits_or_decimals(shown: str, expected: str) -> None:
    assert shown == expected


def test_numbers_come_as_they_are() -> None:
    """Reference: the values, to the 24 bits of a 32-bit float. A name cannot end the script."""

    def unpacked(packed: dict[str, str]) -> np.ndarray:
        return np.frombuffer(base64.b64decode(packed["bdata"]), f"<{packed['dtype']}")

    time, values = np.linspace(0.0, 1.0, 7), np.array([0.0, 1.5, -2.25, 3.1, 1e-9, 7.0, 8.0])
    text = pack_charts({"tip": Chart(time, [Curve("</script>", values, "#000000")])})
    assert "<" not in text
    chart = json.loads(text)["tip"]
    (curve,) = chart["data"]
    assert curve["name"] == "</script>"
    np.testing.assert_array_equal(unpacked(chart["layout"]["meta"]["x"]), time)
    np.testing.assert_allclose(unpacked(curve["y"]), values, rtol=2.0**-24)


def test_thinned_curves_keep_their_extremes() -> None:
    """Reference: analytic, samples of noise. Every interval keeps its minimum and maximum."""
    noise = np.random.default_rng(1).standard_normal(50_000)
    kept = extremes(noise, 100)
    assert kept.size <= 202
    for stretch, inside in zip(np.split(noise, 100), np.split(np.arange(50_000), 100), strict=True):
        mine = noise[np.intersect1d(kept, inside)]
        assert (mine.min(), mine.max()) == (stretch.min(), stretch.max())
    time = np.linspace(0.0, 10.0, 3 * MOST)
    (curve,) = Chart(time, [Curve("a", np.sin(50.0 * time), "#000000")]).plain["data"]
    assert curve["x"].size <= MOST + 2
    np.testing.assert_allclose(curve["y"], np.sin(50.0 * curve["x"]), atol=1e-7)


def test_shell_beam_and_bonded_are_read_first() -> None:
    """Reference: the case files."""
    for name, first in (
        ("paper", {"beam-fe", "beam-fe-bonded", "shell"}),
        ("lift", {"timoshenko", "shell", "bonded"}),
        ("three-segments", {"timoshenko", "shell", "beam-fe-bonded"}),
    ):
        case = shipped(name)
        assert main_models(case, [model.name for model in case.models]) == first


def test_colours_are_distinct() -> None:
    """Reference: external, WCAG 2.1. A graphical object needs a contrast of 3 to the paper."""
    for colour in (*theme.PALETTE, theme.PLAY_FREE):
        linear = [
            c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)
        ]
        luminance = float(np.dot(linear, [0.2126, 0.7152, 0.0722]))
        assert 1.05 / (luminance + 0.05) > 3.0, colour
    # More models than colours still differ.
    names = [f"model {i}" for i in range(3 * len(theme.PALETTE))]
    drawn = theme.line_styles([*names, "bonded"], ["bonded"])
    assert len(set(drawn.values())) == len(names) + 1


def test_amounts_are_numbers_with_a_column_of_their_units() -> None:
    """Reference: by hand."""
    cells = [Amount.of(-2.61, "m", "*"), Amount.of(1.5e8, "Pa"), None]
    table = Table("", [Column("result", ["tip", "stress", "none"]), Column("most", cells)])
    assert table.columns[1].text == ["−2610 mm*", "150 MPa", "–"]
    assert table.flat_frame.to_dict("list") == {
        "result": ["tip", "stress", "none"],
        "most": [-2610.0, 150.0, None],
        "most, unit": ["mm", "MPa", None],
    }


@pytest.mark.slow
def test_a_title_is_no_formula(tmp_path: Path) -> None:
    """Reference: other code, the types of cells as openpyxl reads them."""
    openpyxl = pytest.importorskip("openpyxl")
    results = run_case(read_case(tmp_path, edited(CANTILEVER, ('"Cantilever"', '"=1+2"'))))
    write_workbook(results, tmp_path, "kept", "--excel")
    book = openpyxl.load_workbook(tmp_path / WORKBOOK)
    cell = book["quantities"]["A1"]
    assert (cell.value, cell.data_type) == ("=1+2: SI units", "s")
    types = {one.data_type for sheet in book for row in sheet.iter_rows() for one in row}
    assert "f" not in types


def test_a_title_is_no_card() -> None:
    """Reference: CalculiX manual: a line that begins with one asterisk is a card."""
    pytest.importorskip("dolfinx", reason="shells need FEniCSx")
    from protractile.runs.export.calculix import deck

    lines = deck("*INCLUDE, INPUT=other.inp", [], [], []).splitlines()
    assert lines[:2] == ["*HEADING", "Boom: *INCLUDE, INPUT=other.inp"]


@pytest.mark.parametrize(
    ("message", "shown"),
    [
        ("must be between 0 and 4.8 m, got 4.9 m", "must be between 0 and 4800 mm, got 4900 mm"),
        ("-0.033 m of 150 kg at 2e8 Pa and 3 m/s",
         "-33 mm of 0.15 t at 200 MPa and 3000 mm/s"),
        ("at t = 0.5 s, of 20 N/m", "at t = 0.5 s, of 0.02 N/mm"),
        ("elements of x2 m and 5 mm", "elements of x2 m and 5 mm"),
    ],
)  # fmt: skip
def test_amounts_are_in_the_units_of_the_case(message: str, shown: str) -> None:
    """Reference: by hand."""
    assert System("mm-t-s").convert(message) == shown
    assert System().convert(message) == message


@pytest.mark.parametrize(
    ("standard", "count", "kind"),
    [*((Standard.EN13001, 4, kind) for kind in Kind), (Standard.EN280, 3, Kind.LIFT)],
)
@pytest.mark.slow
def test_a_new_case_passes_its_proofs_without_cautions(
    here: Path, standard: Standard, count: int, kind: Kind
) -> None:
    write_case("new.toml", standard, kind)
    checked = load_checked("new.toml")
    assert len(checked.case.combinations) == count
    assert rules.cautions(Context(checked.case, checked.boom), rules.OF_INPUTS) == []
    proofs = prove(checked.case, combination_states(checked.case))
    assert proofs.rows
    assert all(abs(row.value) <= row.limit for row in proofs.rows if row.limit is not None)
    with refused("new.toml: file: exists already; give another name"):
        write_case("new.toml", standard, kind)


IN_SI = """
title = "A crane"
{units}
time = {{ duration = 2.0 }}
start = {{ velocity = {{ fly = 0.1, base = {{ turn = 0.02 }} }} }}
damping = {{ stiffness = 1e-4, mass = 0.03 }}
limits = {{ tip = 0.9, stress = 160e6 }}
base = [{{ acceleration = 0.3, frequency = 1.7 }}]
stop = [{{ segment = "fly", x = 15.0, play = 0.2, stiffness = 3e9, exponent = 1.5 }}]
load = [
  {{ segment = "fly", x = "head", magnitude = -2000.0, table = [[0.0, 0.0], [0.5, 1.0]] }},
  {{ segment = "fly", x = "head", magnitude = 350.0, moment = true }},
  {{ segment = "fly", magnitude = -12.0, file = "gust.csv" }},
]
{steel}
[[segment]]; name = "base"; length = 10.0; \
supports = [0.0, {{ x = {{ tail = 1.5 }}, stiffness = 5e7 }}]; \
section = {{ height = 0.47, width = 0.3, flange = 0.0066, web = 0.006 }}; load = -831.6
[[segment]]; name = "fly"; length = 9.7; masses = [{{ x = 11.5, mass = 120.0 }}]; \
mass_per_length = 55.07; second_moment_of_area = 2.1829e-4; rotary_inertia = 1.68; \
viscous_damping = 3.0
[[joint]]; outer = "base"; inner = "fly"; extension = 8.2; stations = ["tail", {{ head = 0.3 }}]; \
play = 0.0097; stiffness = 1e13; restitution = {{ coefficient = 0.8, speed = 0.1 }}; \
dashpot = 2000.0; \
drive = {{ travel = 0.4, speed = 0.7, least_overlap = 0.6, stiffness = 2e5, dashpot = 500.0 }}
{beam}
[[model]]; name = "soft"; kind = "finite-element"; theory = "euler-bernoulli"; \
contact = {{ force_table = [[1e-4, 900.0], [2e-4, 2500.0]] }}
""".replace("; ", "\n")
BEAM = elements("beam", theory="euler-bernoulli", element_length=0.25)

# What stands for it in mm, t and s, key by key.
IN_MM = (
    ("2.1e11", "2.1e5"), ("7850.0", "7.85e-9"), ("length = 10.0", "length = 10000.0"),
    ("tail = 1.5", "tail = 1500.0"), ("5e7", "5e4"), ("0.47", "470.0"),
    ("width = 0.3,", "width = 300.0,"), ("0.0066", "6.6"), ("0.006 ", "6.0 "),
    ("-831.6", "-0.8316"), ("9.7\n", "9700.0\n"), ("11.5", "11500.0"), ("120.0", "0.12"),
    ("55.07", "5.507e-5"), ("2.1829e-4", "2.1829e8"), ("1.68", "1.68"),
    ("viscous_damping = 3.0", "viscous_damping = 3e-6"), ("8.2", "8200.0"),
    ("head = 0.3", "head = 300.0"), ("0.0097", "9.7"), ("1e13", "1e7"),
    ("speed = 0.1", "speed = 100.0"), ("dashpot = 2000.0", "dashpot = 2.0"),
    ("tip = 0.9, stress = 160e6", "tip = 900.0, stress = 160.0"),
    ("travel = 0.4, speed = 0.7", "travel = 400.0, speed = 700.0"),
    ("least_overlap = 0.6", "least_overlap = 600.0"),
    ("stiffness = 2e5, dashpot = 500.0", "stiffness = 200.0, dashpot = 0.5"),
    ("15.0", "15000.0"), ("play = 0.2", "play = 200.0"), ("350.0", "3.5e5"), ("-12.0", "-0.012"),
    ("acceleration = 0.3", "acceleration = 300.0"), ("fly = 0.1", "fly = 100.0"),
    ("element_length = 0.25", "element_length = 250.0"),
    ("1e-4, 900.0], [2e-4, 2500.0", "0.1, 900.0], [0.2, 2500.0"),
)  # fmt: skip


@pytest.fixture(autouse=True)
def _folder(here: Path) -> None:
    Path("gust.csv").write_text("0, 0.2\n3, 1.0\n", encoding="utf-8")


def written(units: str = "", extra: tuple[tuple[str, str], ...] = ()) -> str:
    return edited(IN_SI.format(units=units, steel=STEEL, beam=BEAM), *extra)


case_of = partial(read_case, Path())


def in_mm(units: str = "mm-t-s") -> Case:
    return case_of(written(f'units = "{units}"', IN_MM))


@pytest.mark.parametrize("units", ["mm-t-s", "N-mm"])
def test_a_case_in_millimetres_is_the_same_case(units: str) -> None:
    """Reference: analytic, the same numbers in SI units, decimal by decimal."""
    expected, found = case_of(written()), in_mm(units)
    assert (found.units, found.shown_units) == ("SI", units)
    # That of the exponent 3/2, N/mm^1.5, is no decimal; 3e9 N/m^1.5 was left as it is.
    stop = replace(found.stops[0], stiffness=3e9)
    assert found.stops[0].stiffness == pytest.approx(3e9 * 1000.0**1.5, rel=1e-15)
    same = found.model_copy(update={"shown_units": None, "stops": (stop,)})
    assert same == expected
    assert build_boom(same) == build_boom(expected)
    for model, other in zip(same.models, expected.models, strict=True):
        assert contact_laws(same, model) == contact_laws(expected, other)


def test_defaults_and_the_effective_case_are_in_si_units() -> None:
    """Reference: non-regression, the defaults in SI units; the numbers of the case file."""
    case = in_mm()
    assert case.time.output_step == 1.0e-3
    assert case.models[1].model_dump()["element_length"] == 0.5
    text = toml.dumps(case)
    assert 'units = "SI"\nshown_units = "mm-t-s"\n' in text
    assert case_of(text) == case
    # A change in Python is in SI units.
    assert change(case, **{"joint.play": 0.02}).joints[0].play == 0.02
    shown = [" ".join(line.split()) for line in printed_check(case).splitlines()]
    assert "segment mm kg/m mm⁴ kg m flange / web, mm" in shown
    assert "segment kg kg mm" in shown
    (fly,) = (line for line in shown if "8500–18200" in line)
    assert "55.07 2.183 × 10⁸" in fly


def test_files_are_in_the_units_of_the_case_unless_they_say_others() -> None:
    """Reference: analytic. -0.012 N/mm at the factor 1, and -0.012 times 1000 N/m."""
    for heading, size in (("t,F", 1), ("t [s],F [N/mm]", 1), ("t [s],F [N/m]", 1000)):
        Path("gust.csv").write_text(f"{heading}\n0,0\n3,{size}\n", encoding="utf-8")
        gust = in_mm().loads[2]
        assert gust.magnitude * gust.table[1][1] == pytest.approx(-12.0, rel=1e-15)


@pytest.mark.parametrize(
    ("own", "sides", "power"),
    [
        ("stiffness = 1e3", "", 2.0),
        ("stiffness = 1e3\nexponent = 1.5", "lateral_stiffness = 1e3\nlateral_exponent = 1.0", 1.0),
        ("stiffness = 1e3\nexponent = 1.5", "lateral_stiffness = 1e3", 1.5),
        ("pad = { length = 100.0, width = 50.0, thickness = 20.0 }", "lateral_stiffness = 1e3", 1),
    ],
)
def test_a_stiffness_has_the_unit_of_its_own_law(own: str, sides: str, power: float) -> None:
    """Reference: analytic, N/mmⁿ times 1000ⁿ, with the exponent that the law presses by.

    A model's own contact has an exponent of its own, 2 unless given.
    """
    laws = tomllib.loads(f"{own}\n{sides}")
    joint = JointTable("base", "fly", stations=(1.0,), play=1.0, lateral_play=1.0, **laws)
    model = in_mm().models[0].model_copy(update={"contact": ContactTable(stiffness=1e3)})
    update = {"units": "mm-t-s", "joints": (joint,), "models": (model,)}
    case = convert_to_si(in_mm().model_copy(update=update))
    found = case.joints[0].lateral_stiffness if sides else case.joints[0].stiffness
    assert found == pytest.approx(1e3 * 1000.0**power, rel=1e-15)
    assert case.models[0].contact.stiffness == pytest.approx(1e9, rel=1e-15)


@pytest.mark.parametrize(
    ("text", "unit", "expected", "value"),
    [
        ("joint.extension=6000,7000", "mm", [6.0, 7.0], lambda c: c.joints[0].extension),
        ("joint.stiffness=1e4,1e7", "N/mm^2", [1e10, 1e13], lambda c: c.joints[0].stiffness),
        ("load[2].magnitude=1000,2000", "N mm", [1.0, 2.0], lambda c: c.loads[1].magnitude),
        ("start.velocity.fly=5,9.7", "mm/s", [0.005, 0.0097],
         lambda c: c.start.velocity["fly"].z),
    ],
)  # fmt: skip
def test_a_sweep_s_values_are_in_the_units_of_the_case(
    text: str, unit: str, expected: list[float], value: Callable[[Case], float]
) -> None:
    """Reference: analytic. Keys of several units, and a number that stands for a table."""
    in_mm()
    planned = plan("case.toml", [text], None, None)
    assert list(planned.units) == [unit]
    values = [float(part) for part in text.partition("=")[2].split(",")]
    assert list(planned.variations[0].values) == values
    assert [value(point.case) for point in planned.points] == expected


def test_numbers_out_of_range_and_other_systems_are_refused() -> None:
    text = written('units = "mm-t-s"', IN_MM).replace("7.85e-9", "7.85e299")
    with refused(
        "case.toml: units: a number is too large for SI units; look for one that is out of "
        "proportion"
    ):
        case_of(text)
    in_mm()
    with refused(
        "case.toml: --vary material.density=1e+300: a value is too large for SI units; give "
        "smaller ones"
    ):
        plan("case.toml", ["material.density=1e-9,1e300"], None, None)
    with refused("case.toml: units: must be 'SI', 'mm-t-s' or 'N-mm', got 'inch-lbf-s'"):
        in_mm("inch-lbf-s")


def test_every_number_declares_its_unit() -> None:
    """Reference: the descriptions, which name the unit of each number for people."""

    def parts(annotation: Any) -> Iterator[Any]:
        yield annotation
        for part in get_args(annotation) if get_origin(annotation) else ():
            yield from parts(part)

    tables = {Case, *(table for _, table in tables_of(Case))}
    fields = {(one, key): field for one in tables for key, field in fields_of(one).items()}
    assert len(fields) > 100
    for name, field in fields.items():
        if float not in parts(field.annotation):
            continue
        units = declared_units(field)
        assert units, f"{name} declares no unit: give it Annotated[..., In(...)]"
        for unit in units:
            Unit.of(re.sub(r"\^\(?n.*", "", unit))
            text, word = describe(*name), re.escape({"deg": "degrees"}.get(unit, unit))
            # As a word, and not as a part of another word or unit.
            named = unit == "1" or re.search(rf"(?<![\w/^·]){word}(?![\w/^²])", text)
            assert named or "the same" in text or "such pairs" in text, name
    properties = case_schema()["$defs"]["TimeTable"]["properties"]
    assert properties["duration"]["unit"] == "s"


def test_systems_name_their_units() -> None:
    system = System("mm-t-s")
    units = ("m", "kg/m^3", "N/m^n", "Pa", "N s/m", "kg m", "1/s", "Hz", "m/s^2", "deg")
    assert [system.unit(unit) for unit in units] == [
        "mm", "t/mm^3", "N/mm^n", "MPa", "N s/mm", "t mm", "1/s", "Hz", "mm/s^2", "deg"
    ]  # fmt: skip
    assert float(system.size("kg/m^3")) == 1e12
    assert system.of(7850.0, "kg/m^3") == 7.85e-9
    assert System().of(0.1, "m") == 0.1

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables and charts, their texts and units, and case files that `protractile new` writes."""

import base64
import json
import math
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from protractile.cases import run_case
from protractile.geometry.typography import fixed, number, scientific
from protractile.geometry.units import System
from protractile.runs.case.reading import load_checked
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
from tests.runs.case_texts import CANTILEVER, edited, read_case, refused, shipped
from tests.runs.summaries import printed


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

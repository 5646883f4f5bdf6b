# SPDX-License-Identifier: LGPL-3.0-or-later
"""Texts of a case stay texts in files that other programs interpret."""

from pathlib import Path

import pytest

from protractile.cases import run_case
from protractile.runs.report.output import WORKBOOK, write_workbook
from tests.runs.cantilever import CANTILEVER
from tests.runs.case_texts import edited, read_case


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

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Share of the deflection by walls and sections that yield under pads, and remedies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from protractile.runs import CASES
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import cautions
from protractile.runs.check import check_case
from protractile.runs.pipeline.results import Results
from tests.docs.conftest import toml_blocks
from tests.runs.case_texts import (
    REST,
    STEEL,
    THIN,
    edited,
    elements,
    read_case,
    shipped,
    table,
)
from tests.runs.summaries import model_summary, summary_of
from tests.runs.test_statics import told


def test_walls_under_pads_lower_the_tip_as_in_the_shell() -> None:
    """Reference: other code, the shell of the lift at rest, −229.12 mm (−190.18 mm of its beam)."""
    lines = told(shipped("lift"))
    (tip,) = (line for line in lines if line.startswith("Static tip deflection"))
    assert float(tip.split(": ")[1].split()[0]) == pytest.approx(-229.12, rel=0.01)


def test_remedies_for_walls_under_pads_count_under_the_largest_loads() -> None:
    """Reference: the same loads from t = 0 on, without a ramp."""
    case = shipped("lift")
    share, *remedies = pad_wall_sentences(case)
    assert share == (
        "Walls bend under pads, which moves the tip by -60.66 of -378.5 mm, 16 %, under the loads "
        "at t = 0.1 s (estimate from plates)."
    )
    assert remedies == [
        "Remedies, each with the static tip deflection that it gives under these loads (for local "
        "plate stresses, run a shell with the remedy):",
        "- -317.9 mm: pads that bear on the corners, bears = 'corner'",
        "- -333 mm: collars around both segments at each pad, as thick as the walls and one "
        "section height long (the boom can then not telescope)",
    ]
    (load,) = case.loads
    sudden = case.model_copy(update={"loads": (load.model_copy(update={"ramp": None}),)})
    assert pad_wall_sentences(sudden) == [share.replace("0.1 s", "0 s"), *remedies]


def test_remedies_leave_out_collars_that_are_there(tmp_path: Path) -> None:
    """Reference: by construction. Collars of half a millimetre, along all segments."""
    text = (CASES / "lift.toml").read_text("utf-8")
    collars = 'collars = [{ span = ["tail", "head"], thickness = 5e-4 }]\nsection ='
    case = read_case(tmp_path, text.replace("section =", collars))
    remedies = " ".join(pad_wall_sentences(case))
    assert "bears = 'corner'" in remedies
    assert "collars" not in remedies


def test_walls_on_corners_have_no_share(tmp_path: Path) -> None:
    """Reference: by construction, pads on the corners of boxes; exact words without telescoping."""
    text = (CASES / "lift.toml").read_text("utf-8")
    case = read_case(tmp_path, text.replace("pad = {", 'pad = { bears = "corner",'))
    assert pad_wall_sentences(case) == []
    shown = check_case(CheckedCase(case))
    (notes,) = (one.notes for one in shown.tables if one.title.startswith("Extreme axial forces"))
    assert notes == ["Includes the cylinder forces at t = 0."]


def test_a_tip_that_rigid_sections_overestimate_by_half_causes_a_caution(tmp_path: Path) -> None:
    """Reference: other code, a shell of edges of 0.15 m under a lateral force of 3 kN: −26.0 mm.

    Rigid sections give −39.1 mm, 50 % more. Forces of lateral pads widen the section upwards,
    which closes the vertical play.
    """
    pad = {"length": 0.2, "width": 0.06, "thickness": 0.02, "bears": "corner"}
    sizes = ("shape", "height", "width", "chamfer", "top", "bottom", "web")
    outer = dict(zip(sizes, ("octagon", 0.56, 0.56, 0.15, 0.007, 0.007, 0.007), strict=True))
    inner = dict(zip(sizes, ("octagon", 0.50, 0.50, 0.135, 0.006, 0.006, 0.006), strict=True))
    clamp = [{"x": 0.0, "kind": "clamped"}]
    joint = {"outer": "outer", "inner": "inner", "extension": 6.2, "play": 0.003}
    load = {"segment": "inner", "x": "head"}
    text = "".join(
        (
            'title = "Mast"\n' + table("[time]", duration=5.0) + STEEL,
            table("[gravity]", angle=90.0) + REST + table("[payload]", mass=3000.0),
            table("[[axial]]", force=120000.0) + elements("beam"),
            table("[[segment]]", name="outer", length=7.5, supports=clamp, section=outer),
            table("[[segment]]", name="inner", length=7.5, section=inner),
            table("[[load]]", **load, direction="y", magnitude=3100.0),
            table("[[load]]", **load, magnitude=-2000.0),
            table("[[joint]]", **joint, lateral_play=0.003, pad=pad, stations=["tail", "head"]),
        )
    )
    lines = check_case(CheckedCase(read_case(tmp_path, text))).lines
    (line,) = (one for one in lines if "distort under pads" in one)
    assert line.startswith("caution: sections distort under pads, which moves the tip by 1")
    assert ", −5" in line


def test_sections_that_distort_have_their_share_and_remedies(tmp_path: Path) -> None:
    """Reference: other code, a shell of edges of 50 mm at −444.7 mm; by hand without, −265 mm."""
    pad = {"length": 0.25, "width": 0.07, "thickness": 0.02, "bears": "corner"}
    sizes = ("shape", "height", "width", "flat", "top", "bottom", "web")
    outer = dict(zip(sizes, ("hexagon", 0.82, 0.58, 0.39, 0.008, 0.011, 0.007), strict=True))
    inner = dict(zip(sizes, ("hexagon", 0.74, 0.50, 0.32, 0.007, 0.009, 0.006), strict=True))
    clamp = [{"x": 0.0, "kind": "clamped"}]
    text = "".join(
        (
            'title = "Hexagons"\n'
            + table("[time]", duration=5.0)
            + STEEL
            + table("[gravity]", angle=0.0)
            + REST,
            table("[payload]", mass=6000.0) + elements("beam"),
            table("[[segment]]", name="outer", length=8.7, supports=clamp, section=outer),
            table("[[segment]]", name="inner", length=8.7, section=inner),
            table("[[joint]]", outer="outer", inner="inner", extension=7.1, play=0.004, pad=pad)
            + 'stations = ["tail", "head"]',
        )
    )
    lines = [
        line.replace("−", "-") for line in check_case(CheckedCase(read_case(tmp_path, text))).lines
    ]
    tip = next(line for line in lines if line.startswith("Static tip deflection"))
    assert ", with the compliance of sections under pads: -443.7 mm; with bonded" in tip
    first = lines.index(
        "Sections distort under pads, which moves the tip by -178.7 of -443.7 mm, 40 %, under the "
        "loads at t = 0 s (estimate from a frame of plates)."
    )
    assert lines[first + 2] == (
        "- -304.8 mm: collars around both segments at each pad, as thick as the walls and one "
        "section height long (the boom can then not telescope)"
    )
    assert lines[first + 3] == "Sections under pads are rigid in 'beam'."


def test_walls_under_pads_are_the_cause_of_a_large_deflection(tmp_path: Path) -> None:
    """Reference: exact words. A beam has rigid walls, so that its tip has another cause."""
    text = "".join(toml_blocks("tutorial.md")[:3])
    text = edited(text, *THIN, ("magnitude = -1595.0", "magnitude = -8500.0"))
    case = read_case(tmp_path, text)
    cause = "walls under pads cause most of it; change the pads"
    lines = check_case(CheckedCase(case)).lines
    (caution,) = (line for line in lines if "the tip rests" in line)
    assert caution.endswith(f" %; {cause}")
    names = ["shell", "beam"]
    data = xr.Dataset(
        {"tip": (("model", "time"), np.full((2, 1), -2.0)), "time": [0.0], "model": names}
    )
    summary = summary_of({name: model_summary(static_tip=-1.7) for name in names})
    lines = cautions(Context.of_run(Results(case, data, summary)))
    assert [line.rpartition(" %; ")[2] for line in lines if " tip " in line] == 2 * [
        cause,
        "check units and loads",
    ]


def pad_wall_sentences(case: Case) -> list[str]:
    lines = check_case(CheckedCase(case)).lines
    found = [line for line in lines if line.startswith(("Walls bend", "Remedies", "- "))]
    return [line.replace("−", "-") for line in found]

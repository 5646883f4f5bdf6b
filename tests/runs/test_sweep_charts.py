# SPDX-License-Identifier: LGPL-3.0-or-later
"""Charts of a sweep show what was computed, in units and places that a person reads."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
import xarray as xr
from matplotlib.figure import Figure as Sheet
from PIL import Image

from runs.pipeline.quantities import QUANTITIES
from runs.report import theme
from runs.report.formatting import number
from runs.sweep import output
from runs.sweep.figures import in_display_units
from runs.sweep.points import Plan
from runs.sweep.run import Outcome
from tests.runs.sweeping import FAST, Planned

# What invented numbers do not have, and what they give charts: all else that is no noise.
UNKNOWN = {"settling_time", "drive_speed"}
CHARTED = [one.name for one in QUANTITIES if one.charted and one.name not in UNKNOWN]


def written(
    sweeping: Plan, quantities: Sequence[str] = tuple(one.name for one in QUANTITIES)
) -> list[str]:
    """Draw invented numbers, with a gap; the names of what has been drawn."""
    outcomes = [
        Outcome(
            {
                name: {
                    quantity: 1.0 + 0.1 * i if quantity not in UNKNOWN else None
                    for quantity in quantities
                }
                for name in FAST[: 1 if i == 2 else 2]
            },
            {FAST[1]: "no number is finite"} if i == 2 else {},
        )
        for i in range(len(sweeping.points))
    ]
    out = Path("out")
    out.mkdir()
    output.write(sweeping, outcomes, out)
    return sorted(path.name for path in (out / "figures").glob("*.png"))


def charts(sweeping: Plan, *quantities: Sequence[str]) -> None:
    """Check that the charts are the same, and that none is empty."""
    for name in written(sweeping, *quantities):
        with Image.open(Path("out") / "figures" / name) as image:
            assert image.size[0] == round(theme.WIDTH * theme.DPI)
            assert np.asarray(image.convert("L")).min() < 128


@pytest.mark.usefixtures("unprinted")
@pytest.mark.parametrize(
    ("texts", "names"),
    [
        (["joint.play=0:0.01:4"], ["sweep-lines.png"]),
        (["joint.play=0:0.01:4", "joint.stiffness=1e8,1e9,1e10,1e11"],
         sorted(f"sweep-{name.replace('_', '-')}.png" for name in CHARTED)),
        (["joint.play=0,0.01", "segment[2].load=20,40,60", "damping.modal=0,0.1"],
         [f"sweep-lines-{number}.png" for number in range(1, 5)]),
    ],
    ids=["one key", "two keys", "three keys"],
)  # fmt: skip
def test_charts_fit_the_number_of_keys(
    planned: Planned, texts: list[str], names: list[str]
) -> None:
    """What no model has anywhere, the settling time here, has no chart, and noise has none."""
    assert written(planned(*texts)) == names


def test_maps_are_labelled_where_they_were_computed(planned: Planned, sheets: list[Sheet]) -> None:
    """Where many values are, or values here and there, others are labelled."""
    charts(planned("joint.play=0.006:0.014:3", "segment[2].load=20,40,45"), CHARTED[:1])
    axes = sheets[0].axes[0]
    assert axes.get_xlabel() == ""
    assert sheets[0].axes[1].get_xlabel() == "play (mm)"
    np.testing.assert_allclose(axes.get_xticks(), [6.0, 10.0, 14.0])
    assert axes.get_yticks().tolist() != [20.0, 40.0, 45.0]


def test_cells_of_a_map_show_their_values(planned: Planned, sheets: list[Sheet]) -> None:
    """Reference: the invented numbers, in kN; the fourth of one model is missing."""
    charts(planned("joint.play=0.006:0.014:3", "segment[2].load=20,40"), ["contact_force"])
    (sheet,) = sheets
    assert sheet.axes[-1].get_ylabel() == "contact force (kN)"
    shown = [sorted(text.get_text() for text in axes.texts) for axes in sheet.axes[:2]]
    forces = [1e-3 * (1.0 + 0.1 * i) for i in range(6)]
    assert shown[0] == sorted(number(force) for force in forces)
    assert shown[1] == sorted(number(force) for i, force in enumerate(forces) if i != 2)


def test_constant_quantity_has_no_panel(planned: Planned, sheets: list[Sheet]) -> None:
    """The mass of a boom whose play is varied; offsets stand at no axis."""
    sweeping = planned("joint.play=0:0.009:4")
    outcomes = [
        Outcome({name: {"mass": 1382.3, "stress": 5e7 + 1e3 * i} for name in FAST}, {})
        for i in range(4)
    ]
    Path("out").mkdir()
    output.write(sweeping, outcomes, Path("out"))
    assert [axes.get_title(loc="left") for axes in sheets[0].axes] == ["stress (MPa)"]
    (axes,) = sheets[0].axes
    assert axes.yaxis.get_major_formatter().get_offset() == ""


def test_keys_are_shown_in_units_of_their_size() -> None:
    """Reference: by hand."""
    data = xr.Dataset(
        coords={
            "play": ("play", [0.0, 0.0035], {"units": "m"}),
            "extension": ("extension", [0.5, 8.0], {"units": "m"}),
            "load": ("load", [-12e3, 500.0], {"units": "N"}),
            "small": ("small", [-120.0, 5.0], {"units": "N"}),
            "model": ("model", ["one"]),
        }
    )
    shown = in_display_units(data)
    expected = {
        "play": ([0.0, 3.5], "mm"), "extension": ([0.5, 8.0], "m"), "load": ([-12.0, 0.5], "kN"),
        "small": ([-120.0, 5.0], "N"),
    }  # fmt: skip
    for name, (values, unit) in expected.items():
        assert (shown[name].values.tolist(), shown[name].attrs["units"]) == (values, unit)


def test_lines_are_in_shown_units_with_gaps(planned: Planned, sheets: list[Sheet]) -> None:
    """Reference: the invented numbers, 1.0, 1.1, ... m and N, the third missing in one model."""
    charts(planned("joint.play=0:0.009:4"))
    (sheet,) = sheets
    panels = {axes.get_title(loc="left"): axes for axes in sheet.axes}
    assert list(panels) == [
        f"{quantity.title} ({quantity.shown_unit})"
        for quantity in QUANTITIES
        if quantity.name in CHARTED
    ]
    assert sheet.axes[-1].get_xlabel() == "play (mm)"
    for title, factor in (("tip amplitude (mm)", 1e3), ("contact force (kN)", 1e-3)):
        lines = {str(line.get_label()): line for line in panels[title].get_lines()}
        assert list(lines) == FAST
        for name, third in zip(FAST, (1.2, math.nan), strict=True):
            expected = factor * np.array([1.0, 1.1, third, 1.3])
            np.testing.assert_allclose(lines[name].get_ydata(), expected, rtol=1e-12)
            np.testing.assert_allclose(lines[name].get_xdata(), [0.0, 3.0, 6.0, 9.0])

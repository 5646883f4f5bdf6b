# SPDX-License-Identifier: LGPL-3.0-or-later
"""The drawing of a case's boom: everything that the case names, where it is."""

import numpy as np
import pytest
from matplotlib import rc_context
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from runs import CASES
from runs.case.build import build_boom
from runs.case.reading import load
from runs.report import theme
from runs.report.boom_drawing import boom_sheet
from runs.report.symbols import PAYLOAD, abbreviate, boom_symbols


def drawn(name: str) -> Figure:
    case = load(str(CASES / f"{name}.toml"))
    with rc_context(theme.RC):
        return boom_sheet(case, build_boom(case))


def legend(sheet: Figure) -> list[str]:
    return [text.get_text() for text in sheet.legends[0].get_texts()]


def test_a_lift_stands_at_its_angle() -> None:
    """Reference (analytic): a tip 15.7 m from the foot at 45 degrees is 11.10 m off and high."""
    whole = drawn("lift").axes[0]
    places = np.concatenate([line.get_xydata() for line in whole.lines])
    for reference in ((11.1016, 11.1016), (1.2728, -0.2828)):
        nearest = np.abs(places - reference).max(axis=1).min()
        assert nearest < 0.11  # half the height of the fly


def test_unequal_walls_are_labelled() -> None:
    """Reference: the case files; the lift's last box has walls of one thickness."""

    def sizes(name: str) -> list[str]:
        texts = [text.get_text() for axes in drawn(name).axes for text in axes.texts]
        return [text for text in texts if " × " in text]

    boxes = ["300 × 220\nweb 5\nflange 6", "256 × 180\nweb 4\nflange 5", "218 × 146\n4"]
    assert sizes("lift") == boxes
    assert sizes("crane")[0] == "940 × 680\nweb 6\nflanges\n8, 10"


def test_drawing_of_a_lift_labels_every_part() -> None:
    """Reference: the case file."""
    assert legend(drawn("lift")) == [
        "slide pads", "support", "cylinder, 30 MN/m", "payload, 150 kg",
        "1.595 kN down, perpendicular to the boom within 0.1 s", "play 3 mm",
        "self-weight, g = 9.807 m/s²",
    ]  # fmt: skip


def test_boom_in_space_shows_lateral_loads() -> None:
    """Reference: the case file; its gust is at most 1 times what its tables say."""
    found = legend(drawn("inspection-arm"))
    assert "sideways 4 mm" in found
    assert any("N/m sideways at most, root" in text for text in found)


@pytest.mark.parametrize("name", ["paper", "crane", "three-segments"])
def test_sections_are_as_large_as_the_case_says(name: str) -> None:
    """Reference: the boom's plates; patches of one panel have one scale."""
    boom = build_boom(load(str(CASES / f"{name}.toml")))
    panel = next(axes for axes in drawn(name).axes if axes.get_title("left").startswith("sections"))
    assert panel.get_aspect() == 1.0
    plates = [patch for patch in panel.patches if isinstance(patch, Polygon)]
    assert len(plates) == sum(len(s.section.plates) for s in boom.segments if s.section)
    first = boom.segments[0].section
    assert first is not None
    heights = np.concatenate([plate.get_xy()[:, 1] for plate in plates[: len(first.plates)]])
    low, high = first.reach("z")
    thickest = max(plate.thickness for plate in first.plates)
    assert high - low < np.ptp(heights) < high - low + 1.01 * thickest


def test_a_force_down_points_down() -> None:
    """Reference: an arrow's head is at the place that it marks; on a boom that stands upright what
    acts across it comes from the left, and a payload hangs all the same."""
    case = load(str(CASES / "crane.toml"))
    acts = {symbol.meaning: symbol for symbol in boom_symbols(case, build_boom(case))}
    load_across = acts["24.52 kN down, perpendicular to the boom within 0.5 s"]
    (_, tail), (_, head) = load_across.rotated(0.0).vertices[:2]
    assert tail > head == 0.0
    (x, z), _ = load_across.rotated(90.0).vertices[:2]
    assert (x, z) == pytest.approx((-1.0, 0.0), abs=1e-12)
    payload = acts["payload, 350 kg"]
    assert payload.rotated(60.0) is PAYLOAD


def test_amounts_are_read_at_a_glance() -> None:
    """Reference: by hand."""
    shown = [
        abbreviate(30e6, "N/m"),
        abbreviate(1595.0, "N"),
        abbreviate(83.16, "N/m"),
        abbreviate(-5e4, "N m"),
    ]
    assert shown == ["30 MN/m", "1.595 kN", "83.16 N/m", "−50 kN m"]

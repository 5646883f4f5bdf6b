# SPDX-License-Identifier: LGPL-3.0-or-later
"""Curves of the interactive charts, and their colours."""

import base64
import gzip
import json

import numpy as np
import pytest
from matplotlib.colors import to_rgb

from runs.pipeline.model_quality import main_models
from runs.report import theme
from runs.report.charts import MOST, Chart, Curve, extremes, pack_charts, pack_plotly
from tests.runs.case_texts import shipped


def unpacked(packed: dict[str, str]) -> np.ndarray:
    return np.frombuffer(base64.b64decode(packed["bdata"]), f"<{packed['dtype']}")


def test_numbers_come_as_they_are() -> None:
    """Reference: the values, to the 24 bits of a 32-bit float. A name cannot end the script."""
    time, values = np.linspace(0.0, 1.0, 7), np.array([0.0, 1.5, -2.25, 3.1, 1e-9, 7.0, 8.0])
    text = pack_charts({"tip": Chart(time, "mm", [Curve("</script>", values, "#000000")])})
    assert "<" not in text
    chart = json.loads(text)["tip"]
    (curve,) = chart["data"]
    assert curve["name"] == "</script>"
    np.testing.assert_array_equal(unpacked(chart["layout"]["meta"]["x"]), time)
    np.testing.assert_allclose(unpacked(curve["y"]), values, rtol=2.0**-24)


def test_panels_share_their_abscissa_and_fill_the_height() -> None:
    """Reference: analytic, two panels with ordinates of their own, the band before its curve."""
    time, values = np.linspace(0.0, 1.0, 3), np.array([1.0, 2.0, 3.0])
    limits = values - 1.0, values + 1.0
    curves = [Curve("a", values, "#000000", band=limits), Curve("a", values, "#000000", panel=1)]
    figure = Chart(time, "mm", curves, ["up", "down"]).figure
    assert [trace.yaxis for trace in figure.data] == ["y", "y", "y", "y2"]
    np.testing.assert_array_equal([trace.y for trace in figure.data[:2]], limits)
    assert [trace.showlegend for trace in figure.data] == [False, False, True, False]
    (low, high), (bottom, top) = figure.layout.yaxis.domain, figure.layout.yaxis2.domain
    assert (bottom, high) == (0.0, 1.0)
    assert low - top == pytest.approx(0.14)
    assert [note.text for note in figure.layout.annotations] == ["<b>up</b>", "<b>down</b>"]


def test_thinned_curves_keep_their_extremes() -> None:
    """Reference: analytic, samples of noise. Every interval keeps its minimum and maximum."""
    noise = np.random.default_rng(1).standard_normal(50_000)
    kept = extremes(noise, 100)
    assert kept.size <= 202
    for stretch, inside in zip(np.split(noise, 100), np.split(np.arange(50_000), 100), strict=True):
        mine = noise[np.intersect1d(kept, inside)]
        assert (mine.min(), mine.max()) == (stretch.min(), stretch.max())


def test_long_runs_are_thinned_to_their_own_samples() -> None:
    """Reference: the samples."""
    time = np.linspace(0.0, 10.0, 3 * MOST)
    chart = Chart(time, "mm", [Curve("a", np.sin(50.0 * time), "#000000")])
    assert chart.thinned
    (curve,) = chart.figure.data
    assert curve.x.size <= MOST + 2
    assert np.isin(curve.x, time).all()
    np.testing.assert_allclose(curve.y, np.sin(50.0 * curve.x), atol=1e-7)


def test_page_contains_the_whole_library() -> None:
    """Reference: the content of the wheel."""
    library = pytest.importorskip("plotly.offline").get_plotlyjs()
    assert gzip.decompress(base64.b64decode(pack_plotly())).decode() == library


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("paper", {"beam-fe", "beam-fe-bonded", "shell"}),
        ("lift", {"timoshenko", "shell", "bonded"}),
        ("three-segments", {"timoshenko", "shell", "beam-fe-bonded"}),
    ],
)
def test_shell_beam_and_bonded_are_read_first(name: str, first: set[str]) -> None:
    """Reference: the case files."""
    case = shipped(name)
    assert main_models(case, [model.name for model in case.models]) == first


def test_colours_are_distinct() -> None:
    """Reference: external, WCAG 2.1. A graphical object needs a contrast of 3 to the paper."""
    for colour in (*theme.PALETTE, theme.PLAY_FREE, theme.LOSS):
        linear = [
            c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in to_rgb(colour)
        ]
        luminance = float(np.dot(linear, [0.2126, 0.7152, 0.0722]))
        assert 1.05 / (luminance + 0.05) > 3.0, colour
    # More models than colours still differ.
    names = [f"model {i}" for i in range(3 * len(theme.PALETTE))]
    drawn = theme.strokes([*names, "bonded"], ["bonded"])
    assert len(set(drawn.values())) == len(names) + 1

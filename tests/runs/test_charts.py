# SPDX-License-Identifier: LGPL-3.0-or-later
"""Curves that a page carries: the samples of the files, and few enough of them."""

from __future__ import annotations

import base64
import gzip
import json

import numpy as np
import pytest

from runs import CASES
from runs.case.reading import load
from runs.pipeline.model_quality import leading
from runs.report.charts import MOST, Chart, Curve, extremes, packed_charts, packed_plotly


def unpacked(text: str, form: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(text), form)


def test_numbers_come_as_they_are() -> None:
    """Reference: the values themselves, to the 24 bits of a 32-bit float; a name cannot end the
    script."""
    time, values = np.linspace(0.0, 1.0, 7), np.array([0.0, 1.5, -2.25, 3.1, 1e-9, 7.0, 8.0])
    text = packed_charts({"tip": Chart(time, "mm", [Curve("</script>", values, "#000000")])})
    assert "<" not in text
    chart = json.loads(text)["tip"]
    (curve,) = chart["curves"]
    assert curve["name"] == "</script>"
    np.testing.assert_array_equal(unpacked(chart["time"], "<f8"), time)
    np.testing.assert_allclose(unpacked(curve["values"], "<f4"), values, rtol=2.0**-24)


def test_what_is_left_out_cannot_be_seen() -> None:
    """Reference (analytic): samples of a noise; every stretch keeps its lowest and its highest."""
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
    (curve,) = chart.data["curves"]
    kept = unpacked(curve["time"], "<f8")
    assert kept.size <= MOST + 2
    assert np.isin(kept, time).all()
    np.testing.assert_allclose(unpacked(curve["values"], "<f4"), np.sin(50.0 * kept), atol=1e-7)


def test_the_library_comes_whole() -> None:
    """Reference: what the wheel has."""
    library = pytest.importorskip("plotly.offline").get_plotlyjs()
    assert gzip.decompress(base64.b64decode(packed_plotly())).decode() == library


@pytest.mark.parametrize(
    ("name", "first"),
    [
        ("paper", {"beam-fe", "beam-fe-tied", "shell"}),
        ("lift", {"timoshenko", "shell", "tied"}),
        ("three-segments", {"timoshenko", "shell", "beam-fe-tied"}),
    ],
)
def test_shell_beam_and_tied_are_read_first(name: str, first: set[str]) -> None:
    """Reference: the case files."""
    case = load(str(CASES / f"{name}.toml"))
    assert leading(case, [model.name for model in case.models]) == first

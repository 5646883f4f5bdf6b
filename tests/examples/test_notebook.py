# SPDX-License-Identifier: LGPL-3.0-or-later
"""Comparison of the examples' notebook with its stored outputs."""

import json
from copy import deepcopy
from typing import Any

import matplotlib as mpl
import pytest

from tests.examples.notebook import code_cells, plain, run
from tests.examples.test_examples import EXAMPLES

FILE = EXAMPLES / "notebook.ipynb"


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
@pytest.mark.usefixtures("in_this_process")
def test_a_notebook_gives_its_outputs_again() -> None:
    """Reference: its own outputs, line by line, and analytic results for what it computes."""
    kept = json.loads(FILE.read_text("utf-8"))
    again = deepcopy(kept)
    with mpl.rc_context({"backend": "agg"}):
        names: dict[str, Any] = run(again)
    for before, now in zip(code_cells(kept), code_cells(again), strict=True):
        assert plain(now) == plain(before)
    # The fly turns by play over the distance of the pads' midpoints, 2 Δ / 1.38 m, about the lower
    # one, 4.56 m behind the tip.
    tips = names["swept"]["tip_at_rest"].sel(model="beam").values
    added = 0.004 * (4.56 / 1.38 + 0.5)
    assert tips[1:] - tips[:-1] == pytest.approx(added, rel=5e-3)
    # The masses of both segments, 7850 kg/m³ of the walls along their middle lines.
    masses = names["checked"].frames["Masses"]["own mass, kg"]
    arm, fly = (2.0 * (b * tf + h * tw) for h, b, tf, tw in (
        (0.300, 0.220, 0.006, 0.005), (0.256, 0.180, 0.005, 0.004)
    ))  # fmt: skip
    assert [*masses[:2]] == pytest.approx([7850.0 * 8.0 * arm, 7850.0 * 6.0 * fly], rel=1e-12)
    # Bisection ends with a bracket of a thousandth.
    assert names["largest"] == pytest.approx(0.004 + (0.18 - tips[1]) / (added / 0.004), rel=5e-3)

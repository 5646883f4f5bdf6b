# SPDX-License-Identifier: LGPL-3.0-or-later
"""The study of the shell element on coarse meshes."""

import json

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from studies.benchmarks import Sizes, study
from studies.reference_models.benchmarks import PUBLISHED
from studies.study import Study

pytestmark = pytest.mark.slow


COARSE = Sizes(
    roof=(4, 8, 16),
    cylinder=(12, 24, 48),
    hemisphere=(8, 16, 32),
    twisted=(1, 2, 4),
    plate=(4, 8),
)


@pytest.fixture(scope="module")
def found() -> Study:
    return study(lambda what: None, COARSE)


@pytest.mark.parametrize(
    ("what", "last", "order"),
    [
        ("Scordelis-Lo roof, 16 edges", 0.01, 1.1),
        ("pinched cylinder, 48 edges", 0.01, 2.0),
        # Bending without stretching, which locks a poor element.
        ("hemisphere, 32 edges", 0.02, 2.0),
    ],
)
def test_coarse_meshes_close_in(found: Study, what: str, last: float, order: float) -> None:
    """Reference: external or analytic, as named in each row."""
    (errors,) = (plot.curves[what][1] for plot in found.plots if what in plot.curves)
    assert errors[-1] < last
    assert np.log2(errors[-2] / errors[-1]) > order


def test_a_roof_is_too_stiff_and_softens(found: Study) -> None:
    """Reference: external, 0.3024."""
    row = next(row for row in found.data["benchmarks"] if "roof" in str(row["quantity"]))
    coarse, medium, fine = (float(row[f"edges × {size}"]) for size in (4, 2, 1))
    assert coarse < medium < fine < PUBLISHED.scordelis_lo_roof


def test_shear_deepens_a_dent(found: Study) -> None:
    """Reference: external, 1.8248e-5, of a shell without shear strain; shear adds 3 %."""
    sheared = next(row for row in found.data["benchmarks"] if "with shear" in str(row["quantity"]))
    assert 1.02 < float(sheared["edges × 1"]) / PUBLISHED.pinched_cylinder < 1.03


def test_data_are_json_without_nan(found: Study) -> None:
    json.dumps(found.data, allow_nan=False)
    assert len(found.data["benchmarks"]) == 10

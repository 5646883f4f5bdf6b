# SPDX-License-Identifier: LGPL-3.0-or-later
"""Statements find models by what they are, and say which model or number is missing."""

import numpy as np
import pytest

from runs.case import reading as case_file
from runs.case.schema import Case
from tests.runs.paper_curves import curves, paper, verdicts


@pytest.fixture
def case() -> Case:
    return paper()


def test_finds_models_by_what_they_are(case: Case) -> None:
    """Reference: the same curves under the names of the paper's case."""
    expected = verdicts(case, curves())
    models = tuple(m.model_copy(update={"name": f"model {i}"}) for i, m in enumerate(case.models))
    names = dict(zip([m.name for m in case.models], [m.name for m in models], strict=True))
    renamed = {names[name]: both for name, both in curves().items()}
    found = verdicts(case.model_copy(update={"models": models}), renamed)
    assert [v.verdict for v in found.values()] == [v.verdict for v in expected.values()]
    assert [v.measured for v in found.values()] == [v.measured for v in expected.values()]


def test_compares_series_of_one_base(case: Case) -> None:
    four, five, *others = case.models
    pinned = five.model_copy(update={"base": "pinned"})
    found = verdicts(case.model_copy(update={"models": (four, pinned, *others)}), curves())
    assert found["S2"].verdict == "undecided"
    assert found["S2"].why == "The case has no model like 'kantorovich-5'."


@pytest.mark.parametrize(
    ("model", "statements"),
    [
        ("kantorovich-4", ["S1", "S2", "S4", "S10"]),
        ("shell", ["S4"]),
        ("beam-fe", ["S4"]),
        ("beam-fe-tied", ["S5"]),
    ],
)
def test_says_which_model_is_missing(case: Case, model: str, statements: list[str]) -> None:
    others = [m.name for m in case.models if m.name != model]
    motion = {name: both for name, both in curves().items() if name != model}
    found = verdicts(case_file.select(case, "", others), motion)
    for statement in statements:
        assert found[statement].verdict == "undecided"
        assert found[statement].measured is None
        assert found[statement].why == f"The case has no model like {model!r}."


def test_says_which_motion_is_not_finite(case: Case) -> None:
    motion = curves()
    motion["kantorovich-5"]["tip"][7000] = np.nan
    found = verdicts(case, motion, {"kantorovich-5": {"first_peak": {"tip": [None, None]}}})
    for statement in ("S1", "S2", "S3"):
        assert found[statement].verdict == "undecided"
        assert found[statement].why == "The tip of 'kantorovich-5' is not finite."
    for statement in ("S4", "S5", "S6"):
        assert found[statement].verdict == "undecided"
        assert found[statement].why == "'kantorovich-5' has no first peak."

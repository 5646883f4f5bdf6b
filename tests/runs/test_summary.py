# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reading and writing of summaries, and messages on invalid ones."""

import json
from pathlib import Path
from typing import Any

import pytest
from pydantic import ValidationError

from runs.folder.cache import Cache
from runs.pipeline.summary import Summary
from tests.runs.summaries import model_summary, summary_of

# Of runs before summaries had types, all their keys among them.
EARLIER = Path(__file__).parent / "data" / "summary.json"


def content() -> dict[str, Any]:
    found: dict[str, Any] = json.loads(EARLIER.read_text(encoding="utf-8"))
    return found


def test_keys_and_values_are_unchanged() -> None:
    """Reference: the stored file, to the last digit and in its order."""
    text = json.dumps(content(), indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    assert str(Summary.load(EARLIER)) == text


def test_a_summary_comes_back_from_a_cache(tmp_path: Path) -> None:
    summary = Summary.load(EARLIER)
    Cache(tmp_path).store("a", summary)
    assert str(Cache(tmp_path).load("a", Summary)) == str(summary)


def test_values_that_are_not_finite_are_null() -> None:
    nan, infinite = float("nan"), float("inf")
    model = model_summary(first_contact=nan, first_peak={"tip": (nan, nan)})
    model.mesh_error = infinite
    found = json.loads(str(summary_of({"boom": model})))["models"]["boom"]
    assert (found["first_contact"], found["first_peak"]["tip"]) == (None, [None, None])
    assert found["mesh_error"] is None
    assert "step_error" not in found


@pytest.mark.parametrize(
    ("model", "key", "wrong"),
    [
        ("shell", "steps", None), ("shell", "kind", 3), ("kantorovich-4", "ensemble", {}),
        ("beam-fe-bonded", "first_peak", {"tip": [1.0]}), ("shell", "stress", {"von_mises": 1.0}),
        ("shell", "colour", "red"),
    ],
)  # fmt: skip
def test_another_version_s_is_refused(tmp_path: Path, model: str, key: str, wrong: Any) -> None:
    other = content()
    other["models"][model][key] = wrong
    (tmp_path / "summary.json").write_text(json.dumps(other), encoding="utf-8")
    with pytest.raises(ValidationError) as refused:
        Summary.load(tmp_path / "summary.json")
    assert refused.value.errors()[0]["loc"][:3] == ("models", model, key)

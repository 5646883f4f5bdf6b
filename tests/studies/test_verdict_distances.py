# SPDX-License-Identifier: LGPL-3.0-or-later
"""The table of distances of verdicts from their thresholds."""

import pytest

from protractile.runs.paper.verdicts import Verdict
from studies import verdicts


def test_distances_of_all_samples(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: by hand. The second sample is 0.1 higher, and nearer to its threshold."""

    def judged(case: str, change: float) -> list[Verdict]:
        late = change > 0.0
        distance = 4.0 - late
        return [
            Verdict("S2", case, 0.4 + 0.1 * late, 0.2, "", "reproduced", "", distance),
            Verdict("S8", case, 10.0, 7.0, "s", "contradicted", ""),
        ]

    monkeypatch.setattr(verdicts, "verdicts_on", judged)
    monkeypatch.setattr(verdicts, "CHANGES", (0.0, 1.0e-12))
    (table,) = verdicts.study(lambda what: None).tables
    assert [row[0] for row in table.rows] == [case for case in verdicts.JUDGED for _ in range(2)]
    assert table.rows[0][2:] == ("reproduced", "0.4", "0.2", "", "4.0", "3.0", "0.071")
    assert table.rows[1][2:] == ("contradicted", "10", "7", "s", "–", "–", "0")


def test_a_change_of_the_modulus_reaches_the_run(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: analytic."""
    cases = []
    monkeypatch.setattr(verdicts, "run_case", cases.append)
    monkeypatch.setattr(verdicts, "judge", lambda results: [])
    assert verdicts.verdicts_on("paper", 1.0e-12) == []
    assert cases[0].material.youngs_modulus == pytest.approx(2.1e11 * (1.0 + 1e-12), rel=1e-15)

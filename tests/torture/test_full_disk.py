# SPDX-License-Identifier: LGPL-3.0-or-later
"""A sample of the campaign."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.torture import full_disk

pytestmark = pytest.mark.slow


def test_no_write_that_is_refused_costs_what_was_there(tmp_path: Path) -> None:
    found = list(full_disk.rows(tmp_path, 2))
    assert len(found) == 6
    for name, tries, breaches, what in found:
        assert tries >= 2
        assert breaches == 0, f"{name}: {what}"

# SPDX-License-Identifier: LGPL-3.0-or-later
"""A sample of the campaign."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.torture.shared_cache import one_folder

pytestmark = pytest.mark.slow


def test_two_runs_in_one_folder_leave_what_one_does(tmp_path: Path) -> None:
    name, tries, breaches, what = one_folder(tmp_path, 1, ("--models", "beam-fe-tied"))
    assert (tries, breaches) == (1, 0), f"{name}: {what}"

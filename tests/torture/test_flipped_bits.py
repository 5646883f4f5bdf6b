# SPDX-License-Identifier: LGPL-3.0-or-later
"""A sample of the campaign."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from tests.torture import flipped_bits

pytestmark = pytest.mark.slow


def test_no_flipped_bit_is_believed(tmp_path: Path) -> None:
    for name, tries, breaches, what in flipped_bits.rows(tmp_path, 3):
        assert (tries, breaches) == (3, 0), f"{name}: {what}"

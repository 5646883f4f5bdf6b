# SPDX-License-Identifier: LGPL-3.0-or-later
"""The coarse case as its file has it, for tests that change a line of it."""

from __future__ import annotations

from runs import CASES

COARSE = (CASES / "coarse.toml").read_text(encoding="utf-8")
CONTACT = next(line for line in COARSE.splitlines() if line.startswith("contact = "))
# From the law of its joint on, for slips in several lines of it.
FROM_EXPONENT = COARSE[COARSE.index("exponent = 2.0") :]

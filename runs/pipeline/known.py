# SPDX-License-Identifier: LGPL-3.0-or-later
"""Numbers that may not exist, on their way into a JSON file."""

from __future__ import annotations

import math


def known(number: float) -> float | None:
    """The number, and None for NaN and infinity, which JSON does not have."""
    return float(number) if math.isfinite(number) else None

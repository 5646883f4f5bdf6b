# SPDX-License-Identifier: LGPL-3.0-or-later
"""How numbers are set where people read them."""

from __future__ import annotations


def signed(text: str) -> str:
    """A number with a minus sign in place of a hyphen."""
    return text.replace("-", "−")

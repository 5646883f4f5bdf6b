# SPDX-License-Identifier: LGPL-3.0-or-later
"""How texts that others gave are shown to a user: printable, and no longer than one can read."""

from __future__ import annotations

# Characters of a message, its newline included, and of a path or a key in it.
LONGEST, LONGEST_PART = 300, 120

_GAP = " ... "


def message(text: str) -> str:
    """One line for stderr."""
    return shown(f"protractile: {' '.join(text.split())}", LONGEST - 1)


def shown(text: str, longest: int = LONGEST_PART) -> str:
    """A text, its middle left out where it is long."""
    # Escaping makes it longer, never shorter: ends of this length are enough.
    safe = printable(text if len(text) <= 2 * longest else text[:longest] + text[-longest:])
    if len(safe) <= longest:
        return safe
    half = (longest - len(_GAP)) // 2
    return safe[:half] + _GAP + safe[-half:]


def printable(text: str) -> str:
    """A text with what no terminal should be sent escaped."""
    return "".join(
        letter if letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text
    )

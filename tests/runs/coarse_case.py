# SPDX-License-Identifier: LGPL-3.0-or-later
"""Text of the coarse case, for tests that change a line of it."""

from collections.abc import Mapping

from runs import CASES

COARSE = (CASES / "coarse.toml").read_text(encoding="utf-8")
CONTACT = next(line for line in COARSE.splitlines() if line.startswith("contact = "))
# From the law of its joint on, for slips in several lines of it.
FROM_EXPONENT = COARSE[COARSE.index("exponent = 2.0") :]

# Input error: text of the case, its replacement, and the expected message.
Slip = tuple[str, str, str]


def replacing(text: str, slips: Mapping[str, str]) -> list[Slip]:
    """Return input errors: a text of the case, its replacement, and the expected message."""
    return [(text, slip, line) for slip, line in slips.items()]


def adding(text: str, slips: Mapping[str, str]) -> list[Slip]:
    """Return input errors by lines added below a text of the case."""
    return replacing(text, {f"{text}\n{slip}": line for slip, line in slips.items()})

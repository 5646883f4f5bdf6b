# SPDX-License-Identifier: LGPL-3.0-or-later
"""Formats of numbers and lists in texts, and factors of units."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from protractile.geometry.units import Unit

# Factors from m, N and Pa to mm, kN and MPa, and from a fraction to per cent.
TO_MILLI, TO_KILO, TO_MEGA, TO_PERCENT = map(Unit.conversion, ("mm", "kN", "MPa", "%"))


def with_minus_signs(text: str) -> str:
    """Return the text of a number with a minus sign in place of a hyphen."""
    return text.replace("-", "−")


def digits(value: float, count: int = 3) -> str:
    """Return a number with ``count`` significant digits, without exponent: 1020, not 1.02e+03.

    >>> digits(1023.4), digits(22.68), digits(0.0)
    ('1020', '22.7', '0')
    """
    return with_minus_signs(f"{float(f'{value:.{count}g}'):.12g}")


def join_words(parts: Iterable[str]) -> str:
    """Return the items of a non-empty list as a phrase.

    >>> join_words(["play", "load", "friction"])
    'play, load and friction'
    """
    *most, last = parts
    return f"{', '.join(most)} and {last}" if most else last


# Maximum number of valid names in a message.
MOST_CHOICES = 12


def choices(names: Sequence[str]) -> str:
    """Return names as "'a', 'b' or 'c'"; of many names only the first ones."""
    if len(names) > MOST_CHOICES:
        return f"{', '.join(repr(name) for name in names[:MOST_CHOICES])} or another of its kind"
    quoted = [repr(name) for name in names]
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} or {quoted[-1]}"

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Formats of numbers and lists in texts, and factors of units."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from statistics import median

from protractile.geometry.units import Unit

# Factors from m, N and Pa to mm, kN and MPa, and from a fraction to per cent.
TO_MILLI, TO_KILO, TO_MEGA, TO_PERCENT = map(Unit.conversion, ("mm", "kN", "MPa", "%"))
# Displayed units by SI units.
SHOWN = {"m": "mm", "N": "kN", "N m": "kN m", "N/m": "kN/mm", "Pa": "MPa", "Hz": "Hz", "1": ""}
# Fraction of the largest magnitude of a column that counts as zero.
ROUND_OFF = 1.0e-6
# Decimals of displayed amounts, beyond which digits are round-off.
DECIMALS = 9
# Text in place of a missing number.
NONE = "–"
_SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def with_minus_signs(text: str) -> str:
    """Return the text of a number with a minus sign in place of a hyphen."""
    return text.replace("-", "−")


def scientific(number: float, digits: int = 1) -> str:
    """Return a number as text in scientific notation, such as 8 × 10⁻⁵."""
    mantissa, exponent = f"{number:.{digits - 1}e}".split("e")
    power = str(int(exponent)).translate(_SUPERSCRIPT)
    return f"{with_minus_signs(f'{float(mantissa):g}')} × 10{power}"


def number(value: float | None, digits: int = 3) -> str:
    """Return a number with a given number of significant digits; ``NONE`` for None."""
    if value is None or not math.isfinite(value):
        return NONE
    if value == 0.0 or 1.0e-3 <= abs(value) < 1.0e5:
        rounded = float(f"{value:.{digits}g}")
        whole = abs(rounded) >= 10.0 ** (digits - 1)
        return with_minus_signs(f"{rounded:.0f}" if whole else f"{rounded:g}")
    return scientific(value, digits)


def in_shown_unit(value: float, unit: str) -> float:
    """Return an amount in SI units in its display unit."""
    return Unit.conversion(SHOWN[unit] or "1") * value


def amount(value: float, unit: str) -> str:
    """Return an amount in SI units as text in its display unit.

    >>> amount(1023.4, "N"), amount(-0.02268, "m"), amount(0.0, "Pa")
    ('1.02 kN', '−22.7 mm', '0 MPa')
    """
    return f"{number(round(in_shown_unit(value, unit), DECIMALS))} {SHOWN[unit]}".strip()


def without_round_off(values: Sequence[float], least: float | None = None) -> list[float]:
    """Return values, with 0 for those up to ``least`` in magnitude.

    Unless given, ``least`` is 1e-6 of the largest magnitude.
    """
    least = ROUND_OFF * max(map(abs, values), default=0.0) if least is None else least
    return [value if abs(value) > least else 0.0 for value in values]


def milli(value: float, digits: int = 4) -> str:
    """Return a length in mm, or a rotation in mrad, as text."""
    return number(round(TO_MILLI * value, DECIMALS), digits)


def percent(part: float, digits: int = 3) -> str:
    """Return a fraction in percent, with a given number of significant digits."""
    return f"{number(TO_PERCENT * part, digits)} %"


def signed_percent(part: float, digits: int = 2) -> str:
    """Return a fraction in percent, with its sign."""
    return f"{'+' if part > 0.0 else ''}{percent(part, digits)}"


def fixed(value: float | None, decimals: int, factor: float = 1.0) -> str:
    """Return a number times a factor, with a given number of decimals; ``NONE`` for None."""
    if value is None or not math.isfinite(value):
        return NONE
    # Adding 0 removes the sign of a number that is rounded to zero.
    return with_minus_signs(f"{round(factor * value, decimals) + 0.0:.{decimals}f}")


def repeated(values: Sequence[float]) -> str:
    """Return the median of repeated measurements as text, to the leading digit of the spread.

    The spread is half the range. If it exceeds the median, the text starts with ``~``. A single
    value is rounded to one digit.
    """
    middle = median(values)
    if middle == 0.0 or not math.isfinite(middle):
        return f"{middle:g}"
    spread = 0.5 * (max(values) - min(values))
    leading = math.floor(math.log10(abs(middle)))
    last = math.floor(math.log10(spread)) if spread > 0.0 else leading
    digits = max(1, min(leading - last + 1, 3)) if len(values) > 1 else 1
    place = leading - digits + 1
    text = f"{round(middle, -place):.{max(0, -place)}f}"
    return f"~{text}" if len(values) > 1 and last >= leading and spread > 0.0 else text


def count(whole: float) -> str:
    """Return an integer as text like ``11 194 798``, with no-break spaces."""
    return f"{whole:,.0f}".replace(",", "\N{NO-BREAK SPACE}")


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

# SPDX-License-Identifier: LGPL-3.0-or-later
"""From a boom to the gap system of a beam model in one call."""

from __future__ import annotations

from typing import Any

from dynamics.gap_system import GapSystem
from geometry.boom import Boom
from runs.case.kinds.finite_element import BeamElements
from runs.case.kinds.kantorovich import Kantorovich


def finite_element_system(boom: Boom, **keys: Any) -> GapSystem:
    """By beam finite elements; keys as of their table in a case file."""
    return BeamElements(boom, **keys).system()


def kantorovich_system(boom: Boom, terms: tuple[int, ...], base: str) -> GapSystem:
    """By Kantorovich series with rotary inertia."""
    return Kantorovich(boom, terms=terms, base=base, rotary_inertia=True).system()

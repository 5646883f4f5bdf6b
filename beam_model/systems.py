# SPDX-License-Identifier: LGPL-3.0-or-later
"""From a boom to its gap system in one call, for booms that no case file declares."""

from __future__ import annotations

from collections.abc import Sequence

from beam_model.elements import Theory
from beam_model.finite_element import finite_element_segments
from beam_model.kantorovich import Base, kantorovich_segments
from beam_model.segment_model import gap_system
from dynamics.gap_system import GapSystem
from geometry.boom import Boom


def finite_element_system(
    boom: Boom,
    element_length: float = 0.5,
    theory: Theory = "euler-bernoulli",
    rotary_inertia: bool = True,
) -> GapSystem:
    """A boom by beam finite elements.

    Args:
        boom: flat or in space.
        element_length: largest length of an element in m.
        theory: ``timoshenko`` needs the segments' sections.
        rotary_inertia: keep I_p of (3).

    Raises:
        BoomError: the boom lacks what the theory needs.
    """
    models = finite_element_segments(boom, element_length, theory, rotary_inertia)
    return gap_system(boom, models)


def kantorovich_system(
    boom: Boom,
    terms: Sequence[int],
    base: Base = "complete",
    rotary_inertia: bool = True,
) -> GapSystem:
    """A boom by Kantorovich series.

    Args:
        boom: flat or in space.
        terms: number of functions of each segment.
        base: which reading of (29) and (31).
        rotary_inertia: keep I_p of (3) and (9), or drop it as (21) does.

    Raises:
        BoomError: the boom has what the base cannot take.
    """
    models = kantorovich_segments(boom, terms, base, rotary_inertia)
    return gap_system(boom, models)

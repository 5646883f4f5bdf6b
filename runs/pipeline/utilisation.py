# SPDX-License-Identifier: LGPL-3.0-or-later
"""Utilisation of sections, walls, slide pads and fatigue details in the motion of a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from runs.pipeline.results import Results

# Strength of each kind of part.
LIMITS: Mapping[str, str] = {
    "plate": "yield",
    "outer fibre": "yield",
    "pad": "the allowable pressure",
    "detail": "the fatigue life",
}


class Utilisation(NamedTuple):
    """Largest load of a kind of part, compared with its strength."""

    part: str  #: kind of the part, a key of :data:`LIMITS`; plates are walls of shells near pads
    segment: str  #: name of the segment
    x: float  #: position in m
    load: float  #: stress or pressure in Pa, or fatigue damage
    value: float | None  #: utilisation; None if the case gives no strength

    def __str__(self) -> str:
        """Return value, location and comparison with 100 % as text; the value is not None."""
        assert self.value is not None
        relation = "exceeds" if self.value > 1.0 else "below"
        return (
            f"{100.0 * self.value:.3g} % at {self.part}, {self.segment} segment, "
            f"x = {self.x:.4g} m: {relation} {LIMITS[self.part]}"
        )


def utilisations(results: Results, model: str) -> dict[str, Utilisation]:
    """Return the governing part of each kind, by utilisation, or by load without a strength."""
    governing: dict[str, Utilisation] = {}
    for one in _loads(results, model):
        other = governing.setdefault(one.part, one)
        if (one.value or 0.0, one.load) > (other.value or 0.0, other.load):
            governing[one.part] = one
    return governing


def _loads(results: Results, model: str) -> Iterator[Utilisation]:
    results_of_model = results.summary.design.models.get(model)
    if results_of_model is None:
        return
    if results_of_model.motion is not None:
        for wall in results_of_model.motion.walls:
            yield Utilisation("plate", wall.segment, wall.x, wall.patch, wall.utilisation)
        for fibre in results_of_model.motion.fibres:
            stress = abs(fibre.stress)
            yield Utilisation("outer fibre", fibre.segment, fibre.x, stress, fibre.utilisation)
    for pad in results.summary.pads:
        if pad.model == model:
            yield Utilisation("pad", pad.inner, pad.x, pad.pressure, pad.utilisation)
    for life in results_of_model.life:
        if (damage := life.life_damage) is not None:
            yield Utilisation("detail", life.segment, life.x, damage, damage)

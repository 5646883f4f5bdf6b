# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is recorded of a boom's motion, and where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

from geometry.section import SegmentRef

# What a case may ask for.
Recorded = Literal["deflection", "rotation", "velocity", "acceleration", "lateral", "twist"]

Quantity = Literal[Recorded, "distortion"]


# What a row can read of a cross-section.
Read = Literal["deflection", "rotation", "distortion", "lateral", "twist"]

# Those that move in space alone.
IN_SPACE: tuple[Read, ...] = ("lateral", "twist")


class Kind(NamedTuple):
    """A quantity's unit, what is read, how often that is derived by time, and the words for it."""

    unit: str
    read: Read
    derivative: Literal[0, 1, 2]
    title: str


KINDS: Mapping[Quantity, Kind] = {
    "deflection": Kind("m", "deflection", 0, "deflection along z"),
    "rotation": Kind("rad", "rotation", 0, "rotation of the cross-section, the slope along z"),
    "distortion": Kind("m", "distortion", 0, "how much taller the cross-section has become"),
    "lateral": Kind("m", "lateral", 0, "deflection along y"),
    "twist": Kind("rad", "twist", 0, "turn about x"),
    "velocity": Kind("m/s", "deflection", 1, "velocity along z"),
    "acceleration": Kind(
        "m/s2", "deflection", 2, "acceleration along z, mean of the output interval that ends then"
    ),
}


@dataclass(frozen=True, slots=True)
class Observation:
    """Something that every model records.

    >>> seat = pt.Observation("seat", segment=1, x=10.0, quantity="velocity")
    >>> system = pt.BeamElements(replace(boom, observations=(seat,))).system()
    >>> system.observers["seat"].unit
    'm/s'

    Args:
        name: of the output.
        segment: its name; in a boom its position.
        x: m.
        quantity: of its cross-section there; the lateral deflection and the twist in space alone.
    """

    name: str
    segment: SegmentRef
    x: float
    quantity: Quantity = "deflection"

    @property
    def kind(self) -> Kind:
        """Of its quantity."""
        return KINDS[self.quantity]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Observations: additional outputs of a boom's motion."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

from pydantic.dataclasses import dataclass

from geometry.fields import PART, Name, Place, SegmentRef

# Quantities that a case may observe.
Recorded = Literal["deflection", "rotation", "velocity", "acceleration", "lateral", "twist"]

Quantity = Literal[Recorded, "distortion"]


# Quantities that a row can read of a cross-section.
Read = Literal["deflection", "rotation", "distortion", "lateral", "twist"]

# Quantities that only booms in space have.
IN_SPACE: tuple[Read, ...] = ("lateral", "twist")


class Kind(NamedTuple):
    """Kind of a quantity: unit, quantity that is read, number of time derivatives, description."""

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


@dataclass(frozen=True, slots=True, config=PART)
class Observation:
    """Output that every model records.

    >>> seat = pt.Observation("seat", segment=1, x=10.0, quantity="velocity")
    >>> system = pt.BeamElements(replace(boom, observations=(seat,))).system()
    >>> system.observers["seat"].unit
    'm/s'
    """

    name: Name
    """the name of the output in the results"""
    segment: SegmentRef
    """the name of the segment"""
    x: Place
    """the x in m"""
    quantity: Quantity = "deflection"
    """the quantity: deflection along z, its velocity, its acceleration as the mean over each output
    interval, rotation of the cross-section; in space also lateral deflection and twist"""

    @property
    def kind(self) -> Kind:
        """The kind of the quantity."""
        return KINDS[self.quantity]

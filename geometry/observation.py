# SPDX-License-Identifier: LGPL-3.0-or-later
"""Observations: outputs of a motion that a case requests."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, NamedTuple

from protractile.geometry.fields import Name, part
from protractile.geometry.place import Place, SegmentRef

# Quantities that a case may request.
Recorded = Literal["deflection", "rotation", "velocity", "acceleration", "lateral", "twist"]

Quantity = Literal[Recorded, "distortion"]


# Displacements of a cross-section, which are linear in the coordinates of a model.
Displacement = Literal["deflection", "rotation", "distortion", "lateral", "twist"]

# Displacements that only three-dimensional booms have.
SPATIAL_QUANTITIES: tuple[Displacement, ...] = ("lateral", "twist")


class QuantityKind(NamedTuple):
    """Unit, displacement, order of the time derivative, and title of an output quantity."""

    unit: str
    displacement: Displacement
    derivative: Literal[0, 1, 2]
    title: str


KINDS: Mapping[Quantity, QuantityKind] = {
    "deflection": QuantityKind("m", "deflection", 0, "deflection along z"),
    "rotation": QuantityKind(
        "rad", "rotation", 0, "rotation of the cross-section, the slope along z"
    ),
    "distortion": QuantityKind("m", "distortion", 0, "increase of the height of the cross-section"),
    "lateral": QuantityKind("m", "lateral", 0, "deflection along y"),
    "twist": QuantityKind("rad", "twist", 0, "rotation about x"),
    "velocity": QuantityKind("m/s", "deflection", 1, "velocity along z"),
    "acceleration": QuantityKind(
        "m/s2", "deflection", 2, "acceleration along z, mean of the output interval that ends then"
    ),
}


@part
class Observation:
    """Output that a case requests from all models.

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
    def kind(self) -> QuantityKind:
        """The unit, displacement and derivative of the quantity."""
        return KINDS[self.quantity]

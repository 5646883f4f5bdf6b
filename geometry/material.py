# SPDX-License-Identifier: LGPL-3.0-or-later
"""Materials of segments."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from protractile.geometry.fields import In, Positive, part, rising


@part
class Material:
    """Isotropic linear-elastic material.

    >>> steel = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
    >>> print(f"{1e-9 * steel.shear_modulus:.1f} GPa")
    80.8 GPa
    """

    youngs_modulus: Annotated[Positive, In("Pa")]
    """Young's modulus E in Pa"""
    poissons_ratio: Annotated[float, Field(strict=True, gt=-1.0, lt=0.5), In("1")]
    """Poisson's ratio"""
    density: Annotated[Positive, In("kg/m^3")]
    """the density in kg/m^3"""
    yield_strength: Annotated[Positive, In("Pa")] | None = None
    """the yield strength in Pa, for utilisations"""
    yield_by_thickness: Annotated[
        tuple[tuple[Positive, Positive], ...],
        In("m", "Pa"),
        Field(max_length=20),
        rising("thicknesses", falling="strengths"),
    ] = ()
    """pairs of a plate thickness in m and the yield strength in Pa up to it, ascending, instead of
    yield_strength; thicker plates have the last one"""

    @model_validator(mode="after")
    def _check_strengths(self) -> Material:
        if self.yield_by_thickness and self.yield_strength is not None:
            what = {"what": "has yield_strength and yield_by_thickness; give one of them"}
            raise PydanticCustomError("unsuitable", "{what}", what)
        return self

    def strength(self, thickness: float) -> float | None:
        """Return the yield strength in Pa of a plate with ``thickness`` in m; None if unknown."""
        for limit, strength in self.yield_by_thickness:
            if thickness <= limit:
                return strength
        return self.yield_by_thickness[-1][1] if self.yield_by_thickness else self.yield_strength

    @property
    def shear_modulus(self) -> float:
        """The shear modulus G = E / 2(1 + ν) in Pa."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments: beam properties, supports and masses.

x runs along the boom, z is in the plane of bending, y is lateral. All units are SI units.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, Any

import numpy as np

from protractile.geometry.arrays import Array
from protractile.geometry.compression import NO_COMPRESSION, Compression
from protractile.geometry.fields import (
    BoomError,
    Having,
    In,
    NotNegative,
    Number,
    Positive,
    check_kind,
    format_value,
    part,
)
from protractile.geometry.material import Material
from protractile.geometry.place import Place, resolve_distances, resolve_level
from protractile.geometry.section import Direction, Plate, Section
from protractile.geometry.stiffeners import Collar, Diaphragm
from protractile.geometry.support import Support
from protractile.geometry.taper import (
    areas,
    interpolate_section,
    mean_area,
    middle_section,
)
from protractile.geometry.walls import outer_surfaces

# Fraction of a segment's length below which two x are equal: far below any part, above round-off.
SAME_PLACE = 1.0e-10


@part
class PointMass:
    """Point mass on a segment's axis, without rotary inertia.

    >>> arm = replace(boom.segments[0], masses=(pt.PointMass(x=8.0, mass=200.0),))
    >>> heavier = replace(boom, segments=(arm, boom.segments[1]))
    >>> masses = [pt.BeamElements(b).system().row_masses[0] for b in (boom, heavier)]
    >>> bool(masses[1] > masses[0])
    True
    """

    x: Place
    """the x in m"""
    mass: Annotated[Positive, In("kg")]
    """the mass in kg"""


@dataclass(frozen=True, slots=True)
class Lateral:
    """Additional properties of a beam in space.

    >>> print(f"{boom.segments[0].lateral.torsion_constant:.1e} m⁴")
    2.8e-04 m⁴
    """

    second_moment_of_area: float  #: second moment for bending in the plane x-y in m⁴
    rotary_inertia: float  #: rotary inertia for bending in the plane x-y in kg·m
    torsion_constant: float  #: J_t of the torsional stiffness G J_t in m⁴
    polar_inertia: float  #: mass moment of inertia per length about x in kg·m
    load: float = 0.0  #: uniform load along y in N/m, constant from t = 0 on


@part
class Segment:
    """Segment of the boom, with beam properties and, if given, its section.

    >>> fly = boom.segments[1]
    >>> fly.length, fly.rigid_modes
    (8.0, 2)

    Args:
        name: name in messages and results.
        start, end: x of its ends in m.
        material: elastic constants and density.
        mass_per_length: m̄ in kg/m, positive.
        second_moment_of_area: J in m⁴.
        rotary_inertia: I_p in kg·m.
        section: section; only shear-flexible beams, shells and booms in space need it.
        head_section: section at the end of a tapered segment. Then ``section`` is the section at
            the start, all centroids are on the axis, m̄ is the mean, and the other values above and
            in ``lateral`` apply at the middle.
        load: uniform load along z in N/m, constant from t = 0 on.
        supports: supports on the ground.
        viscous_damping: μ̄ of (25) in N·s/m², for deflections along z and y.
        masses: point masses.
        lateral: additional properties for a boom in space.
        collars, diaphragms: stiffeners of the plates, whose mass beams include; the properties
            above exclude them.
        compression: axial force, see :func:`.geometry.axial.with_compression`.
        shear_stiffnesses: G A_s in N along z and along y, if they differ from the values of the
            section.
        yield_strengths: pairs of a plate, or of a side for all of its plates, and its yield
            strength in Pa; other plates have that of the material.
        added_mass_per_length: the part of m̄ in kg/m that is uniform and not that of the plates,
            such as hoses; a shell has it on its plates.
    """

    name: str
    start: Number
    end: Number
    material: Material
    mass_per_length: Positive
    second_moment_of_area: Positive
    rotary_inertia: NotNegative
    section: Annotated[Section | None, Having("section", "plates")] = None
    head_section: Annotated[Section | None, Having("section", "plates")] = None
    load: Number = 0.0
    supports: tuple[Support, ...] = ()
    viscous_damping: NotNegative = 0.0
    masses: tuple[PointMass, ...] = ()
    lateral: Lateral | None = None
    collars: tuple[Collar, ...] = ()
    diaphragms: tuple[Diaphragm, ...] = ()
    compression: Compression = NO_COMPRESSION
    shear_stiffnesses: tuple[Positive, Positive] | None = None
    yield_strengths: tuple[tuple[str, Positive], ...] = ()
    added_mass_per_length: NotNegative = 0.0

    def __post_init__(self) -> None:
        for group in ("supports", "masses", "collars", "diaphragms"):
            on_segment = tuple(
                resolve_distances(item, self.start, self.end) for item in getattr(self, group)
            )
            object.__setattr__(self, group, on_segment)
        supports = tuple(
            resolve_level(support, f"segment.{self.name}", partial(self.surfaces, support.x))
            for support in self.supports
        )
        object.__setattr__(self, "supports", supports)

    @classmethod
    def of_section(
        cls,
        name: str,
        start: float,
        end: float,
        material: Material,
        section: Section,
        **others: Any,
    ) -> Segment:
        """Return a segment with the beam properties of its section, including the lateral ones.

        >>> import protractile as pt
        >>> steel = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
        >>> box = pt.BoxSection(height=0.4, width=0.3, flange=0.01, web=0.01)
        >>> arm = pt.Segment.of_section("arm", 0.0, 10.0, steel, box, load=-100.0)
        >>> round(arm.mass_per_length, 6)
        109.9

        Args:
            name, start, end, material, section, others: as in :class:`Segment`.
        """
        check_kind("Segment.material", material, Material)
        if not hasattr(section, "plates"):
            what = f"must be a section such as a BoxSection, got {format_value(section)}"
            raise BoomError("Segment.section", what)
        head = others.get("head_section")
        numbers = middle_section(section, head)
        density, second_moment = material.density, numbers.second_moment_of_area
        sideways = numbers.lateral_second_moment_of_area
        lateral = Lateral(
            second_moment_of_area=sideways,
            rotary_inertia=density * sideways,
            torsion_constant=numbers.torsion_constant,
            polar_inertia=density * numbers.polar_second_moment_of_area,
        )
        return cls(
            name,
            start,
            end,
            material,
            mass_per_length=density * mean_area(section, head)
            + others.get("added_mass_per_length", 0.0),
            second_moment_of_area=second_moment,
            rotary_inertia=density * second_moment,
            section=section,
            **{"lateral": lateral, **others},
        )

    @property
    def length(self) -> float:
        """The length in m."""
        return self.end - self.start

    @property
    def area(self) -> float:
        """The mean area of the sections in m²."""
        assert self.section is not None
        return mean_area(self.section, self.head_section)

    def strength(self, plate: Plate) -> float | None:
        """Return the yield strength of a plate in Pa; None if unknown."""
        own = dict(self.yield_strengths)
        of_side = own.get(plate.name.partition("-")[0], self.material.strength(plate.thickness))
        return own.get(plate.name, of_side)

    @property
    def yield_strength(self) -> float | None:
        """The minimum yield strength of the plates in Pa; None if unknown."""
        if self.section is None:
            return self.material.yield_strength
        plates = (plate for x in self.ends for plate in self.section_at(x).plates)
        strengths = map(self.strength, plates)
        return min((strength for strength in strengths if strength is not None), default=None)

    @property
    def mass_centre(self) -> float:
        """The x in m of the centre of the distributed mass."""
        middle = 0.5 * (self.start + self.end)
        if self.section is None or self.head_section is None:
            return middle
        _, half_way, head = areas(self.section, self.head_section)
        of_plates = self.start + self.length * (2.0 * half_way + head) / (6.0 * self.area)
        return of_plates + self.added_mass_per_length / self.mass_per_length * (middle - of_plates)

    def section_at(self, x: float) -> Section:
        """Return the section at x in m; the segment must have one."""
        assert self.section is not None
        if self.head_section is None:
            return self.section
        return interpolate_section(self.section, self.head_section, (x - self.start) / self.length)

    def surfaces(self, x: float) -> tuple[float, float] | None:
        """Return the z in m of the outer surfaces of bottom and top at x in m; None if unknown."""
        return None if self.section is None else outer_surfaces(self.section_at(x))

    @property
    def ends(self) -> tuple[float, float]:
        """The x of both ends in m."""
        return self.start, self.end

    @property
    def widest(self) -> Section:
        """The end section with the larger perimeter."""
        assert self.section is not None
        ends = self.section, self.head_section or self.section
        return max(ends, key=lambda section: section.perimeter)

    @property
    def all_masses(self) -> tuple[PointMass, ...]:
        """The point masses, including stiffeners."""
        return (*self.masses, *self.stiffener_masses)

    @property
    def stiffeners(self) -> list[tuple[tuple[float, float], float]]:
        """The x of both ends in m and the mass in kg of each diaphragm and collar."""
        if self.section is None:
            return []
        density = self.material.density
        return [
            ((plate.x, plate.x), density * self.section_at(plate.x).enclosed_area * plate.thickness)
            for plate in self.diaphragms
        ] + [
            (collar.span, density * self.mean_width(collar) * collar.length * collar.thickness)
            for collar in self.collars
        ]

    @property
    def stiffener_masses(self) -> tuple[PointMass, ...]:
        """The diaphragms and collars as point masses; empty without a section."""
        return tuple(PointMass(0.5 * sum(ends), mass) for ends, mass in self.stiffeners)

    @property
    def mass(self) -> float:
        """The mass in kg, including all attached masses."""
        return self.mass_per_length * self.length + sum(point.mass for point in self.all_masses)

    @property
    def mass_moment(self) -> float:
        """The first moment of all masses about x = 0 in kg·m."""
        attached = sum(point.mass * point.x for point in self.all_masses)
        return self.mass_per_length * self.length * self.mass_centre + attached

    def mean_width(self, collar: Collar) -> float:
        """Return the width in m of a collar around the section at its midpoint."""
        return collar.width(self.section_at(collar.midpoint))

    @property
    def mirrors(self) -> tuple[Direction, ...]:
        """The normals of the symmetry planes of the section with its collars."""
        return tuple(
            axis
            for axis in self.widest.mirrors
            if all(collar.is_symmetric(self.widest, axis) for collar in self.collars)
        )

    def prismatic_at(self, x: float) -> Segment:
        """Return the prismatic segment with the section of this one at x in m."""
        if self.head_section is None:
            return self
        added, section = {"added_mass_per_length": self.added_mass_per_length}, self.section_at(x)
        return Segment.of_section(self.name, *self.ends, self.material, section, **added)

    def property_ratio(self, number: Callable[[Segment], float], x: Array) -> Array:
        """Return the ratio (num_places,) of a property at x in m to its value for the segment."""
        if self.head_section is None:
            return np.ones(x.shape)
        return np.array([number(self.prismatic_at(place)) for place in x.tolist()]) / number(self)

    @property
    def bending_stiffness(self) -> float:
        """The bending stiffness E J in N·m²."""
        return self.material.youngs_modulus * self.second_moment_of_area

    @property
    def shear_stiffness(self) -> float | None:
        """The shear stiffness G A_s in N; None if it is unknown."""
        if self.shear_stiffnesses is not None:
            return self.shear_stiffnesses[0]
        if self.section is None:
            return None
        return self.material.shear_modulus * self.section.shear_area

    @property
    def rigid_modes(self) -> int:
        """The number of rigid modes along z."""
        num_restraints = sum(
            2 if support.holds_slope("z") or support.rotation_stiffness is not None else 1
            for support in self.supports
        )
        return max(0, 2 - num_restraints)

    @property
    def rigid_twists(self) -> int:
        """The number of rigid modes of twist."""
        return 0 if self.supports else 1

    @property
    def foot(self) -> Support | None:
        """The support nearest to the base, which holds the segment along x."""
        return min(self.supports, key=lambda support: support.x, default=None)

    def holds(self, x: float) -> bool:
        """Return whether x in m is on the segment, including its ends."""
        near = SAME_PLACE * self.length
        return self.start - near <= x <= self.end + near

    def turned(self) -> Segment:
        """Return the segment with y and z exchanged.

        Raises:
            ValueError: the segment has no lateral properties.
        """
        if self.lateral is None:
            raise ValueError(f"{self.name!r} has no lateral numbers to exchange")
        return replace(
            self,
            second_moment_of_area=self.lateral.second_moment_of_area,
            rotary_inertia=self.lateral.rotary_inertia,
            load=self.lateral.load,
            supports=tuple(support.turned() for support in self.supports),
            section=None if self.section is None else self.section.turned(),
            head_section=None if self.head_section is None else self.head_section.turned(),
            shear_stiffnesses=self.shear_stiffnesses and self.shear_stiffnesses[::-1],
            lateral=replace(
                self.lateral,
                second_moment_of_area=self.second_moment_of_area,
                rotary_inertia=self.rotary_inertia,
                load=self.load,
            ),
        )

    def check_place(self, where: str, x: float) -> None:
        """Check that a position is on the segment.

        Args:
            where: attribute of the boom with this position, for messages.
            x: position in m.

        Raises:
            BoomError: the position is not on the segment.
        """
        if not self.holds(x):
            raise BoomError(
                where,
                f"{x:g} m lies outside {self.name!r}; it must be between {self.start:g} and "
                f"{self.end:g} m",
            )

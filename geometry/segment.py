# SPDX-License-Identifier: LGPL-3.0-or-later
"""One segment of the boom: its numbers as a beam, its supports, and what sits on it.

x runs along the boom, z is the plane of bending, y is lateral. Everything is in SI units.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any, Literal

from geometry.compression import UNPRESSED, Compression
from geometry.section import Direction, Section

# Two places closer than this part of a segment's length are one: far below any plate, far above
# round-off, in whatever unit.
SAME_PLACE = 1.0e-10


Hold = Literal["pinned", "clamped"]


class BoomError(ValueError):
    """A boom that cannot be. ``where`` is the key of the fault, ``segment[2].span`` say."""

    def __init__(self, where: str, what: str) -> None:
        super().__init__(f"{where}: {what}")
        self.where = where
        self.what = what


@dataclass(frozen=True, slots=True)
class Material:
    """Isotropic linear elasticity: E in Pa, ν, density in kg/m³; yield strength in Pa, where known.

    >>> steel = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
    >>> print(f"{1e-9 * steel.shear_modulus:.1f} GPa")
    80.8 GPa
    """

    youngs_modulus: float
    poissons_ratio: float
    density: float
    yield_strength: float | None = None

    @property
    def shear_modulus(self) -> float:
        """G = E / 2(1 + ν) in Pa."""
        return self.youngs_modulus / (2.0 * (1.0 + self.poissons_ratio))


@dataclass(frozen=True, slots=True)
class Support:
    """What holds a segment at x: its deflection, along y as along z, and its twist.

    >>> pt.Support(2.0).stiffness is None, pt.Support(0.0, "clamped").kind
    (True, 'clamped')
    >>> hinge = pt.Support(0.0, lateral_kind="clamped", depth=0.2)  # of a pin across the boom
    >>> hinge.holds_slope("z"), hinge.holds_slope("y")
    (False, True)

    Args:
        x: m.
        kind: ``pinned`` leaves the slopes free, ``clamped`` holds them too.
        stiffness: of a pinned support whose deflections give way, in N/m, the same along y and
            along z; rigid unless given. The twist is held rigidly all the same.
        lateral_kind: whether the slope along y is held; as that along z unless given.
        rotation_stiffness: against the slopes that are not held, in N·m/rad; none unless given.
        dashpot: beside ``stiffness`` in N·s/m, likewise along y and along z.
        depth: of its pin below the axis in m, which the lines of cylinders heed.
    """

    x: float
    kind: Hold = "pinned"
    stiffness: float | None = None
    lateral_kind: Hold | None = None
    rotation_stiffness: float | None = None
    dashpot: float = 0.0
    depth: float = 0.0

    def holds_slope(self, direction: Direction) -> bool:
        """Whether the slope along y or z is held rigidly."""
        lateral = self.lateral_kind or self.kind
        return (self.kind if direction == "z" else lateral) == "clamped"

    def turned(self) -> Support:
        """Of a segment whose two planes are exchanged."""
        if self.lateral_kind is None:
            return self
        return replace(self, kind=self.lateral_kind, lateral_kind=self.kind)


@dataclass(frozen=True, slots=True)
class PointMass:
    """A mass in kg on the axis at x in m, without inertia against turning.

    >>> arm = replace(boom.segments[0], masses=(pt.PointMass(x=8.0, mass=200.0),))
    >>> heavier = pt.finite_element_system(replace(boom, segments=(arm, boom.segments[1])), laws)
    >>> bool(heavier.row_masses[0] > pt.finite_element_system(boom, laws).row_masses[0])
    True
    """

    x: float
    mass: float


@dataclass(frozen=True, slots=True)
class Collar:
    """A doubler around the box, on all walls, whose mid-surfaces stay where they are.

    >>> head = pt.Collar(start=7.5, end=8.0, thickness=0.01)
    >>> len(replace(boom.segments[0], collars=(head,)).collars)
    1

    Args:
        start, end: x of its ends in m.
        thickness: what it adds to each wall in m.
    """

    start: float
    end: float
    thickness: float


@dataclass(frozen=True, slots=True)
class Diaphragm:
    """A plate that closes the box at x, welded to its walls.

    >>> plate = pt.Diaphragm(x=0.5, thickness=0.01)
    >>> len(replace(boom.segments[0], diaphragms=(plate,)).diaphragms)
    1

    Args:
        x: of its mid-surface in m.
        thickness: m.
    """

    x: float
    thickness: float


@dataclass(frozen=True, slots=True)
class Lateral:
    """What a beam in space has beyond one in the plane x-z.

    >>> print(f"{boom.segments[0].lateral.torsion_constant:.1e} m⁴")
    2.8e-04 m⁴

    Args:
        second_moment_of_area: for bending in the plane x-y in m⁴.
        rotary_inertia: for bending in the plane x-y in kg·m.
        torsion_constant: J_t of the twisting stiffness G J_t in m⁴.
        polar_inertia: mass moment of a unit of length about x in kg·m.
        load: uniform load along y in N/m, applied at t = 0 and kept.
    """

    second_moment_of_area: float
    rotary_inertia: float
    torsion_constant: float
    polar_inertia: float
    load: float = 0.0


@dataclass(frozen=True, slots=True)
class Segment:
    """One box of the boom, with the numbers of its beam and, where known, its plates.

    >>> fly = boom.segments[1]
    >>> fly.length, fly.rigid_modes
    (8.0, 2)

    Args:
        name: how messages and results call it.
        start, end: x of its ends in m.
        material: elastic constants and density.
        mass_per_length: m̄ in kg/m.
        second_moment_of_area: J in m⁴.
        rotary_inertia: I_p in kg·m.
        section: its plates; only shear-flexible beams, shells and booms in space need it.
        load: uniform load along z in N/m, applied at t = 0 and kept.
        supports: what holds it.
        viscous_damping: μ̄ of (25) in N·s/m², of the deflections along y as along z.
        masses: what it carries.
        lateral: what a boom in space needs.
        collars, diaphragms: what stiffens the plates; beams do not know of them, and the numbers
            above are those of the plain box.
        compression: the axial force that it carries, see :func:`geometry.axial.with_compression`.
    """

    name: str
    start: float
    end: float
    material: Material
    mass_per_length: float
    second_moment_of_area: float
    rotary_inertia: float
    section: Section | None = None
    load: float = 0.0
    supports: tuple[Support, ...] = ()
    viscous_damping: float = 0.0
    masses: tuple[PointMass, ...] = ()
    lateral: Lateral | None = None
    collars: tuple[Collar, ...] = ()
    diaphragms: tuple[Diaphragm, ...] = ()
    compression: Compression = UNPRESSED

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
        """A segment whose beam numbers are those of its plates, in space as in the plane.

        >>> import protractile as pt
        >>> steel = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
        >>> box = pt.BoxSection(height=0.4, width=0.3, flange=0.01, web=0.01)
        >>> arm = pt.Segment.of_section("arm", 0.0, 10.0, steel, box, load=-100.0)
        >>> round(arm.mass_per_length, 6)
        109.9

        Args:
            name, start, end, material, section, others: as of :class:`Segment`.
        """
        density, second_moment = material.density, section.second_moment_of_area
        sideways = section.lateral_second_moment_of_area
        lateral = Lateral(
            second_moment_of_area=sideways,
            rotary_inertia=density * sideways,
            torsion_constant=section.torsion_constant,
            polar_inertia=density * section.polar_second_moment_of_area,
        )
        return cls(
            name,
            start,
            end,
            material,
            mass_per_length=section.mass_per_length(density),
            second_moment_of_area=second_moment,
            rotary_inertia=density * second_moment,
            section=section,
            **{"lateral": lateral, **others},
        )

    @property
    def length(self) -> float:
        """Length in m."""
        return self.end - self.start

    @property
    def bending_stiffness(self) -> float:
        """E J in N·m²."""
        return self.material.youngs_modulus * self.second_moment_of_area

    @property
    def rigid_modes(self) -> int:
        """How many motions along z the supports leave free of strain."""
        held = sum(
            1 if support.kind == "pinned" and support.rotation_stiffness is None else 2
            for support in self.supports
        )
        return max(0, 2 - held)

    @property
    def rigid_twists(self) -> int:
        """How many turns about the axis the supports leave free of strain."""
        return 0 if self.supports else 1

    @property
    def foot(self) -> Support | None:
        """The support nearest to the base, which holds the segment along x."""
        return min(self.supports, key=lambda support: support.x, default=None)

    def holds(self, x: float) -> bool:
        """Whether x lies on the segment, its ends included."""
        near = SAME_PLACE * self.length
        return self.start - near <= x <= self.end + near

    def turned(self) -> Segment:
        """The segment with its two planes exchanged: what it does along y, this one does along z.

        Raises:
            ValueError: the segment has no lateral numbers.
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
            lateral=replace(
                self.lateral,
                second_moment_of_area=self.second_moment_of_area,
                rotary_inertia=self.rotary_inertia,
                load=self.load,
            ),
        )

    def check(self, where: str) -> None:
        """Whether there can be such a segment.

        Args:
            where: its key, ``segment[2]`` say.

        Raises:
            BoomError: an empty span; a support, a mass, a collar or a diaphragm off the segment
                or impossible.
        """
        if not self.start < self.end:
            raise BoomError(
                f"{where}.span",
                f"must run from a smaller to a larger x, got [{self.start:g}, {self.end:g}] m",
            )
        for support in self.supports:
            self._check_place(f"{where}.supports", support.x)
            _check_support(f"{where}.supports", support)
        places = sorted(support.x for support in self.supports)
        if any(right - left <= SAME_PLACE * self.length for left, right in pairwise(places)):
            raise BoomError(f"{where}.supports", "a place is given twice; give each once")
        for mass in self.masses:
            self._check_place(f"{where}.masses", mass.x)
            if not 0.0 < mass.mass < float("inf"):
                raise BoomError(
                    f"{where}.masses", f"must be positive numbers of kg, got {mass.mass:g}"
                )
        self._check_collars(where)
        self._check_diaphragms(where)

    def _check_collars(self, where: str) -> None:
        for number, collar in enumerate(self.collars, start=1):
            key = f"{where}.collars[{number}]"
            self._check_thickness(key, collar.thickness)
            if not collar.end - collar.start > SAME_PLACE * self.length:
                raise BoomError(
                    f"{key}.span",
                    "must run from a smaller to a larger x, got "
                    f"[{collar.start:g}, {collar.end:g}] m",
                )
            for x in (collar.start, collar.end):
                self._check_place(f"{key}.span", x)
        rising = sorted(self.collars, key=lambda collar: collar.start)
        for left, right in pairwise(rising):
            if left.end - right.start > SAME_PLACE * self.length:
                raise BoomError(
                    f"{where}.collars",
                    f"two lie on one another from {right.start:g} m on; give one of the thickness "
                    "of both there",
                )

    def _check_diaphragms(self, where: str) -> None:
        for number, diaphragm in enumerate(self.diaphragms, start=1):
            key = f"{where}.diaphragms[{number}]"
            self._check_thickness(key, diaphragm.thickness)
            self._check_place(f"{key}.x", diaphragm.x)
        places = sorted(diaphragm.x for diaphragm in self.diaphragms)
        if any(right - left <= SAME_PLACE * self.length for left, right in pairwise(places)):
            raise BoomError(f"{where}.diaphragms", "a place is given twice; give each once")

    def _check_thickness(self, where: str, thickness: float) -> None:
        if not 0.0 < thickness < float("inf"):
            raise BoomError(
                f"{where}.thickness", f"must be a positive number of m, got {thickness:g}"
            )
        if self.section is None:
            return
        half = 0.5 * min(self.section.size("z"), self.section.size("y"))
        if thickness > half:
            raise BoomError(
                f"{where}.thickness",
                f"must be at most {half:.6g} m, half of what the box is across, got {thickness:g}",
            )

    def _check_place(self, where: str, x: float) -> None:
        if not self.holds(x):
            raise BoomError(
                where,
                f"{x:g} m lies outside the segment; it must be between {self.start:g} and "
                f"{self.end:g} m",
            )


def _check_support(where: str, support: Support) -> None:
    at = f"at {support.x:g} m"
    if support.stiffness is not None and (support.holds_slope("z") or support.holds_slope("y")):
        hold = "clamped support" if support.holds_slope("z") else "hinge"
        raise BoomError(
            where,
            f"a {hold} is rigid, and the one {at} has a stiffness; leave it out, or make the "
            "support pinned",
        )
    if support.rotation_stiffness is not None and support.holds_slope("z"):
        raise BoomError(
            where,
            f"a clamped support holds the slope, and the one {at} has a rotation_stiffness; leave "
            "it out, or make the support pinned",
        )
    if support.dashpot > 0.0 and support.stiffness is None:
        raise BoomError(
            where,
            f"the support {at} is rigid, and its dashpot would never move; leave it out, or give "
            "the support a stiffness",
        )
    for key, what, unit in (
        ("stiffness", "stiffness", "N/m"),
        ("rotation_stiffness", "stiffness against rotation", "N m/rad"),
    ):
        given = getattr(support, key)
        if given is not None and not 0.0 < given < float("inf"):
            raise BoomError(
                where, f"the {what} {at} must be a positive number of {unit}, got {given:g}"
            )
    if not 0.0 <= support.dashpot < float("inf"):
        raise BoomError(
            where, f"the dashpot {at} must be a number of N s/m from 0 on, got {support.dashpot:g}"
        )

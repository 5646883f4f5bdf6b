# SPDX-License-Identifier: LGPL-3.0-or-later
"""Supports of segments on the ground."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Literal

from geometry.fault import BoomError
from geometry.section import Direction

Hold = Literal["pinned", "clamped"]


@dataclass(frozen=True, slots=True)
class Support:
    """A support at x, which holds a segment's deflection, along y as along z, and its twist.

    >>> pt.Support(2.0).stiffness is None, pt.Support(0.0, "clamped").kind
    (True, 'clamped')
    >>> hinge = pt.Support(0.0, lateral_kind="clamped", depth=0.2)  # of a pin across the boom
    >>> hinge.holds_slope("z"), hinge.holds_slope("y")
    (False, True)

    Args:
        x: m.
        kind: ``pinned`` leaves the slopes free, ``clamped`` holds them too.
        stiffness: of an elastic pinned support, in N/m, the same along y and
            along z; rigid unless given. The twist is held rigidly all the same.
        lateral_kind: whether the slope along y is held; as that along z unless given.
        rotation_stiffness: against the slopes that are not held, in N·m/rad; none unless given.
        dashpot: beside ``stiffness`` in N·s/m, likewise along y and along z.
        depth: of its pin below the axis in m, about which cylinders and axial forces have moments.
    """

    x: float
    kind: Hold = "pinned"
    stiffness: float | None = None
    lateral_kind: Hold | None = None
    rotation_stiffness: float | None = None
    dashpot: float = 0.0
    depth: float = 0.0

    def holds_slope(self, direction: Direction) -> bool:
        """Return whether the slope along y or z is held rigidly."""
        lateral = self.lateral_kind or self.kind
        return (self.kind if direction == "z" else lateral) == "clamped"

    @property
    def clamped(self) -> bool:
        """True if it holds both slopes rigidly."""
        return self.holds_slope("z") and self.holds_slope("y")

    def turned(self) -> Support:
        """Return the support of a segment whose two planes are exchanged."""
        if self.lateral_kind is None:
            return self
        return replace(self, kind=self.lateral_kind, lateral_kind=self.kind)


def check_support(where: str, support: Support) -> None:
    """Check that a support is possible; ``where`` is its place in the boom.

    Raises:
        BoomError: it is both rigid and elastic, or a number is impossible.
    """
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

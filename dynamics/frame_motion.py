# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slewing and luffing: inertia forces in the frame that rotates with the boom.

The frame rotates by the slewing angle ψ about the vertical, and by the luffing angle α about the
foot of the boom. With the extension s, a point of the boom is ξ = x − x_foot + s ahead of the foot
pin along the axis, d above it, the depth of the pin, and r = r_0 + ξ cos α − d sin α from the
slewing axis. The accelerations of the point

    a_x = s̈ − ξ α̇² − d α̈ − ψ̇² r cos α,             a_y = r ψ̈ + 2 ψ̇ ṙ,
    a_z = ξ α̈ + 2 ṡ α̇ − d α̇² + ψ̇² r sin α

are along x, y and z of the boom (Goldstein 1980). A mass has the inertia force of opposite sign.
The effect of deflections on accelerations is neglected.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from protractile.dynamics.arrays import Array
from protractile.dynamics.motion_laws import HistorySum, MotionLaw

# Number of times, in addition to kinks, at which the peak of an acceleration is searched.
_SAMPLES = 2001

_RESTING = HistorySum(())


@dataclass(frozen=True, slots=True)
class FrameMotion:
    """Slewing and luffing of a boom."""

    slew: MotionLaw = _RESTING  #: angle ψ in degrees over time, positive towards +y
    luff: MotionLaw = _RESTING  #: change of the luffing angle in degrees over time
    angle: float = 0.0  #: luffing angle at t = 0 in degrees
    foot: float = 0.0  #: x of the foot in m
    depth: float = 0.0  #: depth d in m of the foot pin below the axis
    #: horizontal distance r_0 in m of the foot from the slewing axis, positive outwards
    radius: float = 0.0
    gravity: float = 0.0  #: acceleration of gravity in m/s²; 0 without weight

    def slew_angle(self, time: Array, order: int = 0) -> Array:
        """Return ψ (…) in rad, or its derivative of the order 1 or 2, at times (…) in s."""
        return np.deg2rad(self.slew.rate(time, order) if order else self.slew(time))

    def luff_angle(self, time: Array, order: int = 0) -> Array:
        """Return α (…) in rad, or its derivative of the order 1 or 2, at times (…) in s."""
        change = np.deg2rad(self.luff.rate(time, order) if order else self.luff(time))
        return change if order else np.deg2rad(self.angle) + change

    def position(self, time: Array, x: float, extension: MotionLaw) -> tuple[Array, Array]:
        """Return a point's distance from the slewing axis and height above the foot in m.

        Arguments as in :meth:`accelerations`.
        """
        along, luffed = x - self.foot + extension(time), self.luff_angle(time)
        cosine, sine = np.cos(luffed), np.sin(luffed)
        return (
            self.radius + along * cosine - self.depth * sine,
            along * sine + self.depth * cosine,
        )

    def drive_moments(self, time: Array, x: float, mass: float, extension: MotionLaw) -> Array:
        """Return the slewing and the luffing moment (2, ...) in N·m that move a mass m in kg.

        They are m r a_y about the slewing axis, and m ξ (a_z + g cos α) − m d (a_x + g sin α) about
        the foot pin. The other arguments are as in :meth:`accelerations`.
        """
        axial, lateral, across = self.accelerations(time, x, extension)
        along, luffed = x - self.foot + extension(time), self.luff_angle(time)
        radius, _ = self.position(time, x, extension)
        luffing = along * (across + self.gravity * np.cos(luffed))
        luffing = luffing - self.depth * (axial + self.gravity * np.sin(luffed))
        return mass * np.array([radius * lateral, luffing])

    def accelerations(self, time: Array, x: float, extension: MotionLaw) -> Array:
        """Return a_x, a_y and a_z (3, ...) in m/s² of a point of the boom.

        Args:
            time: times (...) in s.
            x: initial position of the point in m.
            extension: travel in m of the segment with the point.
        """
        along, speed = x - self.foot + extension(time), extension.rate(time, 1)
        luffed, turn, faster = (self.luff_angle(time, order) for order in range(3))
        cosine, sine, depth = np.cos(luffed), np.sin(luffed), self.depth
        (radius, height), slew = self.position(time, x, extension), self.slew_angle(time, 1)
        out = speed * cosine - height * turn
        return np.array(
            np.broadcast_arrays(
                extension.rate(time, 2)
                - along * turn**2
                - depth * faster
                - slew**2 * radius * cosine,
                radius * self.slew_angle(time, 2) + 2.0 * slew * out,
                along * faster + 2.0 * speed * turn - depth * turn**2 + slew**2 * radius * sine,
            )
        )


@dataclass(frozen=True, slots=True)
class FrameAcceleration:
    """Acceleration of a point of the boom by slewing and luffing, as a history of inertia loads.

    It includes the change of gravity in the axes of the boom since t = 0, when α is α₀:
    g (cos α − cos α₀) along z, and g (sin α − sin α₀) along x.
    """

    frame: FrameMotion  #: slewing and luffing of the boom
    direction: Literal["x", "y", "z"]  #: component of the acceleration
    x: float | None = None  #: position in m; None for the increase of the acceleration per m of x
    extension: MotionLaw = _RESTING  #: travel of the segment with the point

    @property
    def _laws(self) -> tuple[MotionLaw, MotionLaw, MotionLaw]:
        return self.frame.slew, self.frame.luff, self.extension

    @property
    def kinks(self) -> tuple[float, ...]:
        """The times in s at which an angle or the extension has a kink."""
        return HistorySum(self._laws).kinks

    @property
    def fastest(self) -> float:
        """An upper bound of the frequency in rad/s, for products of angles and extension."""
        return 2.0 * sum(law.fastest for law in self._laws)

    @property
    def peak(self) -> float:
        """The largest |acceleration| in m/s², at sampled times."""
        kinks = np.array(self.kinks or (0.0,))
        times = np.linspace(kinks.min(), kinks.max(), _SAMPLES)
        return float(np.abs(self(np.concatenate([times, kinks]))).max())

    def __call__(self, time: Array) -> Array:
        frame, component = self.frame, "xyz".index(self.direction)
        if self.x is None:
            one, other = (
                frame.accelerations(time, x, self.extension)[component] for x in (1.0, 0.0)
            )
            return np.asarray(one - other)
        luffed, start = frame.luff_angle(time), np.deg2rad(frame.angle)
        weight = {
            "x": np.sin(luffed) - np.sin(start),
            "y": 0.0,
            "z": np.cos(luffed) - np.cos(start),
        }
        inertial = frame.accelerations(time, self.x, self.extension)[component]
        return np.asarray(inertial + frame.gravity * weight[self.direction])


class Spin(FrameAcceleration):
    """Centrifugal acceleration per deflection along y or z in 1/s², as a history.

    The deflections v and w of a boom that slews and luffs have the centrifugal accelerations ψ̇² v
    and (α̇² + ψ̇² sin² α) w.
    """

    def __call__(self, time: Array) -> Array:
        slewed = self.frame.slew_angle(time, 1) ** 2
        if self.direction == "y":
            return slewed
        sine = np.sin(self.frame.luff_angle(time))
        return np.asarray(self.frame.luff_angle(time, 1) ** 2 + slewed * sine**2)


class PathAcceleration(FrameAcceleration):
    """Acceleration of a point of the straight boom along a fixed axis.

    Here z points upwards, x outwards at ψ = 0. Arguments as in :class:`FrameAcceleration`.
    """

    def __call__(self, time: Array) -> Array:
        along, lateral, across = self.frame.accelerations(time, self.x or 0.0, self.extension)
        luffed, slewed = self.frame.luff_angle(time), self.frame.slew_angle(time)
        if self.direction == "z":
            return np.asarray(along * np.sin(luffed) + across * np.cos(luffed))
        out = along * np.cos(luffed) - across * np.sin(luffed)
        first, second = (out, -lateral) if self.direction == "x" else (lateral, out)
        return np.asarray(first * np.cos(slewed) + second * np.sin(slewed))

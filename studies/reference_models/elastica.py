# SPDX-License-Identifier: LGPL-3.0-or-later
"""Two inextensible elasticas that touch at two stations with play, under dead loads.

The outer rod is clamped at its foot at a luffing angle. The inner rod presses upwards on it at its
tail, which a lock holds along the outer rod, and downwards at the head of the outer rod, on which
it slides without friction. Rotations are of any size (Love 1927, sections 259 to 263).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root

from protractile.geometry.arrays import Array

# Relative error of the integration along a rod, and of the equilibrium.
_INTEGRATION, _EQUILIBRIUM = 1.0e-9, 1.0e-8
# Number of steps in which the loads grow from zero.
_STEPS = 4


class State(NamedTuple):
    """Position, slope and moment at a place of a rod."""

    x: float
    y: float
    slope: float  #: angle of the tangent in rad, from the horizontal
    moment: float  #: in N m, positive if the slope increases along the rod

    @property
    def normal(self) -> Array:
        """The unit vector (2,) normal to the tangent, upwards for a horizontal rod."""
        return np.array([-np.sin(self.slope), np.cos(self.slope)])

    @property
    def point(self) -> Array:
        """The position (2,) in m."""
        return np.array([self.x, self.y])


@dataclass(frozen=True)
class Rod:
    """An inextensible rod without shear."""

    length: float  #: in m
    stiffness: float  #: bending stiffness in N m²
    weight: float = 0.0  #: in N/m

    def follow(self, state: State, force: Array, length: float) -> tuple[State, Array]:
        """Return state and force at the end of a part of the rod.

        Args:
            state: state at the start of the part.
            force: force (2,) in N at the start, by which the rest of the rod acts there.
            length: length of the part in m.
        """

        def rates(s: float, values: Array) -> list[float]:
            _, _, slope, moment = values
            cosine, sine = np.cos(slope), np.sin(slope)
            across = (force[1] + self.weight * s) * cosine - force[0] * sine
            return [cosine, sine, moment / self.stiffness, -across]

        found = solve_ivp(
            rates, (0.0, length), state, "DOP853", rtol=_INTEGRATION, atol=_INTEGRATION
        )
        return State(*found.y[:, -1]), force + np.array([0.0, self.weight * length])


class Rest(NamedTuple):
    """A boom at rest."""

    tip: float  #: deflection of the tip across the straight boom in m
    foot_moment: float  #: moment at the foot in N m
    radius: float  #: horizontal distance of the tip from the foot in m


@dataclass(frozen=True)
class Telescope:
    """Two rods that overlap, with play at the tail of the inner and the head of the outer one."""

    outer: Rod
    inner: Rod
    overlap: float  #: in m
    play: float  #: 2Δ in m
    load: float  #: vertical force at the tip in N, positive downwards
    angle: float  #: luffing angle of the foot in rad

    @property
    def length(self) -> float:
        """The length in m from foot to tip."""
        return self.outer.length + self.inner.length - self.overlap

    def rest(self) -> Rest:
        """Return the state of rest.

        Raises:
            RuntimeError: no state was found.
        """
        # The moment is in units of load times length, forces are in units of the load.
        unknowns = np.array([-0.5, self.angle, 0.0, -1.0, 1.0, 1.0])
        for factor in np.linspace(0.0, 1.0, _STEPS + 1)[1:]:
            part = replace(
                self,
                outer=replace(self.outer, weight=factor * self.outer.weight),
                inner=replace(self.inner, weight=factor * self.inner.weight),
                load=factor * self.load,
            )
            found = root(part._residuals, unknowns, tol=_EQUILIBRIUM)
            if not found.success:
                raise RuntimeError(f"two elasticas: {found.message}")
            unknowns = found.x
        moment, tip = self._shape(unknowns)[:2]
        across = np.array([-np.sin(self.angle), np.cos(self.angle)])
        return Rest(float(tip.point @ across), moment, tip.x)

    @property
    def _weight(self) -> float:
        rods = self.outer, self.inner
        return self.load + sum(rod.weight * rod.length for rod in rods)

    def _shape(self, unknowns: Array) -> tuple[float, State, Array]:
        """Return the moment at the foot, the state of the tip, and the residuals (6,).

        Args:
            unknowns: (6,) moment at the foot, slope at the tail, force (2,) on the tail of the
                inner rod, force at the head, and place of the head along the inner rod.
        """
        total = self._weight
        moment, slope, *push, press, place = unknowns
        moment, tail_force = moment * total * self.length, np.array(push) * total
        press, place = press * total, place * self.overlap
        foot = State(0.0, 0.0, self.angle, moment)
        before = self.outer.length - self.overlap
        under, force = self.outer.follow(foot, np.array([0.0, -total]), before)
        offset = 0.5 * self.play * under.normal
        turn = offset[0] * tail_force[1] - offset[1] * tail_force[0]
        over = under._replace(moment=under.moment + turn)
        head, force = self.outer.follow(over, force + tail_force, self.overlap)
        x, y = under.point + offset
        tail = State(x, y, slope, 0.0)
        inside, force = self.inner.follow(tail, -tail_force, place)
        end, force = self.inner.follow(
            inside, force - press * inside.normal, self.inner.length - place
        )
        # The axis of the inner rod passes below that of the outer one.
        gap = inside.point + 0.5 * self.play * inside.normal - head.point
        moments = np.array([head.moment, end.moment]) / (total * self.length)
        forces = (force + np.array([0.0, self.load])) / total
        return moment, end, np.array([*moments, *forces, *(gap / self.overlap)])

    def _residuals(self, unknowns: Array) -> Array:
        return self._shape(unknowns)[2]

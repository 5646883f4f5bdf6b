# SPDX-License-Identifier: LGPL-3.0-or-later
"""A load on a rope below the tip: hoisting, lift-off, hanging and swinging.

The mass m has its own coordinate z_m, the height above its initial position. The rope carries only
tension,

    F_r = k_r max(w cos α − z_m + ℓ_w(t) − Δ_r, 0),

with its stiffness k_r, the deflection w of the tip along z, the luffing angle α, the length ℓ_w
that the winch has hoisted since t = 0, and the slack Δ_r. Until lift-off the ground carries the
load. Rope and ground are contact rows. The winch is a travel of the row of the rope, so that the
energy balance includes the work of the winch.

A load that swings as a pendulum of length ℓ_p has two further coordinates X and Y. They are its
horizontal displacements from the tip of the straight boom in fixed axes. For small angles, springs
of stiffness m g/ℓ_p connect it with the tip. The acceleration of the tip of the straight boom is an
inertia load. Slewing and luffing rotate the rows of the tip. Since the axes are fixed, the
equations have no Coriolis terms.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import ContactLaw, PowerContact
from protractile.dynamics.excitation import Excitation, History, PiecewiseLinear
from protractile.dynamics.frame_motion import FrameMotion, PathAcceleration
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.motion_laws import MotionLaw
from protractile.dynamics.trajectory import Trajectory
from protractile.dynamics.travel import RowKind, RowTable, Travel

# Ratio of the stiffnesses of ground and rope.
_GROUND = 100.0


@dataclass(frozen=True, slots=True)
class RopeForce:
    """History of the rope force in a slow lift, up to the weight of a load on the ground."""

    hoist: History  #: hoisted length in m over time
    stretch: float  #: elongation in m of rope and boom under the weight
    slack: float  #: length in m that is hoisted before the rope is tight
    peak: float = 1.0

    @property
    def kinks(self) -> Sequence[float]:
        """The times in s at which the hoisting speed changes."""
        return self.hoist.kinks

    @property
    def fastest(self) -> float:
        """The highest frequency of hoisting in rad/s."""
        return self.hoist.fastest

    def __call__(self, time: Array) -> Array:
        return np.clip((self.hoist(time) - self.slack) / self.stretch, 0.0, self.peak)


@dataclass(frozen=True, slots=True)
class Release:
    """History of a change by a dropped load: 0 up to t = 0, then 1.

    A motion changes linearly within its first step.
    """

    kinks = (0.0,)
    peak = 1.0
    fastest = 0.0

    def __call__(self, time: Array) -> Array:
        return np.where(np.asarray(time) > 0.0, 1.0, 0.0)


@dataclass(frozen=True, slots=True)
class Pendulum:
    """Horizontal motion of a hanging load."""

    length: float  #: distance ℓ_p from the tip to the load in m
    frame: FrameMotion  #: slewing and luffing of the boom
    x: float  #: initial position of the tip along the boom in m
    extension: MotionLaw  #: travel of the tip along the boom
    #: (axis, force in N, history) of each wind force on the load; X points outwards at t = 0
    winds: Sequence[tuple[Literal["x", "y"], float, History]] = ()

    def read(self, time: float, across: Array, lateral: Array) -> Array:
        """Return the rows (3, num_modes) of the tip's deflections up, along X and along Y.

        Args:
            time: time in s.
            across, lateral: rows (num_modes,) of the deflections of the tip along z and y.
        """
        at = np.array(time)
        luffed, slewed = self.frame.luff_angle(at), self.frame.slew_angle(at)
        out = -np.sin(luffed) * across
        return np.array(
            [
                np.cos(luffed) * across,
                np.cos(slewed) * out - np.sin(slewed) * lateral,
                np.sin(slewed) * out + np.cos(slewed) * lateral,
            ]
        )


@dataclass(frozen=True, slots=True)
class HangingLoad:
    """Load on a rope with a winch.

    Args:
        mass: m in kg.
        stiffness: k_r of the rope in N/m.
        gravity: acceleration in m/s².
        hoist: hoisted length in m over time; None for a rope of constant length.
        cosine: cos α of the luffing angle.
        slack: Δ_r in m of a load on the ground at t = 0; None for a load that hangs.
        pendulum: horizontal motion of a load that hangs; None for vertical motion only.

    Raises:
        ValueError: mass, stiffness or gravity is not finite and positive.
    """

    mass: float
    stiffness: float
    gravity: float
    hoist: History | None = None
    cosine: float = 1.0
    slack: float | None = None
    pendulum: Pendulum | None = None

    def __post_init__(self) -> None:
        for name in ("mass", "stiffness", "gravity"):
            if not 0.0 < getattr(self, name) < np.inf:
                raise ValueError(f"{name} must be finite and positive, got {getattr(self, name)}")

    @property
    def weight(self) -> float:
        """The weight m g in N."""
        return self.mass * self.gravity

    def attach(self, system: GapSystem, tip: Array, x: float) -> GapSystem:
        """Return the system of a boom with the load at its tip.

        The coordinates of the load come last. Rope, springs of a pendulum, and ground are further
        stations with one contact row each. Under a flat boom the load swings only in its plane.

        Args:
            system: gap system of the boom without the load.
            tip: row (num_modes,) of the deflection w.
            x: position of the tip in m.
        """
        dimensions = self._coordinates(system.observers)
        observer = system.observers.get("tip_lateral")
        lateral = np.zeros(tip.shape) if observer is None else observer.row
        coordinates = np.eye(dimensions, system.num_modes + dimensions, system.num_modes) / np.sqrt(
            self.mass
        )

        wide = system.extend(np.zeros(dimensions))
        tip, lateral = (np.pad(row, (0, dimensions)) for row in (tip, lateral))

        def stretches(time: float) -> Array:
            """Return rows (dimensions, num_modes + dimensions) of tip displacement minus load's."""
            if self.pendulum is None:
                return np.asarray(self.cosine * tip[None] - coordinates)
            return np.asarray(self.pendulum.read(time, tip, lateral)[:dimensions] - coordinates)

        height, first = coordinates[0], len(system.rows)
        initial_rows = stretches(0.0)
        travels, excitations = list(wide.travels), list(wide.excitations)
        if self.hoist is not None:
            constant = np.pad(initial_rows[None, None, :1], [(0, 0), (0, 3), (0, 0), (0, 0)])
            table = RowTable(np.array([0.0, 1.0]), constant)
            travels.append(Travel(self.hoist, table, (("rows", first),), shifts=(1.0,)))
        rope_law = PowerContact(self.stiffness, 1.0).upper().with_clearance(self.slack or 0.0)
        contacts: list[tuple[Array, ContactLaw]] = [(initial_rows[0], rope_law)]
        if self.pendulum is not None:
            swing = self.pendulum
            spring = PowerContact(self.weight / swing.length, 1.0)
            contacts += [(row, spring) for row in initial_rows[1:]]
            moves = [*swing.frame.slew.kinks, *swing.frame.luff.kinks]
            if moves and max(moves) > 0.0:
                # The rows follow time, up to the end of slewing and luffing.
                breaks = sorted({0.0, *(time for time in moves if time > 0.0)})
                clock = PiecewiseLinear((0.0, breaks[-1]), (0.0, breaks[-1]))
                rows: list[tuple[RowKind, int]] = [("rows", first + k) for k in range(dimensions)]
                table = RowTable.interpolate(stretches, breaks)
                travels.append(Travel(clock, table, rows, shifts=(0.0,) * dimensions))
            axes: tuple[Literal["z", "x", "y"], ...] = ("z", "x", "y")
            for axis, coordinate in zip(axes, coordinates, strict=False):
                history = PathAcceleration(swing.frame, axis, swing.x, swing.extension)
                if history.peak > 0.0:
                    excitations.append(Excitation(-self.mass * coordinate, history))
                excitations += [
                    Excitation(force * coordinate, when)
                    for direction, force, when in swing.winds
                    if direction == axis
                ]
        if self.slack is not None:
            ground = PowerContact(_GROUND * self.stiffness, 1.0).lower()
            contacts.append((height, ground.with_clearance(0.0, -self.weight / ground.below)))
        numbers = [len(system.stations) + number for number in range(len(contacts))]
        return replace(
            wide,
            load=wide.load - self.weight * height,
            rows=np.concatenate([wide.rows, [row for row, _ in contacts]]),
            laws=[*system.laws, *(law for _, law in contacts)],
            station_of_row=np.array([*system.station_of_row, *numbers], dtype=np.int64),
            stations=[*system.stations, *(x for _ in contacts)],
            station_directions=[*system.station_directions, *("z" for _ in contacts)],
            grounded=[*system.grounded, *numbers],
            observers={**wide.observers, "load_height": Observer(height)},
            excitations=excitations,
            travels=travels,
            hung=np.sqrt(self.mass) * coordinates,
        )

    def separate_rope(self, motion: Trajectory) -> Trajectory:
        """Return the motion without the stations of the load, and with the variables of the rope.

        ``rope_force`` and ``rope_force_peak`` in N, the mean and the maximum of the output interval
        that ends at the time, are positive in tension; their attribute ``weight`` is m g. A
        pendulum has ``swing_out`` and ``swing_aside`` in m, the distances of the load from the tip
        in the directions of the boom; their attribute ``length`` is ℓ_p.
        """
        rows = self._coordinates([str(name) for name in motion.data]) + (
            0 if self.slack is None else 1
        )
        num_stations = motion.data.sizes["station"] - rows
        data = motion.data.isel(station=slice(num_stations))
        for name in ("contact_force", "contact_force_peak"):
            force = motion.data[name].isel(station=num_stations, drop=True)
            force.attrs["long_name"] = force.attrs["long_name"].replace("contact", "rope")
            force.attrs["weight"] = self.weight
            data[name.replace("contact", "rope")] = force
        if self.pendulum is not None:
            slewed = self.pendulum.frame.slew_angle(motion.time)
            # The gaps of the springs: the position of the tip relative to the load, in fixed axes.
            gaps = -motion.data["gap"].values.T[num_stations + 1 :]
            along_x, along_y = gaps if len(gaps) == 2 else (gaps[0], np.zeros(slewed.shape))
            swings = {"swing_out": np.cos(slewed) * along_x + np.sin(slewed) * along_y}
            if len(gaps) == 2:
                swings["swing_aside"] = np.cos(slewed) * along_y - np.sin(slewed) * along_x
            for name, values in swings.items():
                data[name] = "time", values, {"units": "m", "length": self.pendulum.length}
        return Trajectory(data, motion.states, motion.row_peaks)

    def _coordinates(self, outputs: Container[str]) -> int:
        """Return the number of coordinates of the load, by the names of the boom's outputs."""
        return 1 if self.pendulum is None else 2 + ("tip_lateral" in outputs)

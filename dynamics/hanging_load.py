# SPDX-License-Identifier: LGPL-3.0-or-later
"""A load on a rope below the tip: hoisting, lift-off and hanging.

The load m has its own coordinate z, its height above its initial position. The rope carries only
tension,

    T = k max(w cos α − z + h(t) − s, 0),

with the deflection w of the tip across the boom, the luffing angle α, the hoisted length h since
t = 0, and the slack s. Until lift-off the ground carries the load. Rope and ground are contact
rows. The winch is a travel of the rope's row, so that the energy balance includes its work.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from dynamics.arrays import Array
from dynamics.contact import PowerContact
from dynamics.drive.row_table import RowTable
from dynamics.drive.travel import Travel
from dynamics.excitation import History
from dynamics.gap_system import GapSystem, Observer
from dynamics.trajectory import Trajectory

# Ratio of the stiffnesses of ground and rope.
_GROUND = 100.0


@dataclass(frozen=True, slots=True)
class HangingLoad:
    """Load on a rope with a winch.

    Args:
        mass: m in kg.
        stiffness: k of the rope in N/m.
        gravity: acceleration in m/s².
        hoist: hoisted length in m over time; None for a rope of constant length.
        cosine: cos α of the luffing angle.
        slack: s in m at w = 0 of a load on the ground at t = 0; None for a load that hangs.

    Raises:
        ValueError: mass, stiffness or gravity is not finite and positive.
    """

    mass: float
    stiffness: float
    gravity: float
    hoist: History | None = None
    cosine: float = 1.0
    slack: float | None = None

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

        The load adds the last coordinate, and a station with one contact row each for rope and
        ground.

        Args:
            system: gap system of the boom without the load.
            tip: row (num_modes,) of the deflection w.
            x: position of the tip in m.
        """

        def widen(rows: Array) -> Array:
            return np.pad(rows, [(0, 0)] * (rows.ndim - 1) + [(0, 1)])

        def widen_table(table: RowTable) -> RowTable:
            return RowTable(table.knots, widen(table.coefficients))

        height = np.append(np.zeros(system.num_modes), 1.0 / np.sqrt(self.mass))
        rope, rows = self.cosine * widen(tip) - height, len(system.rows)
        travels = [
            replace(
                travel,
                table=widen_table(travel.table),
                axial_forces=[
                    replace(force, table=widen_table(force.table)) for force in travel.axial_forces
                ],
            )
            for travel in system.travels
        ]
        if self.hoist is not None:
            constant = np.pad(rope[None, None, None], [(0, 0), (0, 3), (0, 0), (0, 0)])
            table = RowTable(np.array([0.0, 1.0]), constant)
            travels.append(Travel(self.hoist, table, (("rows", rows),), shifts=(1.0,)))
        tension = PowerContact(self.stiffness, 1.0).upper().behind(self.slack or 0.0)
        contacts = [(rope, tension)]
        if self.slack is not None:
            ground = PowerContact(_GROUND * self.stiffness, 1.0).lower()
            contacts.append((height, ground.behind(0.0, -self.weight / ground.below)))
        numbers = [len(system.stations) + number for number in range(len(contacts))]
        return replace(
            system,
            omega2=np.append(system.omega2, 0.0),
            load=widen(system.load) - self.weight * height,
            rows=np.concatenate([widen(system.rows), [row for row, _ in contacts]]),
            laws=[*system.laws, *(law for _, law in contacts)],
            station_of_row=np.array([*system.station_of_row, *numbers], dtype=np.int64),
            stations=[*system.stations, *(x for _ in contacts)],
            station_directions=[*system.station_directions, *("z" for _ in contacts)],
            grounded=[*system.grounded, *numbers],
            observers={
                **{
                    name: seen._replace(row=widen(seen.row))
                    for name, seen in system.observers.items()
                },
                "load_height": Observer(height),
            },
            damping=widen(system.damping),
            dashpots=widen(system.dashpots),
            friction_rows=widen(system.friction_rows),
            excitations=[replace(one, load=widen(one.load)) for one in system.excitations],
            released_load=widen(system.released_load),
            initial_impulse=widen(system.initial_impulse),
            travels=travels,
            geometric_stiffness=np.pad(
                system.geometric_stiffness, (0, 1 if system.geometric_stiffness.size else 0)
            ),
        )

    def separate_rope(self, motion: Trajectory) -> Trajectory:
        """Return the motion without the stations of the load, and with the variables of the rope.

        ``rope_force`` and ``rope_force_peak`` in N are the mean and the maximum of the output
        interval that ends at the time, positive in tension. Their attribute ``weight`` is m g.
        """
        own = motion.data.sizes["station"] - (1 if self.slack is None else 2)
        data = motion.data.isel(station=slice(own))
        for name in ("contact_force", "contact_force_peak"):
            force = motion.data[name].isel(station=own, drop=True)
            force.attrs["long_name"] = force.attrs["long_name"].replace("contact", "rope")
            force.attrs["weight"] = self.weight
            data[name.replace("contact", "rope")] = force
        return Trajectory(data, motion.states)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Construction of gap systems from contacts, friction and observations, for beams and shells.

A displacement operator gives a displacement from the degrees of freedom of a model, a row gives it
from the modal coordinates. For beams, operators are rows. For shells, the reduction turns operators
into rows. Contact and friction have the same rules for both.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Generic, Literal, NamedTuple, TypeVar

import numpy as np

from protractile.dynamics.arrays import Array
from protractile.dynamics.contact import ContactLaw, DryFriction
from protractile.dynamics.excitation import Excitation, History, InitialImpulse, ReleasedLoad
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.travel import RowKind

R = TypeVar("R")
L = TypeVar("L")


class LawRow(NamedTuple, Generic[R, L]):
    """Contact or friction row: displacement operator, law, and index of its station."""

    operator: R
    law: L
    station: int

    def row(self, read: Callable[[R], Array]) -> Array:
        """Return the row (num_modes,) in 1/√kg; ``read`` returns the row of an operator."""
        return read(self.operator)


class Dashpot(NamedTuple, Generic[R]):
    """Dashpot at a station: constant c_d in N·s/m, and (weight, operator) of each point."""

    coefficient: float
    station: int
    parts: list[tuple[float, R]]

    def row(self, read: Callable[[R], Array]) -> Array:
        """Return the row (num_modes,) in 1/√s; ``read`` returns the row of an operator."""
        total = sum(part * read(operator) for part, operator in self.parts)
        return np.asarray(np.sqrt(self.coefficient) * total)


class OutputOperator(NamedTuple, Generic[R]):
    """Displacement operator of an output; arguments as in :class:`.gap_system.Observer`."""

    operator: R
    unit: str = "m"
    derivative: Literal[0, 1, 2] = 0


@dataclass(frozen=True, slots=True)
class GapBuilder(Generic[R]):
    """Contact rows, friction rows and dashpots, in the order in which they are added.

    Args:
        dashpots: dashpots by index of their station.
        grounded: indices of stations with stops on the ground.
    """

    contacts: list[LawRow[R, ContactLaw]] = field(default_factory=list)
    frictions: list[LawRow[R, DryFriction]] = field(default_factory=list)
    dashpots: dict[int, Dashpot[R]] = field(default_factory=dict)
    grounded: list[int] = field(default_factory=list)

    def add_contact(
        self,
        station: int,
        law: ContactLaw,
        points: Iterable[tuple[int, float, R]],
        shim: float = 0.0,
    ) -> tuple[int, ...]:
        """Add a contact row for each point (side, weight, displacement operator).

        A point of side 1 has contact at positive displacements only, of side −1 at negative ones
        only, with the law times the weight. A point of side 0 has contact at both signs, with the
        law unweighted. A side on which the law has no contact has no row.

        Args:
            station: index of the station.
            law: contact law of the station.
            points: contact points.
            shim: length in m by which the contact closes earlier.

        Returns:
            The indices of the rows.
        """
        first = len(self.contacts)
        for side, weight, operator in points:
            there = law if side == 0 else law.one_sided(side)
            if there is not None:
                part = there.with_weight(weight) if side else there
                part = part.with_clearance(-shim) if shim else part
                self.contacts.append(LawRow(operator, part, station))
        return tuple(range(first, len(self.contacts)))

    def add_stop(
        self, station: int, law: ContactLaw, points: Iterable[tuple[int, float, R]]
    ) -> None:
        """Add contact with the ground; arguments as in :meth:`add_contact`."""
        self.grounded.append(station)
        self.add_contact(station, law, points)

    def add_friction(
        self,
        station: int,
        coefficient: float,
        slide: R,
        normal_force: float | None,
        pressing: tuple[int, ...],
    ) -> None:
        """Add a friction row, unless μ is 0 or there are no contact rows.

        Args:
            station: index of the station.
            coefficient: μ.
            slide: operator of the sliding displacement.
            normal_force: prescribed normal force in N; None for the force of the contact rows.
            pressing: indices of the contact rows.
        """
        if coefficient > 0.0 and pressing:
            normal_rows = pressing if normal_force is None else ()
            law = DryFriction(coefficient, station, normal_force or 0.0, normal_rows)
            self.frictions.append(LawRow(slide, law, station))

    def add_dashpot(
        self, station: int, coefficient: float, points: Iterable[tuple[int, float, R]]
    ) -> None:
        """Add a dashpot that resists the mean speed of points, as in :meth:`add_contact`.

        ``coefficient`` is c_d in N·s/m.
        """
        if coefficient > 0.0:
            dashpot = self.dashpots.setdefault(station, Dashpot(coefficient, station, []))
            # The weights sum to one on each side, so that they are halved if there are two sides.
            parts = ((0.5 * part if side else part, operator) for side, part, operator in points)
            dashpot.parts.extend(parts)

    @property
    def rows(self) -> dict[RowKind, Sequence[LawRow[R, Any] | Dashpot[R]]]:
        """All rows by kind, in the order of a gap system."""
        dashpots = list(self.dashpots.values())
        return {"rows": self.contacts, "friction_rows": self.frictions, "dashpots": dashpots}

    def rows_at(self, stations: Sequence[int]) -> list[tuple[RowKind, int]]:
        """Return (kind, index) of all rows at ``stations``, in the order of a gap system."""
        return [
            (kind, position)
            for kind, of_kind in self.rows.items()
            for position, row in enumerate(of_kind)
            if row.station in stations
        ]

    def evaluate_rows(
        self, moving: Sequence[tuple[RowKind, int]], read: Callable[[R], Array]
    ) -> Array:
        """Return the rows (num_moving, num_modes) with the kinds and indices in ``moving``."""
        rows = self.rows
        return np.array([rows[kind][position].row(read) for kind, position in moving])

    def system(
        self,
        read: Callable[[R], Array],
        omega2: Array,
        load: Array,
        places: Sequence[tuple[float, str]],
        observed: Mapping[str, OutputOperator[R]],
        loads: Sequence[tuple[Array, History | ReleasedLoad | InitialImpulse]],
        lines: Sequence[tuple[str, Array, float, float]] = (),
        damping: Array | None = None,
    ) -> GapSystem:
        """Return the gap system in modal coordinates.

        Args:
            read: function that returns the row (num_modes,) of a displacement operator.
            omega2, load: ω² and load (num_modes,) of the modes.
            places: x in m and direction of each station.
            observed: outputs of a trajectory, by name.
            loads: further load vectors (num_modes,) with their histories.
            lines: springs to the ground that the modes already include, each (name of its force
                in a trajectory or None, row (num_modes,) of its elongation, stiffness in N/m,
                dashpot in N·s/m). The force is positive in compression.
            damping: damping (num_modes,) in 1/s; zero unless given.
        """

        def stack(rows: Iterable[Array]) -> Array:
            return np.array(list(rows)).reshape(-1, omega2.size)

        def total(kind: type[ReleasedLoad | InitialImpulse]) -> Array:
            pushes = (push for push, when in loads if isinstance(when, kind))
            return sum(pushes, np.zeros(omega2.size))

        observers = {
            name: Observer(read(observer.operator), observer.unit, observer.derivative)
            for name, observer in observed.items()
        }
        observers |= {name: Observer(-k * row, "N") for name, row, k, _ in lines if name}
        return GapSystem(
            omega2=omega2,
            load=load,
            rows=stack(contact.row(read) for contact in self.contacts),
            laws=[contact.law for contact in self.contacts],
            station_of_row=np.array([contact.station for contact in self.contacts], dtype=np.int64),
            stations=[x for x, _ in places],
            observers=observers,
            damping=np.zeros(0) if damping is None else damping,
            dashpots=stack(
                [
                    *(dashpot.row(read) for dashpot in self.dashpots.values()),
                    *(np.sqrt(c) * row for _, row, _, c in lines if c > 0.0),
                ]
            ),
            friction_rows=stack(friction.row(read) for friction in self.frictions),
            frictions=[friction.law for friction in self.frictions],
            excitations=[
                Excitation(push, when)
                for push, when in loads
                if not isinstance(when, ReleasedLoad | InitialImpulse)
            ],
            released_load=total(ReleasedLoad),
            initial_impulse=total(InitialImpulse),
            station_directions=[direction for _, direction in places],
            grounded=self.grounded,
        )

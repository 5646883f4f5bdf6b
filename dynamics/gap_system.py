# SPDX-License-Identifier: LGPL-3.0-or-later
"""Gap system: the common form of all models.

    ä_i + Σ_k C_ik ȧ_k + ω_i² a_i = Q_i + Σ_e Q_ei g_e(t) − Σ_j B_ji F_j(y_j) + Σ_l D_li R_l(ḋ_l)
    y_j = Σ_i B_ji a_i,    d_l = Σ_i D_li a_i,    C = diag(c) + Zᵀ Z

a are mass-normalised modal coordinates of the separate segments, with the circular frequencies ω,
constant modal loads Q, and modal loads Q_e with histories g_e. A contact row B_j gives the relative
displacement y_j = u − w across the play, for the contact force F_j. A friction row D_l gives the
sliding displacement d_l, for the friction force R_l. A dashpot row of Z gives the displacement
whose rate the dashpot resists, c is the damping of single modes. If a boom telescopes, its travels
change the rows over time. At a fixed extension, the stiffness may be K = diag(ω²) − K_G, with the
geometric stiffness K_G of axial forces, until ``in_own_modes`` transforms the system.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, NamedTuple

import numpy as np

from protractile.dynamics.arrays import Array, Indices
from protractile.dynamics.contact import ContactLaw, DryFriction
from protractile.dynamics.excitation import Excitation, is_constant
from protractile.dynamics.second_order import soften_modes
from protractile.dynamics.travel import ROW_KINDS, Travel


class Observer(NamedTuple):
    """Output of a trajectory: a linear function of the modal coordinates.

    >>> Observer(np.ones(1)).unit
    'm'
    """

    row: Array  #: coefficients (num_modes,) of the modal coordinates
    unit: str = "m"  #: unit of the quantity
    #: 0 for coordinates, 1 for velocities, 2 for mean accelerations over the output interval that
    #: ends at the time
    derivative: Literal[0, 1, 2] = 0


@dataclass(frozen=True, slots=True)
class GapSystem:
    """Modal equations of motion with gap contact and dry friction.

    A ball of 1 kg above a springy floor:

    >>> ball = GapSystem(
    ...     omega2=np.zeros(1),
    ...     load=np.array([-9.81]),
    ...     rows=np.ones((1, 1)),
    ...     laws=[pt.PowerContact(1e6, 1.0).lower()],
    ...     station_of_row=np.array([0]),
    ...     stations=[0.0],
    ...     observers={"height": Observer(np.ones(1))},
    ... )
    >>> ball.num_modes, ball.row_masses
    (1, array([1.]))

    Args:
        omega2: (num_modes,) ω² in rad²/s²; exactly 0 for rigid modes, negative if an axial force
            makes a segment unstable.
        load: modal load (num_modes,) in N/√kg, constant from t = 0 on.
        rows: (num_rows, num_modes) contact rows B in 1/√kg.
        laws: contact law of each row.
        station_of_row: (num_rows,) index in ``stations`` of each row.
        stations: x of the stations in m.
        observers: outputs of a trajectory, by name.
        damping: (num_modes,) c = 2ζω in 1/s; zero unless given.
        dashpots: (num_dashpots, num_modes) rows Z in 1/√s; none unless given.
        friction_rows: (num_frictions, num_modes) sliding rows D in 1/√kg; none unless given.
        frictions: friction law of each friction row; with travels, one coefficient at each station.
        excitations: loads that change with time.
        station_directions: direction of the relative displacement at each station; "z" for all
            unless given.
        released_load: modal load (num_modes,) in N/√kg that acts up to t = 0 and is then removed;
            zero unless given.
        initial_impulse: modal impulse (num_modes,) in N·s/√kg at t = 0, for the initial velocity of
            a motion; zero unless given.
        grounded: indices in ``stations`` of stops on the ground.
        travels: extensions of segments over time, and the rows that they change.
        geometric_stiffness: K_G (num_modes, num_modes) of axial forces that ``omega2`` does not
            include, at a fixed extension. Before time integration, :meth:`in_own_modes` includes
            it.
        hung: unit vectors (num_directions, num_modes) of the coordinates of a load on a rope; none
            unless given.

    Raises:
        ValueError: shapes do not agree, or a number is not finite or out of range.
    """

    omega2: Array
    load: Array
    rows: Array
    laws: Sequence[ContactLaw]
    station_of_row: Indices
    stations: Sequence[float]
    observers: Mapping[str, Observer]
    damping: Array = field(default_factory=lambda: np.zeros(0))
    dashpots: Array = field(default_factory=lambda: np.zeros((0, 0)))
    friction_rows: Array = field(default_factory=lambda: np.zeros((0, 0)))
    frictions: Sequence[DryFriction] = ()
    excitations: Sequence[Excitation] = ()
    station_directions: Sequence[str] = ()
    grounded: Sequence[int] = ()
    released_load: Array = field(default_factory=lambda: np.zeros(0))
    initial_impulse: Array = field(default_factory=lambda: np.zeros(0))
    travels: Sequence[Travel] = ()
    geometric_stiffness: Array = field(default_factory=lambda: np.zeros((0, 0)))
    hung: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def __post_init__(self) -> None:
        n, m, places = self.omega2.size, len(self.laws), len(self.stations)
        of_modes = {name: (n,) for name in ("damping", "released_load", "initial_impulse")}
        empty = of_modes | {name: (0, n) for name in ("dashpots", "friction_rows", "hung")}
        for name, zeros in empty.items():
            if getattr(self, name).size == 0:
                object.__setattr__(self, name, np.zeros(zeros))
        if not self.station_directions:
            object.__setattr__(self, "station_directions", ("z",) * places)
        shapes = of_modes | {
            "omega2": (n,),
            "load": (n,),
            "dashpots": (len(self.dashpots), n),
            "geometric_stiffness": (n, n) if self.geometric_stiffness.size else (0, 0),
            "rows": (m, n),
            "station_of_row": (m,),
            "friction_rows": (len(self.frictions), n),
            "hung": (len(self.hung), n),
        }
        arrays = [(name, getattr(self, name), shape) for name, shape in shapes.items()]
        arrays += [(f"excitation {e}", x.load, (n,)) for e, x in enumerate(self.excitations)]
        arrays += [(f"observer {name!r}", one.row, (n,)) for name, one in self.observers.items()]
        for name, array, shape in arrays:
            if array.shape != shape:
                raise ValueError(f"{name} must have the shape {shape}, got {array.shape}")
            if not np.isfinite(array).all():
                raise ValueError(f"{name} must be finite")
        for name in ("station_of_row", "grounded"):
            if any(not 0 <= station < places for station in getattr(self, name)):
                raise ValueError(f"{name} must hold positions in stations")
        if any(not 0 <= friction.station < places for friction in self.frictions):
            raise ValueError("the station of a friction must be a position in stations")
        coefficients: dict[int, float] = {}
        for station, given in ((one.station, one.coefficient) for one in self.frictions):
            if self.travels and coefficients.setdefault(station, given) != given:
                raise ValueError(
                    "the frictions of a station that may telescope must have one coefficient, got "
                    f"{coefficients[station]:g} and {given:g} at {self.stations[station]:g} m"
                )
        if any(not 0 <= row < m for friction in self.frictions for row in friction.normal_rows):
            raise ValueError("normal_rows must hold positions in rows")
        if len(self.station_directions) != places:
            raise ValueError(
                f"station_directions must be one for each of {places} stations, "
                f"got {len(self.station_directions)}"
            )
        if (self.damping < 0.0).any():
            raise ValueError("damping must not be negative")
        for number, travel in enumerate(self.travels):
            if travel.table.coefficients.shape[3] != n:
                raise ValueError(f"the rows of travel {number} must have {n} modes")
            if any(not 0 <= row < len(getattr(self, kind)) for kind, row in travel.moved_rows):
                raise ValueError(f"travel {number} must move rows of the system")

    @property
    def num_modes(self) -> int:
        """The number of modal coordinates."""
        return self.omega2.size

    @property
    def all_rows(self) -> Array:
        """All rows (num_rows, num_modes): contacts, friction rows, dashpots."""
        return np.concatenate([getattr(self, kind) for kind in ROW_KINDS])

    @property
    def stiffness(self) -> Array:
        """The stiffness (num_modes, num_modes) in 1/s²."""
        elastic = np.diag(self.omega2)
        return elastic - self.geometric_stiffness if self.geometric_stiffness.size else elastic

    @property
    def omega(self) -> Array:
        """The circular frequencies ω (num_modes,) in rad/s; 0 for modes that do not oscillate."""
        return np.asarray(np.sqrt(np.maximum(self.omega2, 0.0)))

    @property
    def frequencies(self) -> Array:
        """The natural frequencies (num_modes,) in Hz without contact, in ascending order."""
        return np.sort(self.omega) / (2.0 * np.pi)

    @property
    def row_masses(self) -> Array:
        """The effective mass 1 / (B_j B_jᵀ) in kg of an impact on row B_j, shape (num_rows,)."""
        return np.asarray(1.0 / np.einsum("ij,ij->i", self.rows, self.rows))

    @property
    def largest_load(self) -> Array:
        """The largest modal load |Q| (num_modes,) in N/√kg, including excitations."""
        excited = [np.abs(x.load) * x.history.peak for x in self.excitations]
        return np.asarray(np.sum([np.abs(self.load), *excited], axis=0))

    def load_at(self, time: float | Array) -> Array:
        """Return the modal load (..., num_modes) in N/√kg at times (...) in s.

        The time 0 is before the release.
        """
        time = np.asarray(time)
        changing = (np.multiply.outer(x.history(time), x.load) for x in self.excitations)
        return sum(changing, self.load + np.multiply.outer(time <= 0.0, self.released_load))

    def gather_loads(self) -> GapSystem:
        """Return the system with all constant loads added to ``load``."""
        changing = [x for x in self.excitations if not is_constant(x.history)]
        constant = [
            x.load * x.history(np.zeros(())) for x in self.excitations if is_constant(x.history)
        ]
        load = np.sum([self.load, *constant], axis=0)
        moving = [travel for travel in self.travels if not is_constant(travel.history)]
        return replace(self, load=load, excitations=changing, travels=moving)

    def at_time(self, time: float) -> GapSystem:
        """Return the system with its extensions fixed at a time in s."""
        rows_at = {kind: getattr(self, kind).copy() for kind in ROW_KINDS}
        laws = list(self.laws)
        parts = [self.geometric_stiffness] if self.geometric_stiffness.size else []
        for travel in self.travels:
            extension = float(travel.history(np.array(time)))
            rows = travel.table(extension)
            parts += [force.geometric_stiffness(extension) for force in travel.axial_forces]
            for (kind, position), row in zip(travel.moved_rows, rows, strict=True):
                rows_at[kind][position] = row
            for (_, position), shift in zip(travel.moved_rows, travel.shifts, strict=False):
                laws[position] = laws[position].with_clearance(
                    -shift * extension, shift * extension
                )
        whole = sum(parts, np.zeros(()))
        softening = whole if whole.any() else np.zeros((0, 0))
        return replace(self, **rows_at, laws=laws, travels=(), geometric_stiffness=softening)

    def in_own_modes(self) -> GapSystem:
        """Return the system in the modes of its stiffness, geometric stiffness included."""
        if not self.geometric_stiffness.size:
            return self
        return self.transform(*soften_modes(self.omega2, self.geometric_stiffness))

    def transform(self, omega2: Array, shapes: Array) -> GapSystem:
        """Return the system in other coordinates b, with a = Φ b.

        Args:
            omega2: ω² (num_shapes,) of the new coordinates in rad²/s², which includes K_G.
            shapes: mass-normalised Φ (num_modes, num_shapes).
        """
        return replace(
            self,
            omega2=omega2,
            load=self.load @ shapes,
            rows=self.rows @ shapes,
            observers={
                name: observer._replace(row=observer.row @ shapes)
                for name, observer in self.observers.items()
            },
            damping=np.einsum("ki,k,ki->i", shapes, self.damping, shapes),
            dashpots=self.dashpots @ shapes,
            friction_rows=self.friction_rows @ shapes,
            excitations=[replace(x, load=x.load @ shapes) for x in self.excitations],
            released_load=self.released_load @ shapes,
            initial_impulse=self.initial_impulse @ shapes,
            travels=[travel.transform(shapes) for travel in self.travels],
            geometric_stiffness=np.zeros((0, 0)),
            hung=self.hung @ shapes,
        )

    def extend(self, omega2: Array) -> GapSystem:
        """Return the system with further coordinates, uncoupled, with ω² (num_added,)."""
        number, added = self.num_modes, omega2.size
        wide = self.transform(np.append(self.omega2, omega2), np.eye(number, number + added))
        if not self.geometric_stiffness.size:
            return wide
        return replace(wide, geometric_stiffness=np.pad(self.geometric_stiffness, (0, added)))

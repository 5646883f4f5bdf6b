# SPDX-License-Identifier: LGPL-3.0-or-later
"""Trajectories: deflections, contact forces and energies over time.

A trajectory is an xarray dataset with the energy residual, the error of the energy balance:
kinetic, strain and contact energy and all losses equal the initial energy and the work of loads and
drives.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from numbers import Real
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from protractile.dynamics.arrays import Array
from protractile.dynamics.energy import DRIVEN_ENERGIES, ENERGIES, energy_residual
from protractile.dynamics.gap_system import GapSystem, Observer

# xarray is imported only where it is needed, since the import takes a second.
if TYPE_CHECKING:
    import xarray as xr


Dims = str | tuple[str, str]

# Variables of each station.
_INTERVAL = "the output interval that ends then"
STATION_VARIABLES: Mapping[str, Mapping[str, str]] = {
    "contact_force": {"units": "N", "long_name": f"contact force, mean of {_INTERVAL}"},
    "contact_force_peak": {"units": "N", "long_name": f"largest contact force of {_INTERVAL}"},
    "friction_force": {"units": "N", "long_name": f"friction force, mean of {_INTERVAL}"},
    "gap": {
        "units": "m",
        "long_name": "deflection of the inner less deflection of the outer segment",
    },
}

# Variables of each drive; the suffix of its travel follows each name.
DRIVE_VARIABLES: Mapping[str, Mapping[str, str]] = {
    "extension": {"units": "m", "long_name": "extension since the start"},
    "drive_friction": {"units": "N", "long_name": "drive force against friction, output means"},
    "drive_power": {"units": "W", "long_name": "power of the drive, axial loads included"},
}

# Fraction of the largest deflection below which a peak is round-off.
_ROUND_OFF = 1.0e-6


class Output(NamedTuple):
    """Results (num_outputs, …) at the end of each output interval.

    Args:
        states, velocities: modal coordinates and velocities; velocities may have no columns.
        energies: energies in J, as in ``protractile.dynamics.energy.ENERGIES``.
        gaps: relative displacements y of the contacts in m.
        means, peaks: means and peaks of contact forces within the interval in N.
        frictions: mean friction forces in N.
        drives: cumulative work of the drive of each travel in J.
    """

    states: Array
    velocities: Array
    energies: Array
    gaps: Array
    means: Array
    peaks: Array
    frictions: Array
    drives: Array


@dataclass(frozen=True, slots=True)
class PointwiseDifferences:
    """Pointwise differences of two motions while both are predictable.

    Args:
        until: end of the comparison in s; for ensembles, the earlier of both horizons at the first
            of ``SHARES``.
        largest, rms: largest and root mean square difference, as fractions of the larger of both
            ranges within this time.
    """

    scope: ClassVar[str] = (
        "Shows the difference of the models at every instant up to the common horizon; it does "
        "not show later differences."
    )

    until: float
    largest: float
    rms: float

    @classmethod
    def from_curves(
        cls, first: Array, second: Array, time: Array, until: float
    ) -> PointwiseDifferences:
        """Return the differences of two curves (num_times,) up to ``until``; times are in s."""
        before = time <= until
        apart = np.abs(first - second)[before]
        scale = max(np.ptp(first[before]), np.ptp(second[before]))
        largest, rms = float(apart.max()), float(np.sqrt(np.mean(apart**2)))
        return cls(until, largest / scale if scale else largest, rms / scale if scale else rms)


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Motion of one model.

    >>> motion = simulate(ball, duration=1.0, position=[0.5])
    >>> print(f"{1.0e-3 * float(abs(motion.data['contact_force_peak']).max()):.1f} kN")
    3.1 kN

    Args:
        data: dims ``time`` and ``station``; the output of each observer; ``contact_force`` in N,
            positive if the inner segment presses upwards, the mean over the output interval that
            ends at the time (so that sums are impulses), and the initial value at t = 0;
            ``contact_force_peak``, the maximum in the interval; ``friction_force`` in N, also a
            mean, positive if it acts on the inner segment in the positive sliding direction;
            ``gap`` in m, the mean of u − w over the rows of a station; the energies in J.
            Coordinate ``direction`` (station). Attributes: ``step`` in s, ``steps`` (joined steps
            count as one), ``first_contact`` in s (NaN if none), ``contact_changes``, the number of
            times that contacts open or close, ``energy_residual``.
        states: modal coordinates (num_times, num_modes).
        row_peaks: largest force (num_rows,) of each contact row in N, with its sign; empty if it
            is unknown.
    """

    data: xr.Dataset
    states: Array
    row_peaks: Array = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def record(
        cls,
        system: GapSystem,
        time: Array,
        output: Output,
        attributes: Mapping[str, object],
        energy_floor: float = 0.0,
    ) -> Trajectory:
        """Return the trajectory of an integrator's output; forces are sums over each station.

        Args:
            time: (num_times,) in s.
            output: output at these times.
            attributes: attributes of the data, which include ``step``, ``steps``,
                ``first_contact`` and ``contact_changes``.
            energy_floor: least input energy in J, as in :func:`.dynamics.energy.energy_residual`.
        """
        stations = np.arange(len(system.stations))
        at_station = np.equal.outer(system.station_of_row, stations)
        friction_at = np.equal.outer([friction.station for friction in system.frictions], stations)
        rows_at = np.maximum(at_station.sum(axis=0), 1)
        # Peaks of rows on the same side coincide, peaks on opposite sides do not.
        up, down = (extreme(output.peaks, 0.0) @ at_station for extreme in (np.maximum, np.minimum))

        def read(seen: Observer) -> Array:
            values = (output.velocities if seen.derivative else output.states) @ seen.row
            if seen.derivative < 2:
                return values
            return np.concatenate([[0.0], np.diff(values) / np.diff(time)])

        variables: dict[str, tuple[Dims, Array, dict[str, str]]] = {
            name: ("time", read(seen), {"units": seen.unit})
            for name, seen in system.observers.items()
        }
        by_station = {
            "contact_force": output.means @ at_station,
            "contact_force_peak": np.where(up >= -down, up, down),
            "friction_force": output.frictions @ friction_at,
            "gap": output.gaps @ at_station / rows_at,
        }
        variables |= {
            name: (("time", "station"), values, {**STATION_VARIABLES[name]})
            for name, values in by_station.items()
        }
        variables |= {
            name: ("time", column, {"units": "J", "long_name": name.replace("_", " ")})
            for name, column in zip(DRIVEN_ENERGIES, output.energies.T, strict=False)
        }
        import xarray as xr

        data = xr.Dataset(
            variables,
            coords={
                "time": ("time", time, {"units": "s", "long_name": "time"}),
                "station": (
                    "station",
                    np.array(system.stations, dtype=float),
                    {"units": "m", "long_name": "x of the station"},
                ),
                "direction": ("station", np.array(system.station_directions, dtype=str)),
            },
            attrs=dict(attributes),
        )
        residual = energy_residual(output.energies, energy_floor)
        data.attrs["energy_residual"] = float(np.abs(residual).max())
        high, low = output.peaks.max(axis=0), output.peaks.min(axis=0)
        return cls(data, output.states, np.where(high >= -low, high, low))

    @classmethod
    def from_states(
        cls, system: GapSystem, time: Array, states: Array, velocities: Array
    ) -> Trajectory:
        """Return the trajectory of the states of a user-defined integrator, without losses.

        Forces are values at output times; the time of the first contact is accurate to an output
        step.

        Args:
            system: gap system with constant loads only, all in ``load``.
            time: (num_times,) in s, evenly spaced.
            states, velocities: (num_times, num_modes) a and ȧ.
        """
        gaps = states @ system.rows.T
        forces = np.zeros(gaps.shape)
        energies = np.zeros((time.size, len(ENERGIES)))
        energies[:, 0] = 0.5 * (velocities**2).sum(axis=1)
        energies[:, 1] = 0.5 * states**2 @ system.omega2
        energies[:, 3] = (states - states[0]) @ system.load
        for row, law in enumerate(system.laws):
            forces[:, row] = law.force(gaps[:, row])
            energies[:, 2] += law.energy(gaps[:, row])
        closed = forces != 0.0
        touching = closed.any(axis=1)
        none = np.zeros((time.size, 0))
        return cls.record(
            system,
            time,
            Output(states, velocities, energies, gaps, forces, forces, none, none),
            {
                "step": float(time[1] - time[0]),
                "steps": time.size - 1,
                "first_contact": float(time[np.argmax(touching)]) if touching.any() else np.nan,
                "contact_changes": int(np.count_nonzero(np.diff(closed, axis=0))),
            },
        )

    @property
    def time(self) -> Array:
        """The times (num_times,) in s."""
        return np.asarray(self.data["time"].values)

    @property
    def tip(self) -> xr.DataArray:
        """The deflection (time,) of the tip in m, with the method ``plot()``."""
        return self.data["tip"]

    @property
    def energy_residual(self) -> float:
        """The largest error of the energy balance as a fraction of the input energy."""
        return float(self.data.attrs["energy_residual"])

    @property
    def first_contact(self) -> float:
        """The time of the first contact in s; NaN without contact."""
        return float(self.data.attrs["first_contact"])

    def first_peak(self, observer: str = "tip") -> tuple[float, float]:
        """Return the time in s and the value of the first prominent peak in the initial direction.

        The prominence of a peak is at least a fifth of the whole range, which excludes the ripple
        of micro-impacts. Both values are NaN without a peak.
        """
        deflection = self._values(observer)
        prominence = 0.2 * float(np.ptp(deflection))
        off = deflection - deflection[0]
        side = np.sign(off[np.argmax(np.abs(off) > prominence)])
        peak = _first_prominent(side * deflection, prominence)
        if peak is None or prominence < _ROUND_OFF * np.abs(deflection).max():
            return float("nan"), float("nan")
        return float(self.time[peak]), float(deflection[peak])

    def compare(
        self, other: Trajectory, name: str = "tip", until: float = np.inf
    ) -> PointwiseDifferences:
        """Return the pointwise differences from another motion.

        >>> fine, coarse = (pt.BeamElements(boom, element_length=l) for l in (0.5, 1.0))
        >>> print(f"{100.0 * fine.simulate(0.1).compare(coarse.simulate(0.1)).largest:.1f} %")
        1.1 %

        Args:
            other: trajectory at the same times.
            name: name of the compared output.
            until: end of the comparison in s, for example the horizon of both.

        Raises:
            ValueError: the times differ, or the comparison ends before they begin.
        """
        if not isinstance(other, Trajectory):
            raise ValueError(f"other must be a Trajectory, got {other!r}")
        if not np.array_equal(self.time, other.time):
            raise ValueError("the motions must have the same times")
        if not (isinstance(until, Real) and until > self.time[0]):
            raise ValueError(f"until must be after the first time, got {until!r} s")
        first, second = (motion._values(name) for motion in (self, other))
        return PointwiseDifferences.from_curves(
            first, second, self.time, float(min(until, self.time[-1]))
        )

    def _values(self, name: str) -> Array:
        if not (isinstance(name, str) and name in self.data):
            known = ", ".join(map(str, self.data))
            raise ValueError(f"the motion has no output {name!r}; it has {known}")
        return np.asarray(self.data[name].values)


def prominent_peaks(values: Array, prominence: float) -> list[int]:
    """Return the indices of all peaks with at least this prominence.

    They are the peaks of ``scipy.signal.find_peaks``, whose import takes half a second.
    """
    peaks: list[int] = []
    begin = 0
    while (peak := _first_prominent(values[begin:], prominence)) is not None:
        peaks.append(begin + peak)
        begin += peak + 1
    return peaks


def _first_prominent(values: Array, prominence: float) -> int | None:
    """Return the index of the first peak with at least this prominence, or None."""
    if prominence == 0.0 or values.size == 0:
        return None
    risen = values - np.minimum.accumulate(values) >= prominence
    if not risen.any():
        return None
    start = int(risen.argmax())
    after = values[start:]
    fallen = np.maximum.accumulate(after) - after >= prominence
    return start + int(after[: fallen.argmax()].argmax()) if fallen.any() else None

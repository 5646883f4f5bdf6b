# SPDX-License-Identifier: LGPL-3.0-or-later
"""States: positions of a model at some times, at rest or in motion."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np

from protractile.analysis.equilibria import equilibria, instants
from protractile.analysis.model import AnalysisModel
from protractile.analysis.stresses import Fibres
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.line import LineQuantity
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.arrays import Array, Indices
from protractile.geometry.boom import Boom

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class States:
    """Positions of a model at some times."""

    model: AnalysisModel  #: the model under all constant loads
    time: Array  #: times (num_states,) in s of the loads and of the extensions
    positions: Array  #: modal coordinates (num_states, num_modes)
    #: output of a motion, with forces that are means and peaks over output intervals; None at rest
    recorded: xr.Dataset | None = None
    #: largest force (num_rows,) of each contact row of a motion in N; empty at rest
    row_peaks: Array = field(default_factory=lambda: np.zeros(0))

    @classmethod
    def of(cls, model: AnalysisModel, rests: Mapping[float, Array]) -> Self:
        """Return static states from equilibria (num_modes,) by time in s."""
        shape = (-1, model.system.num_modes)
        return cls(model, np.array([*rests]), np.array([*rests.values()]).reshape(shape))

    @classmethod
    def at_rest(cls, model: AnalysisModel, duration: float) -> Self:
        """Return the static states of a model at t = 0 and under extreme loads.

        ``duration`` in s is that of the histories of the loads.

        Raises:
            NumericsError: the boom has no equilibrium at t = 0.
        """
        rests = equilibria(model.system, instants(model.system, duration))
        if not rests:
            raise NumericsError("the boom has no static equilibrium under the loads at t = 0")
        return cls.of(model, rests)

    @classmethod
    def in_motion(cls, model: AnalysisModel, trajectory: Trajectory) -> Self:
        """Return the states of a motion."""
        recorded = trajectory.data, trajectory.row_peaks
        return cls(model, trajectory.time, trajectory.states, *recorded)

    @property
    def boom(self) -> Boom:
        """The boom of the model."""
        return self.model.boom

    def observed(self, name: str) -> Array:
        """Return the values (num_states,) of an observer of the model."""
        if self.recorded is not None:
            return np.asarray(self.recorded[name].values)
        return np.asarray(self.positions @ self.model.system.observers[name].row)

    def section_forces(self, number: int) -> dict[LineQuantity, Array]:
        """Return deflections and section forces (num_states, num_places) of a segment."""
        return self.model.section_forces(number, self.positions, self.time)

    def at(self, steps: Indices | list[int]) -> States:
        """Return the states at some steps, whose forces are those of the positions."""
        return States(self.model, self.time[steps], self.positions[steps])

    @cached_property
    def farthest(self) -> States:
        """The state with the largest tip deflection, in space that of both directions."""
        names = [name for name in ("tip", "tip_lateral") if name in self.model.system.observers]
        return self.at([int(np.linalg.norm([*map(self.observed, names)], axis=0).argmax())])

    def largest(self, name: str) -> States:
        """Return the one state in which an observer has its largest magnitude."""
        return self.at([int(np.abs(self.observed(name)).argmax())])

    @property
    def at_extremes(self) -> States:
        """The first state, and those with an extreme observer, contact or stress."""
        system = self.model.system
        rows = [system.rows, *(observer.row[None] for observer in system.observers.values())]
        curves = [self.positions @ np.vstack(rows).T]
        for number, (segment, line) in enumerate(
            zip(self.boom.segments, self.model.lines, strict=True)
        ):
            if (fibres := Fibres.of(segment, line)) is not None:
                forces = self.section_forces(number)
                stresses = (fibres.stress(fibre, forces) for fibre in range(len(fibres.z)))
                curves += [np.abs(stress).max(axis=1, keepdims=True) for stress in stresses]
        every = np.hstack(curves)
        return self.at(np.unique([0, *every.argmax(axis=0), *every.argmin(axis=0)]))

    def __add__(self, other: States) -> States:
        """Return these states, then those of another time of the same model."""
        time = np.concatenate([self.time, other.time])
        return States(self.model, time, np.concatenate([self.positions, other.positions]))

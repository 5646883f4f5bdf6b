# SPDX-License-Identifier: LGPL-3.0-or-later
"""Curves: static diagrams, envelopes, mode shapes, and histories of stresses, as one dataset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

from protractile.analysis.labelled import Labelled
from protractile.analysis.states import States
from protractile.dynamics.line import LineQuantity
from protractile.geometry.arrays import Array

if TYPE_CHECKING:
    import xarray as xr

#: Labels of the envelopes of a motion.
LOW, HIGH = "minimum", "maximum"
#: Label of the stresses of a shell near a place, over time.
HISTORY = "history"

# Number of intervals of a history.
_INTERVALS = 80

_UNITS: Mapping[str, str] = {
    "deflection": "m", "lateral": "m", "twist": "rad", "normal": "N", "shear": "N",
    "lateral_shear": "N", "moment": "N m", "lateral_moment": "N m", "torque": "N m",
    "von_mises": "Pa", "von_mises_patch": "Pa",
}  # fmt: skip


class Curve(NamedTuple):
    """Deflections and section forces along a segment, or stresses of a shell over time."""

    model: str  #: name of the model
    #: label of static states, :data:`LOW` or :data:`HIGH` of a motion, number of a mode, or
    #: :data:`HISTORY`
    state: str
    play: bool  #: False for the boom without play
    segment: str  #: name of the segment
    time: float  #: time of a static state in s; NaN for others
    #: positions (num_points,) in m, where a position with a jump occurs twice; of a history, times
    #: in s
    x: Array
    #: quantities (num_points,) in SI units: those of :data:`.dynamics.line.LineQuantity`, of a mode
    #: with a maximum of 1 m or 1 rad of its dominant motion; of a history the largest ``von_mises``
    #: of triangles and ``von_mises_patch`` of patches
    values: Mapping[str, Array]
    place: float = np.nan  #: position of a history in m; NaN for others


class Curves(Labelled[Curve]):
    """Curves of a run."""

    __slots__ = ()

    @property
    def dataset(self) -> xr.Dataset:
        """The curves in one dataset of all their points.

        Dimension ``curve`` has the labels and the number of points of each curve, ``point`` the
        points of all curves one after another (contiguous ragged arrays of the CF conventions).
        """
        import xarray as xr

        if not self:
            # netCDF 3 has no empty dimensions.
            return xr.Dataset()
        names = [name for name in _UNITS if any(name in curve.values for curve in self)]
        labels = ("model", "state", "segment")
        variables = {
            name: ("curve", np.array([getattr(curve, name) for curve in self], dtype=str))
            for name in labels
        } | {
            "play": ("curve", np.array([curve.play for curve in self], dtype=np.int8)),
            "time": ("curve", np.array([curve.time for curve in self]), {"units": "s"}),
            "place": ("curve", np.array([curve.place for curve in self]), {"units": "m"}),
            "count": (
                "curve",
                np.array([curve.x.size for curve in self], dtype=np.int32),
                {"sample_dimension": "point"},
            ),
            "x": ("point", np.concatenate([curve.x for curve in self]), {"units": "m, or s"}),
        }
        for name in names:
            parts = [curve.values.get(name, np.full(curve.x.size, np.nan)) for curve in self]
            variables[name] = ("point", np.concatenate(parts), {"units": _UNITS[name]})
        return xr.Dataset(variables)

    @classmethod
    def of(cls, dataset: xr.Dataset) -> Self:
        """Return the curves of a dataset as that of :attr:`dataset`.

        Raises:
            ValueError, KeyError: the dataset is damaged.
        """
        if not dataset.variables:
            return cls()
        ends = np.cumsum(dataset["count"].values)
        if ends[-1] != dataset.sizes["point"]:
            raise ValueError("the points are not those of the curves")
        x = np.split(dataset["x"].values, ends[:-1])
        points = {
            name: np.split(dataset[name].values, ends[:-1]) for name in _UNITS if name in dataset
        }
        names = "model", "state", "play", "segment", "time", "place"
        columns = zip(*(dataset[name].values.tolist() for name in names), strict=True)
        return cls(
            Curve(model, state, bool(play), segment, time, x[number], {
                name: values[number]
                for name, values in points.items()
                if not np.isnan(values[number]).all()
            }, place)
            for number, (model, state, play, segment, time, place) in enumerate(columns)
        )  # fmt: skip


def diagrams(states: States, model: str, state: str, play: bool = True) -> Iterator[Curve]:
    """Yield deflections and section forces of each segment in each static state."""
    for number, (segment, line) in enumerate(
        zip(states.boom.segments, states.model.lines, strict=True)
    ):
        curves = states.section_forces(number)
        for step, time in enumerate(states.time.tolist()):
            values = {
                str(name): np.broadcast_to(of[step], line.x.shape) for name, of in curves.items()
            }
            yield Curve(model, state, play, segment.name, time, line.x, values)


def envelope(
    segment: str, x: Array, curves: Mapping[LineQuantity, Array], model: str, play: bool
) -> Iterator[Curve]:
    """Yield the smallest and the largest values of a segment's curves (num_times, num_places)."""
    for state, limit in ((LOW, np.min), (HIGH, np.max)):
        values = {
            str(name): np.broadcast_to(limit(of, axis=0), x.shape) for name, of in curves.items()
        }
        yield Curve(model, state, play, segment, np.nan, x, values)


def histories(stresses: xr.Dataset, model: str) -> Iterator[Curve]:
    """Yield the largest stresses of a shell in intervals of a run, for each segment and place.

    The stresses are those of :func:`.shell_model.stress.history.stress_near_places`.
    """
    time = stresses["time"].values
    parts = np.array_split(np.arange(time.size), min(_INTERVALS, time.size))
    middles = np.array([time[part].mean() for part in parts])
    names = "von_mises", "von_mises_patch"
    for segment, place in product(stresses["segment"].values, stresses["place"].values):
        here = stresses.sel(segment=segment, place=place)
        # A segment without triangles near the place has no stress.
        if not here["von_mises"].isnull().any():
            values = {
                name: np.array([here[name].values[part].max() for part in parts]) for name in names
            }
            yield Curve(model, HISTORY, True, str(segment), np.nan, middles, values, float(place))

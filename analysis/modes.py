# SPDX-License-Identifier: LGPL-3.0-or-later
"""Vibration modes of the boom about a static state, with each closed contact as a spring."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from protractile.analysis.curves import Curve
from protractile.analysis.model import AnalysisModel
from protractile.analysis.rows import INITIAL, Row
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.line import LineQuantity
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Segment

# Number of modes of each model.
MODES = 8

# Number of points of a segment at which mode shapes are compared and stored.
_PLACES = 21

#: Kinds of motion in a mode, with their names.
MOTIONS: Mapping[LineQuantity, str] = {
    "deflection": "bending in z",
    "lateral": "bending in y",
    "twist": "twist",
}

# Modes match if the modal assurance criterion is at least this (Allemang 2003).
MIN_ASSURANCE = 0.5


@dataclass(frozen=True, slots=True)
class Mode:
    """Mode of the boom with the contacts that are closed in the static state."""

    frequency: float  #: frequency in Hz
    motion: str  #: dominant motion, ``bending in z``, ``bending in y`` or ``twist``
    number: int  #: number among the modes of the model with this dominant motion, from 1 on
    share: float  #: fraction of the kinetic energy in the dominant motion, from 0 to 1
    #: shapes (num_places,) of each segment, ``deflection``, in space ``lateral`` and ``twist``;
    #: the dominant motion has a maximum of 1 m or 1 rad
    shapes: list[Mapping[LineQuantity, Array]]


@dataclass(frozen=True, slots=True)
class Match:
    """Mode of another model that matches a mode of the reference."""

    number: int  #: number of the mode in the other model, from 1 on
    frequency: float  #: frequency in Hz
    off: float  #: relative difference from the frequency of the reference
    alike: float  #: modal assurance criterion of both shapes, from 0 to 1


@dataclass(frozen=True, slots=True)
class ModeComparison:
    """Comparison of the modes of all models with the modes of a reference."""

    reference: str  #: name of the reference model
    #: for each other model with play, the mode that matches each mode of the reference; None
    #: without a match
    matches: dict[str, list[Match | None]]


def modes(model: AnalysisModel, rest: Array) -> list[Mode]:
    """Return the first modes, in ascending order of frequency.

    The dominant motion of a mode has the largest share of the kinetic energy, in which rotary
    inertia and point masses are neglected. The equilibrium is (num_modes,).
    """
    boom, system, lines = model.boom, model.system, model.lines
    omega, shapes = closed_contact_modes(system, rest)
    motions: list[LineQuantity] = [name for name in MOTIONS if name in lines[0].rows]
    even = [np.linspace(line.x[0], line.x[-1], _PLACES) for line in lines]
    modes_of_boom: list[Mode] = []
    for frequency, shape in zip(omega[:MODES] / (2.0 * np.pi), shapes.T, strict=False):
        curves = [
            {name: np.interp(x, line.x, line.read(shape)[name]) for name in motions}
            for x, line in zip(even, lines, strict=True)
        ]
        energies = {
            name: sum(
                inertia(segment, name) * segment.length * float((of[name] ** 2).mean())
                for segment, of in zip(boom.segments, curves, strict=True)
            )
            for name in motions
        }
        motion, whole = max(motions, key=lambda name: energies[name]), sum(energies.values())
        most = np.concatenate([of[motion] for of in curves])
        scale = 1.0 / float(most[np.abs(most).argmax()] or 1.0)
        modes_of_boom.append(
            Mode(
                frequency=float(frequency),
                motion=MOTIONS[motion],
                number=1 + sum(mode.motion == MOTIONS[motion] for mode in modes_of_boom),
                share=energies[motion] / whole if whole else 0.0,
                shapes=[{name: scale * curve for name, curve in of.items()} for of in curves],
            )
        )
    return modes_of_boom


def inertia(segment: Segment, motion: LineQuantity) -> float:
    """Return the mass per length in kg/m, or for twist the rotary inertia per length in kg·m."""
    if motion != "twist":
        return segment.mass_per_length
    assert segment.lateral is not None
    return segment.lateral.polar_inertia


def match_modes(boom: Boom, reference: Sequence[Mode], other: Sequence[Mode]) -> list[Match | None]:
    """Return the best match in another model for each mode of the reference; None without a match.

    No mode matches twice. The criterion is the modal assurance criterion (Allemang 2003) of the
    deflections and twists along the segments, weighted by inertia.
    """
    here, there = (
        np.array([_weighted_shape(boom, mode) for mode in of]) for of in (reference, other)
    )
    if not (here.size and there.size):
        return [None for _ in reference]
    lengths = np.outer(np.linalg.norm(here, axis=1), np.linalg.norm(there, axis=1))
    alike = (here @ there.T / np.maximum(lengths, np.finfo(float).tiny)) ** 2
    matches: list[Match | None] = []
    left = alike.copy()
    for number, mode in enumerate(reference):
        k = int(left[number].argmax())
        if left[number, k] < MIN_ASSURANCE:
            matches.append(None)
            continue
        off = other[k].frequency / mode.frequency - 1.0
        matches.append(Match(k + 1, other[k].frequency, off, float(alike[number, k])))
        left[:, k] = -1.0
    return matches


def _weighted_shape(boom: Boom, mode: Mode) -> Array:
    """Return the mass-weighted mode shape (num_values,) in √kg·m."""
    parts = [
        np.sqrt(inertia(segment, name) * segment.length / _PLACES) * shape[name]
        for segment, shape in zip(boom.segments, mode.shapes, strict=True)
        for name in MOTIONS
        if name in shape
    ]
    return np.concatenate(parts)


def mode_rows(modes: Sequence[Mode], model: str, play: bool = True) -> Iterator[Row]:
    """Yield the frequency of each mode, whose place is its dominant motion and number."""
    for mode in modes:
        yield Row(
            model, INITIAL, play, "frequency", mode.motion, str(mode.number), mode.frequency
        )  # fmt: skip


def mode_curves(boom: Boom, modes: Sequence[Mode], model: str) -> Iterator[Curve]:
    """Yield the shapes of each mode along the segments; the states are the numbers of the modes."""
    for number, mode in enumerate(modes, start=1):
        for segment, shape in zip(boom.segments, mode.shapes, strict=True):
            x = np.linspace(segment.start, segment.end, _PLACES)
            values = {str(name): along for name, along in shape.items()}
            yield Curve(model, f"mode {number}", True, segment.name, np.nan, x, values)

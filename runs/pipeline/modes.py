# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modes of the boom linearised at rest: each closed contact is a spring, in all models alike."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dynamics.damping import pressed_modes
from dynamics.gap_system import GapSystem
from dynamics.line import Line, Quantity
from geometry.arrays import Array
from geometry.boom import Boom, Segment
from runs.pipeline.section_forces import rounded

# Number of modes of each model.
MODES = 8

# Number of places per segment at which shapes are compared and stored.
_PLACES = 21

# The kinds of motion in a mode, and their names.
_MOTIONS: Mapping[Quantity, str] = {
    "deflection": "bending in z",
    "lateral": "bending in y",
    "twist": "twist",
}

# Modes with a smaller criterion are different modes (Allemang 2003).
ALIKE = 0.5


@dataclass(frozen=True, slots=True)
class Shape:
    """Shape of a segment in a mode: at x in m ``deflection``, in space ``lateral``, ``twist``."""

    segment: str
    x: list[float]
    curves: dict[str, list[float]]


@dataclass(frozen=True, slots=True)
class Mode:
    """A mode of the boom with the contacts that are closed at rest.

    Args:
        frequency: in Hz.
        motion: the dominant one: ``bending in z``, ``bending in y``, ``twist``.
        number: position among the model's modes with this dominant motion, from 1 on.
        share: part of the dominant motion in the kinetic energy, from 0 to 1.
        shapes: mode shapes of each segment; the dominant motion has a maximum of 1 m or 1 rad.
    """

    frequency: float
    motion: str
    number: int
    share: float
    shapes: list[Shape]


@dataclass(frozen=True, slots=True)
class Match:
    """A mode of another model that matches one of the reference.

    Args:
        number: number among the other model's modes, from 1 on.
        frequency: in Hz.
        off: relative difference from the reference's.
        alike: modal assurance criterion of both shapes, from 0 to 1.
    """

    number: int
    frequency: float
    off: float
    alike: float


@dataclass(frozen=True, slots=True)
class ModeComparison:
    """The modes of all models beside those of a reference.

    Args:
        reference: name of the model.
        matches: modes of each other model with play, for each mode of the reference; None without
            a match.
    """

    reference: str
    matches: dict[str, list[Match | None]]


def modes(boom: Boom, system: GapSystem, lines: Sequence[Line], rest: Array) -> list[Mode]:
    """Return the first modes, by rising frequency.

    A mode's motion has the largest part of the kinetic energy, without rotary inertia of
    cross-sections and without point masses.

    Args:
        boom: the boom of the lines.
        system: that of the model.
        lines: those along its segments.
        rest: equilibrium (num_modes,).
    """
    omega, shapes = pressed_modes(system, rest)
    motions: list[Quantity] = [name for name in _MOTIONS if name in lines[0].rows]
    even = [np.linspace(line.x[0], line.x[-1], _PLACES) for line in lines]
    found: list[Mode] = []
    for frequency, shape in zip(omega[:MODES] / (2.0 * np.pi), shapes.T, strict=False):
        curves = [
            {name: np.interp(x, line.x, line.rows[name] @ shape) for name in motions}
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
        found.append(
            Mode(
                frequency=float(frequency),
                motion=_MOTIONS[motion],
                number=1 + sum(mode.motion == _MOTIONS[motion] for mode in found),
                share=energies[motion] / whole if whole else 0.0,
                shapes=[
                    Shape(
                        segment.name,
                        rounded(np.linspace(segment.start, segment.end, _PLACES)),
                        {name: rounded(scale * curve) for name, curve in of.items()},
                    )
                    for segment, of in zip(boom.segments, curves, strict=True)
                ],
            )
        )
    return found


def inertia(segment: Segment, motion: Quantity) -> float:
    """Return the mass per length in kg/m, or the rotary inertia per length in kg·m of a twist."""
    if motion != "twist":
        return segment.mass_per_length
    assert segment.lateral is not None
    return segment.lateral.polar_inertia


def matched(boom: Boom, reference: Sequence[Mode], other: Sequence[Mode]) -> list[Match | None]:
    """Return for each mode of a reference the best match of another model, each once; else None.

    The match is by the modal assurance criterion of the deflections and twists along the segments,
    each weighted by its inertia (Allemang 2003).

    Args:
        boom: that of both models.
        reference, other: their modes.
    """
    here, there = (np.array([_vector(boom, mode) for mode in of]) for of in (reference, other))
    if not (here.size and there.size):
        return [None for _ in reference]
    lengths = np.outer(np.linalg.norm(here, axis=1), np.linalg.norm(there, axis=1))
    alike = (here @ there.T / np.maximum(lengths, np.finfo(float).tiny)) ** 2
    found: list[Match | None] = []
    left = alike.copy()
    for number, mode in enumerate(reference):
        k = int(left[number].argmax())
        if left[number, k] < ALIKE:
            found.append(None)
            continue
        off = other[k].frequency / mode.frequency - 1.0
        found.append(Match(k + 1, other[k].frequency, off, float(alike[number, k])))
        left[:, k] = -1.0
    return found


def _vector(boom: Boom, mode: Mode) -> Array:
    """Return the mass-weighted shape in √kg·m."""
    parts = [
        np.sqrt(inertia(segment, name) * segment.length / _PLACES) * np.array(shape.curves[name])
        for segment, shape in zip(boom.segments, mode.shapes, strict=True)
        for name in _MOTIONS
        if name in shape.curves
    ]
    return np.concatenate(parts)

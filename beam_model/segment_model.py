# SPDX-License-Identifier: LGPL-3.0-or-later
"""A segment as a beam in finitely many coordinates, and its way to modal ones.

Kantorovich series and beam finite elements both end here; from here on they are the same.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.linalg import block_diag, eigh, null_space

from dynamics.contact import PowerContact
from dynamics.gap_system import GapSystem, Observer
from geometry.boom import Boom, Joint

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SegmentModel:
    """M q̈ + C q̇ + K q = f, with a rule that reads the deflection anywhere.

    Args:
        stiffness, mass, damping: (num_dofs, num_dofs).
        load: (num_dofs,).
        deflection: x in m → (num_dofs,) row that reads the deflection there.
        rigid_modes: how many motions the supports leave free of strain.
    """

    stiffness: Array
    mass: Array
    damping: Array
    load: Array
    deflection: Callable[[float], Array]
    rigid_modes: int


@dataclass(frozen=True, slots=True)
class Modes:
    """Mass-normalised modes: ω² in rad²/s², rising, and the shapes (num_dofs, num_modes)."""

    omega2: Array
    shapes: Array


def natural_modes(stiffness: Array, mass: Array, rigid_modes: int) -> Modes:
    """All natural modes of (K, M), rigid ones with ω² exactly 0."""
    # A common scale per coordinate: rotations and deflections differ by orders of magnitude.
    scale = 1.0 / np.sqrt(np.diag(mass))
    omega2, shapes = eigh(stiffness * np.outer(scale, scale), mass * np.outer(scale, scale))
    omega2[:rigid_modes] = 0.0
    return Modes(omega2, shapes * scale[:, None])


def gap_system(
    boom: Boom, models: Sequence[SegmentModel], laws: Sequence[PowerContact]
) -> GapSystem:
    """Segments side by side in modal coordinates, coupled by contact alone.

    Args:
        boom: where the joints are.
        models: one for each segment.
        laws: one for each joint.
    """
    modes = [natural_modes(m.stiffness, m.mass, m.rigid_modes) for m in models]
    shapes = block_diag(*(mode.shapes for mode in modes))
    contacts = [
        (_relative(boom, models, joint, x) @ shapes, x, law)
        for joint, law in zip(boom.joints, laws, strict=True)
        for x in joint.stations
    ]
    return GapSystem(
        omega2=np.concatenate([mode.omega2 for mode in modes]),
        load=np.concatenate([m.load for m in models]) @ shapes,
        rows=np.array([row for row, _, _ in contacts]).reshape(-1, shapes.shape[1]),
        laws=[law for _, _, law in contacts],
        station_of_row=np.arange(len(contacts)),
        stations=[x for _, x, _ in contacts],
        observers=_observers(boom, models, shapes),
        damping=_modal_damping(models, shapes),
    )


def tied_system(boom: Boom, models: Sequence[SegmentModel]) -> GapSystem:
    """The play-free boom: every joint's segments deflect alike at its stations."""
    ties = np.array(
        [_relative(boom, models, joint, x) for joint in boom.joints for x in joint.stations]
    )
    stiffness = block_diag(*(m.stiffness for m in models))
    free = null_space(ties) if ties.size else np.eye(len(stiffness))
    rigid = max(0, sum(m.rigid_modes for m in models) - len(ties))
    mass = block_diag(*(m.mass for m in models))
    modes = natural_modes(free.T @ stiffness @ free, free.T @ mass @ free, rigid)
    shapes = free @ modes.shapes
    return GapSystem(
        omega2=modes.omega2,
        load=np.concatenate([m.load for m in models]) @ shapes,
        rows=np.zeros((0, modes.omega2.size)),
        laws=[],
        station_of_row=np.zeros(0, dtype=np.int64),
        stations=[],
        observers=_observers(boom, models, shapes),
        damping=_modal_damping(models, shapes),
    )


def _place(models: Sequence[SegmentModel], segment: int, x: float) -> Array:
    """Row over all coordinates that reads one segment's deflection at x."""
    rows = [np.zeros(len(m.load)) for m in models]
    rows[segment] = models[segment].deflection(x)
    return np.concatenate(rows)


def _relative(boom: Boom, models: Sequence[SegmentModel], joint: Joint, x: float) -> Array:
    """Row over all coordinates that reads u − w at x."""
    return _place(models, joint.inner, x) - _place(models, joint.outer, x)


def _observers(boom: Boom, models: Sequence[SegmentModel], shapes: Array) -> dict[str, Observer]:
    return {
        name: Observer(_place(models, segment, x) @ shapes)
        for name, (segment, x) in boom.observed().items()
    }


def _modal_damping(models: Sequence[SegmentModel], shapes: Array) -> Array:
    """Diagonal of the modal damping matrix: exact where damping is proportional to mass."""
    damping = block_diag(*(m.damping for m in models))
    return np.asarray(np.einsum("ki,kl,li->i", shapes, damping, shapes, optimize=True))

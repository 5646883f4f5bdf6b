# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static and dynamic forces and pressures of slide pads."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

import numpy as np

from protractile.dynamics.contact import ContactLaw
from protractile.geometry.arrays import Array
from protractile.geometry.contact_places import ContactPair
from protractile.geometry.joint import PADS_OF_SIDE, SIDES, Pad, PadSide
from protractile.geometry.section import EACH_SIDE, Offset, Side
from protractile.geometry.station import Station

# Name of each side, by direction.
_SIDE_NAMES = {on: side for side, on in SIDES.items()}


def largest_force(station: Station, pushes: Array, net: bool) -> tuple[str, float]:
    """Return the name of the governing pads of a station without ``pads``, and the force in N on
    both of the pair.

    The forces ``pushes`` are those of a side, negative for side −1, or the ``net`` forces of both
    sides.
    """
    largest = max(pushes, key=abs)
    force = abs(float(largest))
    if net:
        # Without preload by shims, one side carries the net force alone.
        sides = [station.law.one_sided(side) for side in EACH_SIDE]
        preloads = [float(abs(law.force(np.zeros(())))) for law in sides if law]
        force = max(force, max(preloads) + 0.5 * force)
    return _SIDE_NAMES[station.direction, 1 if largest > 0.0 else -1], force


def _name(side: PadSide, before: int) -> str:
    """Return the name of a pad within its station: its side, and its number if not the first."""
    return f"{side} {1 + before}" if before else side


def loaded_pads(station: Station, sides: Sequence[Array]) -> Iterator[tuple[Pad, str, Array]]:
    """Yield the pads of known size at a station, each with its name and forces (num_states,) in N.

    ``sides`` are the forces (num_states,) on the two sides in N, in the order of ``EACH_SIDE``, not
    negative.
    """
    joint = station.joint
    if joint is None or not joint.padded:
        return
    for side, force in zip(EACH_SIDE, sides, strict=True):
        # Pairs with thicker shims close first.
        pairs = joint.pads_of(station.direction, side)
        order = sorted(range(len(pairs)), key=lambda k: -pairs[k][2])
        pairs = [pairs[k] for k in order]
        shares, shims = (np.array([pair[k] for pair in pairs]) for k in (1, 2))
        stiffnesses = [pad.stiffness for pad in station.pads if SIDES[pad.side][1] == side]
        stiffness = PADS_OF_SIDE * sum(stiffnesses) or 1.0
        # Each pair that closes reduces the compression of the pairs that closed before.
        closing = force[:, None] / stiffness - np.cumsum(shares * shims)
        compression = (closing / np.cumsum(shares)).min(axis=1, keepdims=True)
        forces = stiffness * (shares * np.maximum(compression + shims, 0.0)) / PADS_OF_SIDE
        for number, (pad, *_), of_pad in sorted(
            zip(order, pairs, forces.T, strict=True), key=lambda entry: entry[0]
        ):
            if pad is not None:
                yield pad, _name(_SIDE_NAMES[station.direction, side], number), of_pad


def pad_forces(
    station: Station, contacts: Sequence[ContactPair], forces: Sequence[Array]
) -> Iterator[tuple[Pad, str, Array]]:
    """Yield the pads of a station whose contacts have rows of their own, as :func:`loaded_pads`.

    Plates that bend share the force of a side otherwise than the stiffness of its pads. In space
    the pads of a pair have a row each, and the one that carries more counts.

    Args:
        station: station of a joint with pads.
        contacts: contact pairs of the station.
        forces: force (num_states,) in N of each of them.
    """
    assert station.joint is not None
    pairs: dict[tuple[Side, int], list[Array]] = {}
    counts: Counter[tuple[Side, Offset]] = Counter()
    for contact, force in zip(contacts, forces, strict=True):
        point = contact.side, contact.inner
        pairs.setdefault((contact.side, counts[point]), []).append(force)
        counts[point] += 1
    for (side, number), of_pair in pairs.items():
        pad, *_ = station.joint.pads_of(station.direction, side)[number]
        if pad is not None:
            force = np.max(of_pair, axis=0) * (len(of_pair) / PADS_OF_SIDE)
            yield pad, _name(_SIDE_NAMES[station.direction, side], number), force


def side_force(law: ContactLaw, side: int, gaps: Array) -> Array:
    """Return the contact forces (num_states,) in N on one side at gaps (num_states,) in m.

    They are positive in compression.
    """
    force = np.zeros(gaps.shape)
    for term in law.terms:
        if term.side == side:
            force += term.stiffness * np.maximum(side * gaps - term.onset, 0.0) ** term.exponent
    return force

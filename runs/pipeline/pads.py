# SPDX-License-Identifier: LGPL-3.0-or-later
"""How hard slide pads are pressed while the boom moves."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count

import numpy as np
import xarray as xr
from scipy.optimize import brentq

from dynamics.contact import ContactLaw
from geometry.arrays import Array
from geometry.boom import Boom, Direction, Joint
from geometry.joint import SIDES
from runs.case.build import contact_laws
from runs.case.contact import PADS_OF_SIDE, JointTable, PadTable, SlidePadTable
from runs.case.schema import Case, Model
from runs.pipeline.summary import PressedPad

# Names of sides.
_ON = {on: side for side, on in SIDES.items()}


def pressed_pads(case: Case, boom: Boom, data: xr.Dataset) -> Iterator[PressedPad]:
    """Those of every station of joints with play, in each model.

    Args:
        case: of the run.
        boom: of the case.
        data: the trajectories of its models.
    """
    if not any(table.pad or table.pads for table in case.joints):
        return
    with_play = (model for model in case.models if not model.play_free)
    for model in (model for model in with_play if model.name in data["model"].values):
        station, own = count(), data["contact_force_peak"].sel(model=model.name)
        ends = np.stack([own.min("time").values, own.max("time").values], axis=1)
        for direction in boom.directions:
            laws = contact_laws(case, model, direction)
            for table, joint, law in zip(case.joints, boom.joints, laws, strict=True):
                for x in () if joint.tied else joint.stations:
                    pushed = ends[next(station)]
                    if table.pad is not None:
                        largest = max(pushed, key=abs)
                        force = _of_a_side(abs(float(largest)), law)
                        side = _ON[direction, 1 if largest > 0.0 else -1]
                        yield _pressed(model, table, table.pad, x, side, force)
                    forces = _of_each(joint, direction, law, pushed)
                    for pad, force in zip(_along(table.pads, direction), forces, strict=True):
                        yield _pressed(model, table, pad, x, pad.side, force)


def _pressed(
    model: Model, joint: JointTable, pad: PadTable, x: float, side: str, both: float
) -> PressedPad:
    """One of a pair that bears a force in N evenly."""
    force, allowable = both / PADS_OF_SIDE, pad.allowable_pressure
    pressure = force / pad.area
    return PressedPad(
        model=model.name,
        outer=joint.outer,
        inner=joint.inner,
        x=x,
        side=side,
        force=force,
        pressure=pressure,
        utilisation=None if allowable is None else pressure / allowable,
    )


def _along(pads: Sequence[SlidePadTable], direction: Direction) -> list[SlidePadTable]:
    return [pad for pad in pads if SIDES[pad.side][0] == direction]


def _of_each(joint: Joint, direction: Direction, law: ContactLaw, pushed: Array) -> list[float]:
    """The largest force in N of each pair of pads, where all together push by so much.

    Args:
        joint: of the pads.
        direction: along which.
        law: of a station.
        pushed: (num_pushes,) in N, of those on the side 1 less those on the side −1.
    """
    laws = []
    for pad in (pad for pad in joint.pads if SIDES[pad.side][0] == direction):
        side = SIDES[pad.side][1]
        whole = sum(other.stiffness for other in joint.pads if other.side == pad.side)
        there = law.one_sided(side)
        assert there is not None
        part = there.shared(pad.stiffness / whole)
        laws.append(part.behind(part.clearance - pad.shim))
    if not laws:
        return []

    def force(approach: float) -> Array:
        return np.array([float(one.force(np.array(approach))) for one in laws])

    reach = 1.0e-3
    while not force(-reach).sum() <= pushed.min() <= pushed.max() <= force(reach).sum():
        reach *= 2.0
    approaches = [brentq(lambda y, p=p: force(y).sum() - p, -reach, reach) for p in pushed]
    return [float(most) for most in np.abs([force(y) for y in approaches]).max(axis=0)]


def _of_a_side(both: float, law: ContactLaw) -> float:
    """What one side bears in N where both together bear so much: shims press each at rest."""
    sides = (law.one_sided(side) for side in (1, -1))
    at_rest = max(float(abs(law.force(np.zeros(())))) for law in sides if law is not None)
    return max(both, at_rest + 0.5 * both)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""How hard slide pads are pressed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from dynamics.contact import ContactLaw
from geometry.arrays import Array
from geometry.boom import Direction, Joint
from geometry.joint import SIDES
from geometry.typography import TO_KILO, TO_MEGA
from runs.case.build import contact_laws
from runs.case.contact import PADS_OF_SIDE, JointTable, PadTable, SlidePadTable
from runs.pipeline.results import Results
from runs.report.tables import Column, Table

# Names of sides.
_ON = {on: side for side, on in SIDES.items()}


class PressedPad(NamedTuple):
    """A pad of one side of a station in one model; ``force`` is the largest in N."""

    model: str
    joint: JointTable
    pad: PadTable
    x: float
    place: str
    force: float

    @property
    def pressure(self) -> float:
        """In Pa."""
        return self.force / self.pad.area

    @property
    def utilisation(self) -> float | None:
        """Of what it may bear; None where that is not told."""
        allowable = self.pad.allowable_pressure
        return None if allowable is None else self.pressure / allowable


def pad_tables(results: Results) -> list[Table]:
    """How hard the pads of each joint are pressed at most; none without pads of a size."""
    pads = list(pressed_pads(results))
    if not pads:
        return []
    columns = (
        Column("model", [pad.model for pad in pads]),
        Column("joint", [f"{pad.joint.inner} in {pad.joint.outer}" for pad in pads]),
        Column("at\nm", [f"{pad.x:g}" for pad in pads]),
        Column("side", [pad.place for pad in pads]),
        Column("peak force\nkN", [pad.force for pad in pads], ".3g", TO_KILO),
        Column("pressure\nMPa", [pad.pressure for pad in pads], ".3g", TO_MEGA),
        Column("utilisation\n%", [pad.utilisation for pad in pads], ".0f", 100.0),
    )
    note = (
        "Of one pad. Those of one side of a station share its force as they are stiff, those of a "
        "pair evenly, and bear it evenly."
    )
    return [Table("Slide pads", columns, (note,), "pads")]


def pressed_pads(results: Results) -> Iterator[PressedPad]:
    """Those of every station of joints with play, in each model."""
    case = results.case
    if not any(table.pad or table.pads for table in case.joints):
        return
    boom = results.boom
    peaks = results.trajectories["contact_force_peak"]
    for model in (model for model in results.ran if not model.play_free):
        station, own = count(), peaks.sel(model=model.name)
        ends = np.stack([own.min("time").values, own.max("time").values], axis=1)
        for direction in boom.directions:
            laws = contact_laws(case, model, direction)
            for table, joint, law in zip(case.joints, boom.joints, laws, strict=True):
                for x in () if joint.tied else joint.stations:
                    pushed = ends[next(station)]
                    if table.pad is not None:
                        largest = max(pushed, key=abs)
                        force = _of_a_side(abs(float(largest)), law) / PADS_OF_SIDE
                        place = _ON[direction, 1 if largest > 0.0 else -1]
                        yield PressedPad(model.name, table, table.pad, x, place, force)
                    forces = _of_each(joint, direction, law, pushed)
                    for pad, force in zip(_along(table.pads, direction), forces, strict=True):
                        yield PressedPad(model.name, table, pad, x, pad.side, force / PADS_OF_SIDE)


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

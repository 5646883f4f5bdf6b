# SPDX-License-Identifier: LGPL-3.0-or-later
"""How hard slide pads are pressed."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from typing import NamedTuple

import numpy as np

from dynamics.contact import ContactLaw
from geometry.boom import Direction
from runs.case.build import build_boom, contact_laws
from runs.case.contact import PADS_OF_SIDE, JointTable, PadTable
from runs.pipeline.results import Results
from runs.report.stress_tables import PER_KILO, PER_MEGA
from runs.report.tables import Column, Table


class PressedPad(NamedTuple):
    """A pad of one side of a station in one model; ``force`` is the largest in N."""

    model: str
    joint: JointTable
    pad: PadTable
    x: float
    direction: Direction
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
    pads = list(_pressed(results))
    if not pads:
        return []
    columns = (
        Column("model", [pad.model for pad in pads]),
        Column("joint", [f"{pad.joint.inner} in {pad.joint.outer}" for pad in pads]),
        Column("at\nm", [f"{pad.x:g}" for pad in pads]),
        Column("along", [pad.direction for pad in pads]),
        Column("peak force\nkN", [pad.force for pad in pads], ".3g", PER_KILO),
        Column("pressure\nMPa", [pad.pressure for pad in pads], ".3g", PER_MEGA),
        Column("utilisation\n%", [pad.utilisation for pad in pads], ".0f", 100.0),
    )
    note = "The pads of one side of a station share its force evenly, and bear it evenly."
    return [Table("Slide pads", columns, (note,), "pads")]


def _pressed(results: Results) -> Iterator[PressedPad]:
    """Those of every station of joints with play."""
    case = results.case
    if not any(table.pad for table in case.joints):
        return
    boom = build_boom(case)
    peaks = abs(results.trajectories["contact_force_peak"])
    for model in (model for model in results.ran if not model.play_free):
        station, largest = count(), peaks.sel(model=model.name).max("time").values
        for direction in boom.directions:
            laws = contact_laws(case, model, direction)
            for table, joint, law in zip(case.joints, boom.joints, laws, strict=True):
                for x in () if joint.tied else joint.stations:
                    force = _of_a_side(float(largest[next(station)]), law) / PADS_OF_SIDE
                    if table.pad is not None:
                        yield PressedPad(model.name, table, table.pad, x, direction, force)


def _of_a_side(both: float, law: ContactLaw) -> float:
    """What one side bears in N where both together bear so much: shims press each at rest."""
    sides = (law.one_sided(side) for side in (1, -1))
    at_rest = max(float(abs(law.force(np.zeros(())))) for law in sides if law is not None)
    return max(both, at_rest + 0.5 * both)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The card of a calibrated beam: its stiffness and the springs of its stations."""

from __future__ import annotations

from beam_model.calibration import Calibration, Stiffness
from dynamics.gap_system import GapSystem
from geometry.boom import Boom, Segment
from runs.pipeline.summary import BeamOfShell, CalibrationCard, StationSpring

# Of the outer segment, by the direction in which the inner one presses and its sign.
_WALLS = {("z", 1): "top", ("z", -1): "bottom", ("y", 1): "right", ("y", -1): "left"}


def card(boom: Boom, system: GapSystem, calibration: Calibration) -> CalibrationCard:
    """What is told of a calibration.

    Args:
        boom: as the case has it.
        system: of the model, whose contact rows are the calibration's.
        calibration: of it.
    """
    return CalibrationCard(
        segments=[
            _beam(segment, stiffness)
            for segment, stiffness in zip(boom.segments, calibration.segments, strict=True)
        ],
        springs=[
            StationSpring(
                x=system.stations[station],
                side=_WALLS[system.station_directions[station], int(law.terms[0].side)],
                stiffness=calibration.spring(row),
            )
            for row, (law, station) in enumerate(
                zip(system.laws, system.station_of_row.tolist(), strict=True)
            )
        ],
    )


def _beam(segment: Segment, stiffness: Stiffness) -> BeamOfShell:
    planes = (
        (segment, segment.turned())[: len(stiffness.bending)] if segment.lateral else (segment,)
    )
    shear = [plane.local(0.5 * sum(plane.ends)).shear_stiffness or 0.0 for plane in planes]
    torsion = None
    if stiffness.torsion is not None and segment.lateral is not None:
        own = segment.material.shear_modulus * segment.lateral.torsion_constant
        torsion = stiffness.torsion / own
    return BeamOfShell(
        segment=segment.name,
        bending=list(stiffness.bending),
        shear=list(stiffness.shear),
        torsion=stiffness.torsion,
        bending_part=[
            found / plane.bending_stiffness
            for found, plane in zip(stiffness.bending, planes, strict=True)
        ],
        shear_part=[found / own for found, own in zip(stiffness.shear, shear, strict=True)],
        torsion_part=torsion,
    )

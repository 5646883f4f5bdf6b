# SPDX-License-Identifier: LGPL-3.0-or-later
"""The cards of calibrated beams."""

from __future__ import annotations

from itertools import groupby

from geometry.typography import TO_MEGA, TO_PERCENT
from runs.pipeline.results import Results
from runs.pipeline.summary import CalibrationCard, StationSpring
from runs.report.tables import Column, Table

_ALONG = "z", "y"


def calibration_tables(results: Results) -> list[Table]:
    """Stiffness of segments and springs of stations; beams that one shell calibrates share them."""
    cards = {
        name: model.calibration
        for name, model in results.summary.models.items()
        if model.calibration is not None
    }
    told = groupby(cards.items(), key=lambda entry: entry[1])
    found: list[Table] = []
    for number, (card, models) in enumerate(told, start=1):
        names = ", ".join(name for name, _ in models)
        found += [_segments(card, names, number), _springs(card, names, number)]
    return found


def _segments(card: CalibrationCard, names: str, number: int) -> Table:
    rows = [
        (beam, plane, _ALONG[plane]) for beam in card.segments for plane in range(len(beam.bending))
    ]
    columns = [
        Column("segment", [beam.segment for beam, _, _ in rows]),
        Column("bends along", [along for _, _, along in rows]),
        Column("E J\nMN m²", [beam.bending[plane] for beam, plane, _ in rows], ".4g", TO_MEGA),
        Column(
            "of the section's\n%",
            [beam.bending_part[plane] for beam, plane, _ in rows],
            ".2f",
            TO_PERCENT,
        ),
        Column("G A\nMN", [beam.shear[plane] for beam, plane, _ in rows], ".4g", TO_MEGA),
        Column(
            "of the shear flow's\n%",
            [beam.shear_part[plane] for beam, plane, _ in rows],
            ".1f",
            TO_PERCENT,
        ),
    ]
    if any(beam.torsion is not None for beam in card.segments):
        torsion = [beam.torsion for beam, _, _ in rows]
        columns.append(Column("G J\nMN m²", torsion, ".4g", TO_MEGA))
    return Table(
        f"The segments as beams, for {names}",
        tuple(columns),
        ("What makes a shear-flexible beam give way as the shell does, far from what presses it.",),
        f"calibrated-segments-{number}",
    )


def _springs(card: CalibrationCard, names: str, number: int) -> Table:
    springs: list[StationSpring] = card.springs
    return Table(
        f"The springs of the stations, for {names}",
        (
            Column("station\nm", [f"{spring.x:g}" for spring in springs]),
            Column("pressed wall of the outer segment", [spring.side for spring in springs]),
            Column("spring\nMN/m", [spring.stiffness for spring in springs], ".4g", TO_MEGA),
        ),
        (
            "In another program put each between the beams in series with its gap: it is what both "
            "walls give way there beyond the beams above.",
        ),
        f"calibrated-springs-{number}",
    )

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows and curves of a model at rest and in motion."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import NamedTuple

from protractile.analysis.curves import Curve, Curves, diagrams, envelope
from protractile.analysis.equilibria import (
    equilibria,
    extended_equilibria,
    instants,
    vibrating_state,
)
from protractile.analysis.fatigue import HAS_RAINFLOW, Life, life_rows
from protractile.analysis.measure import measure_boom, measure_segment
from protractile.analysis.model import AnalysisModel
from protractile.analysis.modes import Mode, mode_curves, mode_rows, modes
from protractile.analysis.plate_buckling import measure_plates
from protractile.analysis.rows import (
    EXTENDED,
    FARTHEST,
    MOTION,
    REST,
    Row,
    Rows,
    extremes,
    static_rows,
)
from protractile.analysis.states import States
from protractile.analysis.wear import wear_rows
from protractile.dynamics.trajectory import Trajectory


class Findings(NamedTuple):
    """Extremes of all quantities, and curves along the segments."""

    rows: Rows
    curves: Curves

    @classmethod
    def of(cls, rows: Iterable[Row], curves: Iterable[Curve]) -> Findings:
        """Return rows and curves that can be selected."""
        return cls(Rows(rows), Curves(curves))


def evaluate_rest(
    name: str, rests: States, extended: States, panels: bool
) -> tuple[list[Row], list[Curve], list[Mode]]:
    """Return rows, curves and modes of static states; all empty without an equilibrium.

    Args:
        name: name of the model.
        rests: states under the loads at t = 0 and extreme loads; empty without an equilibrium.
        extended: states at the largest and smallest extension.
        panels: True for buckling factors of plates by panel formulas.
    """
    if not rests.time.size:
        return [], [], []
    rows, curves = [*static_rows(rests, name)], [*diagrams(rests, name, REST)]
    if extended.time.size:
        rows += static_rows(extended, name, EXTENDED)
        curves += diagrams(extended, name, EXTENDED)
    farthest = (rests + extended).farthest
    rows += extremes(measure_boom(farthest), name, FARTHEST)
    rows += extremes(measure_plates(farthest) if panels else (), name, FARTHEST)
    system, rest = vibrating_state(
        rests.model.system, dict(zip(rests.time.tolist(), rests.positions, strict=True))
    )
    first = modes(replace(rests.model, system=system), rest)
    rows += mode_rows(first, name)
    curves += mode_curves(rests.boom, first, name)
    return rows, curves, first


def evaluate_motion(
    states: States, name: str, life: Life, play: bool = True, tip: float = 0.0
) -> tuple[list[Row], list[Curve]]:
    """Return extremes, fatigue damage, wear and envelopes of a motion.

    ``tip`` is the largest static deflection of the tip in m, to which wear adds.
    """
    rows, curves = [*extremes(measure_boom(states), name, MOTION, play)], list[Curve]()
    for number, (segment, line) in enumerate(
        zip(states.boom.segments, states.model.lines, strict=True)
    ):
        forces = states.section_forces(number)
        measured = [*measure_segment(states, number, forces)]
        rows += extremes(measured, name, MOTION, play)
        curves += envelope(segment.name, line.x, forces, name, play)
        if HAS_RAINFLOW:
            stresses = [measurement for measurement in measured if measurement.quantity == "stress"]
            rows += life_rows(stresses, name, play, life)
    rows += wear_rows(states, name, life, tip) if play else ()
    if states.recorded is not None and "rope_force_peak" in states.recorded:
        weight = states.recorded["rope_force_peak"].attrs["weight"]
        rows.append(Row(name, REST, play, "rope_force", "rope", "", weight))
    return rows, curves


def evaluate(
    model: AnalysisModel, name: str, motion: Trajectory, duration: float, panels: bool, life: Life
) -> tuple[list[Row], list[Curve], list[Mode]]:
    """Return rows and curves of a model at rest and in motion, and its modes at rest.

    Args:
        model: the model under all constant loads.
        name: name of the model.
        motion: motion of the model.
        duration: duration in s of the histories of the loads.
        panels: True for buckling factors of plates by panel formulas.
        life: data of fatigue damage.
    """
    rests = States.of(model, equilibria(model.system, instants(model.system, duration)))
    extended = States.of(model, extended_equilibria(model.system, duration))
    rows, curves, first = evaluate_rest(name, rests, extended, panels)
    tip = max((abs(row.value) for row in rows if row.quantity == "tip"), default=0.0)
    moving = States.in_motion(model, motion)
    more_rows, more_curves = evaluate_motion(moving, name, life, tip=tip)
    return [*rows, *more_rows], [*curves, *more_curves], first

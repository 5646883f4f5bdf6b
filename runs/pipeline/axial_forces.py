# SPDX-License-Identifier: LGPL-3.0-or-later
"""What each segment carries along the boom, and how near that is to what makes the boom buckle."""

from __future__ import annotations

import numpy as np
from rich.console import Console
from rich.table import Table

from geometry.arrays import Array
from geometry.axial import carried, passed_over
from geometry.boom import Boom
from geometry.typography import TO_KILO, TO_MEGA
from runs.case.declared import Declared
from runs.pipeline.proportions import of_buckling

# Beside a jump of the force, as a part of the segment.
_BESIDE = 1.0e-9


def print_axial_forces(declared: Declared, console: Console) -> None:
    """Print the largest force of each segment, and the buckling factor of each model."""
    table = Table("axial force, pressing", "largest (kN)", "over the plain area (MPa)")
    for number, segment in enumerate(declared.boom.segments):
        force, stress = _hardest(declared.boom, number)
        told = "unknown" if stress is None else f"{stress * TO_MEGA:.4g}"
        table.add_row(segment.name, f"{force * TO_KILO:.4g}", told)
    console.print(table)
    buckling = Table("joints pressed", "buckling factor", "of the critical forces")
    cautions: list[str] = []
    for model in declared.case.models:
        # A shell would have to be computed first.
        name = f"{model.name}, as beam elements" if model.needs_shell else model.name
        factor = model.coarsened(declared.boom).critical_factor(declared.joined(model))
        cautions += of_buckling(name, factor)
        row = "unknown", "unknown"
        if factor is not None:
            row = f"{factor:.4g}", f"{100.0 / factor:.3g} %"
        buckling.add_row(name, *row)
    console.print(buckling)
    for caution in cautions:
        console.print(caution, markup=False)


def _hardest(boom: Boom, number: int) -> tuple[float, float | None]:
    """The force of a segment in N that is farthest from 0, and over its area in Pa, as drawn."""
    segment = boom.segments[number]
    jumps = {*segment.compression.places, *passed_over(boom.segments, boom.joints, number)}
    ends = [x + side * _BESIDE * segment.length for x in jumps for side in (-1.0, 1.0)]
    x = np.unique(np.clip([*ends, segment.start, segment.end], segment.start, segment.end))
    times = [joint.drive.times for joint in boom.joints if joint.drive is not None]
    time = np.unique(np.concatenate([np.zeros(1), *times]))
    forces = carried(boom.segments, boom.joints, number, x, time)
    if segment.section is None:
        return _farthest(forces), None
    return _farthest(forces), _farthest(forces / [segment.section_at(at).area for at in x])


def _farthest(values: Array) -> float:
    return float(values.flat[np.abs(values).argmax()])

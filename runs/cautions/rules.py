# SPDX-License-Identifier: LGPL-3.0-or-later
"""All rules for cautions, in the order of their lines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from protractile.runs.cautions import inputs, loads, response
from protractile.runs.cautions.context import Context, Rule, Sentence

if TYPE_CHECKING:
    from protractile.runs.pipeline.results import Results

# Rules that need no result.
OF_INPUTS: Sequence[Rule] = (
    inputs.unusual_numbers, loads.sizes, loads.repeated_loads, loads.axial_forces,
    loads.missing_loads, inputs.ineffective_inputs, inputs.densities, inputs.table_ends,
    inputs.cylinders, inputs.nesting, inputs.thick_pads, inputs.compliant_contacts,
    inputs.mesh_sizes, loads.hoisted_loads, loads.load_cases, inputs.swapped_thicknesses,
)  # fmt: skip
RULES: Sequence[Rule] = (
    response.walls, *OF_INPUTS, response.stick_slip, response.lag, response.failures,
    response.buckling, response.deflections, response.durations, response.turning,
    response.axial_stresses, response.bulges, response.straight_path, response.utilisations,
    response.pulling_cylinders, response.panels, response.limits, response.swings,
    response.accuracy, inputs.series,
)  # fmt: skip


def cautions(context: Context, rules: Sequence[Rule] = RULES) -> list[str]:
    """Return the cautions and sentences of all rules, in the units of the case."""
    lines = (line for rule in rules for line in rule(context))
    texts = (f"{'' if isinstance(line, Sentence) else 'caution: '}{line}" for line in lines)
    return [context.case.system.convert(text) for text in texts]


def add_cautions(results: Results) -> None:
    """Add the cautions of a run to the summary of its results."""
    results.summary.cautions = cautions(Context.of_run(results))

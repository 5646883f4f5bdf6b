# SPDX-License-Identifier: LGPL-3.0-or-later
"""What each segment carries along the boom, and how near that is to what makes the boom buckle."""

from __future__ import annotations

from itertools import pairwise

from rich.console import Console
from rich.table import Table

from geometry.typography import TO_KILO, TO_MEGA
from runs.case.declared import Declared
from runs.pipeline.proportions import of_buckling


def print_axial_forces(declared: Declared, console: Console) -> None:
    """Print the largest force of each segment, and the buckling factor of each model."""
    carried = Table("axial force, pressing", "largest (kN)", "over the plain area (MPa)")
    for segment in declared.boom.segments:
        force, pressed = segment.compression.largest, segment.compression
        stress = "unknown"
        if segment.section is not None:
            stresses = (
                end / segment.section_at(x).area
                for ends, places in zip(pressed.ends, pairwise(pressed.places), strict=True)
                for x, end in zip(places, ends, strict=True)
            )
            stress = f"{max(stresses, key=abs, default=0.0) * TO_MEGA:.4g}"
        carried.add_row(segment.name, f"{force * TO_KILO:.4g}", stress)
    console.print(carried)
    buckling = Table("joints pressed", "buckling factor", "of the critical forces")
    cautions: list[str] = []
    for model in declared.case.models:
        # A shell would have to be computed first.
        name = f"{model.name}, as beam elements" if model.needs_shell else model.name
        factor = model.critical_factor(declared.joined(model))
        cautions += of_buckling(name, factor)
        row = "unknown", "unknown"
        if factor is not None:
            row = f"{factor:.4g}", f"{100.0 / factor:.3g} %"
        buckling.add_row(name, *row)
    console.print(buckling)
    for caution in cautions:
        console.print(caution, markup=False)

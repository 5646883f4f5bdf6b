# SPDX-License-Identifier: LGPL-3.0-or-later
"""The solid held against formulas, before anything is held against it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from geometry.section import BoxSection
from shell_model.reduction.mirror import ALONG_Z, BREATHING, Family
from shell_model.segment.solver import quadratic_form
from studies.box_pair import box
from studies.reference_models.eigenmodes import natural_frequencies
from studies.reference_models.solid import SolidFamily, assemble_solid
from studies.reference_models.solid_mesh import mesh_quarter
from studies.study import Held, Proof

# Thick and slender: as a rod in its length, its section cannot breathe.
BAR = box("bar", 0.0, 2.0, (0.10, 0.08), 0.03)
# Of sums of 1e5 terms that cancel, which compilers order differently.
ROUND_OFF = 1.0e-8


def solid_proofs() -> Iterator[Proof]:
    """Mass, stretch, pure bending and a rod's lowest frequency."""
    section, steel, length = BAR.section, BAR.material, BAR.length
    assert section is not None
    stretched, bent = _solid(BREATHING), _solid(ALONG_Z)
    nu, young = steel.poissons_ratio, steel.youngs_modulus
    x, y, z = stretched.nodes.T
    slide = np.column_stack([np.ones_like(x), 0.0 * x, 0.0 * x])
    stretch = np.column_stack([x, -nu * y, -nu * z])
    x, y, z = bent.nodes.T
    bend = np.column_stack([x * z, -nu * y * z, -0.5 * (x**2 + nu * (z**2 - y**2))])
    for what, matrix, motion, over, asked, unit, source in (
        ("mass", stretched.mass, slide, 1.0, steel.density * section.area * length, "kg",
         "ρ A L with the corners filled"),
        ("stiffness against stretching", stretched.stiffness, stretch, length,
         young * section.area, "N", "E A"),
        ("stiffness against pure bending", bent.stiffness, bend, length,
         young * section.second_moment_of_area, "N·m²",
         "E J of the hollow rectangle (Saint-Venant 1856)"),
    ):  # fmt: skip
        found = quadratic_form(matrix, motion.ravel()) / over
        yield Proof(f"solid box: {what}", found, asked, unit, "analytic", source, ROUND_OFF)
    # A lateral inertia slows a rod's waves (Rayleigh 1877, section 157; Love 1927, section 278).
    polar = section.polar_second_moment_of_area / section.area
    slowed = np.sqrt(1.0 + nu**2 * polar * (np.pi / length) ** 2)
    rod = 0.5 * np.sqrt(young / steel.density) / length / slowed
    held: Held = ("analytic", "c / 2L with lateral inertia (Love 1927)", 1.0e-4)
    found = float(natural_frequencies(stretched, 2)[1])
    yield Proof("solid box: lowest frequency as a rod", found, float(rod), "Hz", *held)


def _solid(family: Family) -> SolidFamily:
    assert isinstance(BAR.section, BoxSection)
    mesh = mesh_quarter(BAR.section, (BAR.start, BAR.end), (0.1, 0.1), 0.1)
    return assemble_solid(BAR, mesh, family)

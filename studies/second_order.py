# SPDX-License-Identifier: LGPL-3.0-or-later
"""Columns, compared with Euler's cases, Greenhill's column, beam-columns and their frequencies."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial
from typing import NamedTuple

import numpy as np

from protractile.beam_model.boom_modes import critical_factor
from protractile.beam_model.elements import Theory
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.excitation import Step
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Material, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.load import Load
from studies.reference_models.statics import static_response
from studies.study import Progress, Verification, define_study

STEEL = Material(2.1e11, 0.3, 7850.0)
BOX = BoxSection(height=0.2, width=0.15, flange=0.006, web=0.006)
LENGTH = 8.0
STIFFNESS = STEEL.youngs_modulus * BOX.second_moment_of_area
SHEAR_STIFFNESS = STEEL.shear_modulus * BOX.shear_area
ELEMENT, TERMS, MESH_SIZE = 0.2, 12, 0.4

CLAMP, HINGE, END, FIXED = (
    Support(0.0, "clamped"), Support(0.0), Support(LENGTH), Support(LENGTH, "clamped"),
)  # fmt: skip
# Supports, and the critical force over π² E J/L²; for clamped and hinged ends β = tan β.
EULER: Mapping[str, tuple[tuple[Support, ...], float]] = {
    "cantilever": ((CLAMP,), 0.25),
    "hinged": ((HINGE, END), 1.0),
    "clamped and hinged": ((CLAMP, END), (4.493409457909064 / np.pi) ** 2),
    "clamped": ((CLAMP, FIXED), 4.0),
}
CRITICAL = np.pi**2 * STIFFNESS / LENGTH**2
# Axial force in bending and vibration, as a fraction of the cantilever's critical force.
SHARE = 0.3


class Model(NamedTuple):
    """Model of a column, with its system and critical factor."""

    of: Callable[[Boom], tuple[GapSystem, float | None]]  #: a boom of one segment
    in_shear: bool  #: whether shear bends it, too
    allowed: float  #: relative error

    def factor(self, boom: Boom) -> float:
        """Return the buckling factor of the axial force."""
        _, factor = self.of(boom)
        assert factor is not None
        return factor

    def critical(self, euler: float) -> float:
        """Return the critical force in N with shear, from the force without it (Engesser 1891)."""
        return euler / (1.0 + euler / SHEAR_STIFFNESS) if self.in_shear else euler


def elements(boom: Boom, theory: Theory = "euler-bernoulli") -> tuple[GapSystem, float | None]:
    """Return beam elements without rotary inertia, and their critical factor."""
    models = finite_element_segments(boom, ELEMENT, theory, rotary_inertia=False)
    return gap_system(boom, models), critical_factor(boom, models)


def series(boom: Boom) -> tuple[GapSystem, float | None]:
    """Return the series with the complete base, and its critical factor."""
    models = kantorovich_segments(boom, [TERMS], "complete", rotary_inertia=False)
    return gap_system(boom, models), critical_factor(boom, models)


def shell(boom: Boom) -> tuple[GapSystem, float | None]:
    """Return the reduced shell of a box, and its critical factor."""
    from mpi4py import MPI

    from protractile.shell_model.boom_shell import ShellOptions
    from protractile.shell_model.reduced_shell import reduce_boom

    reduced = reduce_boom(boom, ShellOptions(mesh_size=MESH_SIZE), MPI.COMM_SELF)
    return reduced.system, reduced.critical_factor


MODELS: Mapping[str, Model] = {
    "elements": Model(elements, in_shear=False, allowed=1e-4),
    "series": Model(series, in_shear=False, allowed=1e-4),
    "shear-flexible elements": Model(
        partial(elements, theory="timoshenko"), in_shear=True, allowed=1e-4
    ),
    "shell": Model(shell, in_shear=True, allowed=5e-3),
}


def column(
    supports: tuple[Support, ...], force: float, gravity: float = 0.0, point: float | None = None
) -> Boom:
    """Create a column under a uniform load of 1 N/m, or 1 N at ``point`` in m.

    ``force`` in N acts along the axis at the tip, ``gravity`` in m/s² along the axis.
    """
    alone = Segment.of_section("column", 0.0, LENGTH, STEEL, BOX, supports=supports)
    if point is None:
        alone = replace(alone, load=1.0)
    pressed = with_compression([alone], [], [Thrust(0, LENGTH, force)], gravity)
    loads = () if point is None else (Load(0, "z", 1.0, point, Step()),)
    return Boom(pressed, (), loads)


@define_study("second_order", "Columns: buckling, swing and deflection")
def study(progress: Progress) -> Iterator[Verification]:
    """Compare all models with closed forms."""
    for name, model in MODELS.items():
        progress(name)
        yield from _euler(name, model)
        yield from (verification(name, model) for verification in (_greenhill, _swing, _berry))


def _euler(name: str, model: Model) -> Iterator[Verification]:
    source = "Euler 1744, shear by Engesser 1891" if model.in_shear else "Euler 1744"
    for case, (supports, part) in EULER.items():
        # A shear-flexible column has no closed form.
        if model.in_shear and case == "clamped and hinged":
            continue
        reference = model.critical(part * CRITICAL)
        force = SHARE * reference
        found = model.factor(column(supports, force)) * force
        what = f"critical force of a {case} column, {name}"
        yield Verification(what, found, reference, "N", "analytic", source, model.allowed)


def _greenhill(name: str, model: Model) -> Verification:
    gravity = 9.80665
    mass = BOX.mass_per_length(STEEL.density)
    factor = model.factor(column((CLAMP,), 0.0, gravity))
    found = factor * mass * gravity * LENGTH**3 / STIFFNESS
    what = f"ρ g A L³/(E J) of a column that buckles under its own weight, {name}"
    # Shear, which Greenhill neglects, takes 0.16 % here.
    allowed = max(model.allowed, 2e-3) if model.in_shear else model.allowed
    return Verification(what, found, 7.8373474, "", "analytic", "Greenhill 1881", allowed)


def _swing(name: str, model: Model) -> Verification:
    critical = model.critical(CRITICAL)
    free, held = (
        model.of(column((HINGE, END), force))[0].frequencies[0] for force in (0.0, SHARE * critical)
    )
    source = "√(1 − P/P_cr), Timoshenko and Gere 1961"
    what = f"first frequency of a hinged column under {SHARE:g} P_cr over that without, {name}"
    reference = float(np.sqrt(1.0 - SHARE))
    return Verification(what, held / free, reference, "", "analytic", source, model.allowed)


def _berry(name: str, model: Model) -> Verification:
    """Check the static tip deflection under a load Q across the tip.

    With k² = P/(c E J), c = 1 − P/(G A_s), the tip is at (Q/P) (tan(k L)/(c k) − L); without
    shear this is Berry's function times Q L³/(3 E J).
    """
    force, flexibility = SHARE * 0.25 * CRITICAL, 1.0 / SHEAR_STIFFNESS if model.in_shear else 0.0
    left = 1.0 - force * flexibility
    k = np.sqrt(force / (left * STIFFNESS))
    bent = float(np.tan(k * LENGTH) / (left * k) - LENGTH) / force
    reference = bent / (LENGTH**3 / (3.0 * STIFFNESS) + LENGTH * flexibility)
    tips = []
    for pressed in (0.0, force):
        system, _ = model.of(column((CLAMP,), pressed, point=LENGTH))
        (load,) = system.excitations
        tips.append(float(system.observers["tip"].row @ static_response(system, load.load)))
    what = f"tip deflection of a cantilever under {SHARE:g} P_cr over that without, {name}"
    source = "3 (tan u − u)/u³, Berry 1919, shear by Engesser 1891"
    return Verification(what, tips[1] / tips[0], reference, "", "analytic", source, model.allowed)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tapered cantilevers, compared with closed forms.

All dimensions of the section decrease linearly along the boom, so that A ∝ ξ² and J ∝ ξ⁴, with
ξ = 1 at the clamp and ξ = α at the tip.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq
from scipy.special import iv, jv, kv, yv

from protractile.dynamics.excitation import Step
from protractile.geometry.arrays import Array
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Segment
from protractile.geometry.box import BoxSection
from protractile.geometry.load import Load
from studies.reference_models.statics import static_response
from studies.second_order import (
    BOX,
    CLAMP,
    LENGTH,
    MODELS,
    SHEAR_STIFFNESS,
    STEEL,
    STIFFNESS,
    Model,
)
from studies.study import Criterion, Kind, Progress, Verification, define_study

ALPHA = 0.5
HEAD = BoxSection(*(ALPHA * size for size in (BOX.height, BOX.width, BOX.flange, BOX.web)))
# Distance in m from the clamp to the apex of the cone.
WHOLE = LENGTH / (1.0 - ALPHA)

ELEMENTS = "shear-flexible elements"

# Permitted errors of beams, and of the shell with shear and transverse strain of its walls.
CLOSE, OF_SHELL = 1.0e-4, 5.0e-3


def arm(force: float = 0.0) -> Boom:
    """Return the cantilever under 1 N across the tip and an axial force in N."""
    alone = Segment.of_section("arm", 0.0, LENGTH, STEEL, BOX, head_section=HEAD, supports=(CLAMP,))
    pressed = with_compression([alone], [], [Thrust(0, LENGTH, force)])
    return Boom(pressed, (), (Load(0, "z", 1.0, LENGTH, Step()),))


def tip(in_shear: bool) -> float:
    """Return the tip compliance ∫ (L − x)²/(E J) dx = L³/(3 E J_0 α) in m/N.

    Shear deflection adds L/(G A_0 α).
    """
    shear = LENGTH / (SHEAR_STIFFNESS * ALPHA) if in_shear else 0.0
    return LENGTH**3 / (3.0 * STIFFNESS * ALPHA) + shear


def frequency() -> float:
    """Return the first frequency in Hz (Kirchhoff 1879).

    The mode is w = Z_2(2 λ √ξ)/ξ, where Z_2 combines the Bessel functions J, Y, I and K. The k-th
    derivative has terms ± λᵏ Z_{2+k}/ξ^(1+k/2). The conditions are w = w′ = 0 at ξ = 1 and
    w″ = (ξ⁴ w″)′ = 0 at ξ = α.
    """

    def determinant(eigenvalue: float) -> float:
        def row(k: int, xi: float) -> Array:
            z = 2.0 * eigenvalue * np.sqrt(xi)
            signs = (-1.0) ** k, (-1.0) ** k, 1.0, (-1.0) ** k
            functions = zip(signs, (jv, yv, iv, kv), strict=True)
            values = np.array([sign * function(2 + k, z) for sign, function in functions])
            return np.asarray(eigenvalue**k * xi ** (-1.0 - 0.5 * k) * values)

        rows = row(0, 1.0), row(1, 1.0), row(2, ALPHA), 4.0 * row(2, ALPHA) / ALPHA + row(3, ALPHA)
        matrix = np.array(rows)
        return float(np.linalg.det(matrix / np.abs(matrix).max(axis=0)))

    # Take the smallest λ at which the determinant changes its sign.
    places = np.linspace(2.0, 10.0, 200)
    signs = np.sign([determinant(place) for place in places])
    first = int(np.flatnonzero(signs[1:] != signs[:-1])[0])
    eigenvalue = float(brentq(determinant, places[first], places[first + 1]))
    mass = BOX.mass_per_length(STEEL.density)
    return float(eigenvalue**2 * np.sqrt(STIFFNESS / mass) / (2.0 * np.pi * WHOLE**2))


def critical() -> float:
    """Return the critical axial force in N at the tip (Dinnik 1929).

    The deflection relative to the tip is ξ sin(u/α − u/ξ). Its slope is 0 at ξ = 1.
    """
    turned = 1.0 / ALPHA - 1.0
    u = brentq(lambda u: np.sin(u * turned) + u * np.cos(u * turned), 0.5 * np.pi, np.pi)
    return float(u**2 * STIFFNESS / WHOLE**2)


@define_study("taper", "Segments that taper")
def study(progress: Progress) -> Iterator[Verification]:
    """Compare all models with closed forms."""
    for name, model in MODELS.items():
        progress(name)
        source = "∫ (L − x)²/(E J) dx" + (" + ∫ dx/(G A_s)" if model.in_shear else "")
        system, _ = model.of(arm())
        found = system.observers["tip"].row @ static_response(system, system.excitations[0].load)
        criterion: Criterion = ("analytic", source, OF_SHELL if name == "shell" else CLOSE)
        what, bent = f"tip of a tapered cantilever, {name}", tip(model.in_shear)
        yield Verification(what, 1e6 * float(found), 1e6 * bent, "1e-6 m/N", *criterion)
        if name != ELEMENTS:
            yield from _swing_and_force(name, model)


def _swing_and_force(name: str, model: Model) -> Iterator[Verification]:
    """Compare frequency and critical force with closed forms, or with other models if sheared."""
    exact, sources = (frequency(), critical()), ("Kirchhoff 1879", "Dinnik 1929")
    kind: Kind = "analytic"
    if model.in_shear:
        exact, sources, kind = _measured(MODELS[ELEMENTS]), (ELEMENTS, ELEMENTS), "other code"
    allowed = OF_SHELL if name == "shell" else CLOSE
    for what, found, expected, unit, source in zip(
        ("first frequency", "critical force"), _measured(model), exact, ("Hz", "N"), sources,
        strict=True,
    ):  # fmt: skip
        yield Verification(f"{what} of it, {name}", found, expected, unit, kind, source, allowed)


def _measured(model: Model) -> tuple[float, float]:
    """Return the first frequency in Hz and the critical force in N."""
    load = 0.1 * critical()
    system, _ = model.of(arm())
    return float(system.frequencies[0]), model.factor(arm(load)) * load

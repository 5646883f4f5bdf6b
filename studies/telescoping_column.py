# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cantilever under an axial force that moves with a telescoping segment.

A column in compression up to x = a buckles like a column of the length a. Under a transverse load
at the head it bends as a beam-column up to a, and as a beam beyond a.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np

from protractile.beam_model.boom_modes import critical_factor
from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.motion_laws import SCurve
from protractile.geometry.axial import Thrust, with_compression
from protractile.geometry.boom import Boom, Joint, Segment
from protractile.geometry.box import BoxSection
from protractile.geometry.joint import Drive
from studies.second_order import (
    BOX,
    CLAMP,
    ELEMENT,
    LENGTH,
    SHARE,
    SHEAR_STIFFNESS,
    STEEL,
    STIFFNESS,
)
from studies.study import Criterion, Progress, Verification, define_study

INNER = BoxSection(height=0.16, width=0.11, flange=0.006, web=0.006)
LAW = PowerContact(1e8, 1.0)
TERMS = 16
# x in m of the inner segment's tail at the start and at the end.
START, END = 2.0, 5.0
ALLOWED = 1e-4

MODELS: Mapping[str, Callable[[Boom], list[SegmentModel]]] = {
    "elements": lambda boom: finite_element_segments(boom, ELEMENT, "euler-bernoulli", False),
    "series": lambda boom: kantorovich_segments(boom, (TERMS, 6), "complete", False),
    "shear-flexible elements": lambda boom: finite_element_segments(
        boom, ELEMENT, "timoshenko", False
    ),
}


def column(force: float) -> Boom:
    """Return the cantilever with a telescoping segment, whose tail transfers a force in N."""
    outer = Segment.of_section("column", 0.0, LENGTH, STEEL, BOX, supports=(CLAMP,))
    inner = Segment.of_section("drawn", START, START + LENGTH, STEEL, INNER)
    drive = Drive(SCurve(END - START, 1.0), ("inner", "outer"))
    joint = Joint(0, 1, (START, LENGTH), play=0.01, contact=LAW, drive=drive)
    pressed = with_compression((outer, inner), [joint], [Thrust(1, START, force)])
    return Boom(pressed, (joint,))


@define_study("telescoping_column", "A column compressed over a growing length")
def study(progress: Progress) -> Iterator[Verification]:
    """Compare all beam models with closed forms."""
    for name, build in MODELS.items():
        progress(name)
        yield from _verifications(name, build)


def _verifications(
    name: str, build: Callable[[Boom], list[SegmentModel]]
) -> Iterator[Verification]:
    in_shear = name == "shear-flexible elements"
    euler = 0.25 * np.pi**2 * STIFFNESS / END**2
    critical = euler / (1.0 + euler / SHEAR_STIFFNESS) if in_shear else euler
    boom = column(SHARE * critical)
    models = build(boom)
    factor = critical_factor(boom, models)
    assert factor is not None
    source = "Euler 1744, shear by Engesser 1891" if in_shear else "Euler 1744"
    pressed = f"pressed over {END:g} of its {LENGTH:g} m"
    what = f"critical force of a cantilever that is drawn to be {pressed}, {name}"
    found = factor * SHARE * critical
    yield Verification(what, found, critical, "N", "analytic", source, ALLOWED)
    if in_shear:
        return
    system = gap_system(boom, models)
    criterion: Criterion = ("analytic", "beam-column, Timoshenko and Gere 1961", ALLOWED)
    for time, x in ((0.0, START), (1.0, END)):
        row = system.observers["head"].row
        # Check a travel of the single segment.
        own = np.flatnonzero(row)
        stiffness = system.at_time(time).stiffness[np.ix_(own, own)]
        head = float(row[own] @ np.linalg.solve(stiffness, row[own]))
        what = f"deflection of its head under {SHARE:g} P_cr over {x:g} m, {name}"
        yield Verification(what, head, _bent(x, SHARE * critical), "m/N", *criterion)


def _bent(a: float, force: float) -> float:
    """Return the transverse compliance of the head in m/N, under an axial force in N up to a in m.

    Up to a, E J w″ = Q (L − x) + P (w(a) − w) with w(0) = w′(0) = 0. Beyond a, E J w″ = Q (L − x).
    """
    k, beyond = np.sqrt(force / STIFFNESS), LENGTH - a
    at_a = (np.tan(k * a) / k + beyond / np.cos(k * a) - LENGTH) / force
    slope = (at_a + LENGTH / force) * k * np.sin(k * a) + (np.cos(k * a) - 1.0) / force
    return float(at_a + slope * beyond + beyond**3 / (3.0 * STIFFNESS))

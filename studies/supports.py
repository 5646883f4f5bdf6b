# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms on hinges, cylinders, rotational springs and dashpots, compared with closed forms."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.optimize import brentq

from beam_model.elements import Theory
from beam_model.finite_element import finite_element_segments
from beam_model.kantorovich import kantorovich_segments
from beam_model.rigid import rigid_segment
from beam_model.segment_model import gap_system
from dynamics.contact import PowerContact
from dynamics.excitation import Step
from dynamics.gap_system import GapSystem
from dynamics.integrator import AdaptiveStep
from dynamics.motion import Motion
from geometry.arrays import Array
from geometry.boom import Boom, Cylinder, Joint, Load, Segment, Support
from geometry.section import BoxSection
from studies.reference_models.statics import static_response
from studies.second_order import STEEL
from studies.study import Criterion, Progress, Verification, define_study

# Section with thick walls, so that it hardly distorts.
BOX = BoxSection(height=0.4, width=0.3, flange=0.02, web=0.02)
LENGTH = 10.0
# Cylinder from the ground, 1.8 m below the axis, to a lug 0.3 m below the axis at x = 2.5 m.
CYLINDER = Cylinder(0, x=2.5, depth=0.3, ground=(1.0, -1.8), stiffness=2.0e7)
TIP_LOAD = -5.0e3
# Rotational stiffness of a hinge in N·m/rad; E J / L is 3.7e7.
ROTATION = 2.0e7
# Damping in N·s/m of a support, of a cylinder, and of each of two stations.
DASHPOT = 2.0e3

# Permitted errors of beams, series (no kink of moments at the lug), shells and decrements.
EXACT, SERIES, WALLS, DECREMENT = 1.0e-6, 1.0e-3, 5.0e-3, 1.0e-4
LEVERS: Criterion = ("analytic", "lever arms", EXACT)


def lever(cylinder: Cylinder) -> float:
    """Return the lever arm in m of a cylinder about a hinge on the axis at x = 0."""
    along, up = cylinder.direction
    return cylinder.x * up + cylinder.depth * along


def tip_compliance(segment: Segment, cylinder: Cylinder, shear_stiffness: float) -> float:
    """Return the tip compliance in m/N of a boom on a hinge at x = 0 and a cylinder.

    It follows from the strain energy (Castigliano 1879). Under 1 N at the tip, the cylinder carries
    L/r and the hinge R = L/r s_z − 1. The bending moment is R x up to the lug and L − x beyond it.

    Args:
        segment: segment that starts at x = 0.
        cylinder: cylinder with its lug at x in m.
        shear_stiffness: G A_s in N; infinite for a beam rigid in shear.
    """
    lug, beyond = cylinder.x, segment.end - cylinder.x
    force = segment.end / lever(cylinder)
    hinge = force * cylinder.direction[1] - 1.0
    bent = (hinge**2 * lug**3 + beyond**3) / (3.0 * segment.bending_stiffness)
    sheared = (hinge**2 * lug + beyond) / shear_stiffness
    return force**2 / cylinder.stiffness + bent + sheared


def first_frequency(segment: Segment, rotation_stiffness: float) -> float:
    """Return the frequency in Hz of a beam on a hinge with a rotational spring (Blevins 1979).

    (kL/EJ) (1 + cos λ cosh λ) = λ (sin λ cosh λ − cos λ sinh λ)
    """
    share = rotation_stiffness * segment.length / segment.bending_stiffness

    def defect(number: float) -> float:
        turned = np.sin(number) * np.cosh(number) - np.cos(number) * np.sinh(number)
        return float(share * (1.0 + np.cos(number) * np.cosh(number)) - number * turned)

    # Between a free and a clamped end.
    number = brentq(defect, 1.0e-3, 1.9, xtol=1e-14)
    rate = np.sqrt(segment.bending_stiffness / segment.mass_per_length)
    return float((number / segment.length) ** 2 * rate / (2.0 * np.pi))


def decrement(system: GapSystem, position: Array, period: float) -> float:
    """Return the mean logarithmic decrement of successive maxima of the tip deflection."""
    tip = AdaptiveStep()(Motion(system, 8.5 * period, period / 500.0, position)).data["tip"].values
    before, at, after = tip[:-2], tip[1:-1], tip[2:]
    peaks = (at > before) & (at >= after)
    before, at, after = before[peaks], at[peaks], after[peaks]
    # The parabola through three points finds the maximum between two outputs.
    heights = at + 0.125 * (after - before) ** 2 / (2.0 * at - before - after)
    return float(np.log(heights[0] / heights[-1]) / (len(heights) - 1))


@define_study("supports", "Hinges, cylinders, springs and dashpots")
def study(progress: Progress) -> Iterator[Verification]:
    """Compare static states, frequencies and decrements of beams and shells with closed forms."""
    yield from _luffed(progress)
    yield from _turning(progress)
    yield from _swinging(progress)


def _luffed(progress: Progress) -> Iterator[Verification]:
    boom = Boom((_segment(),), (), (_PUSHED,), cylinders=(CYLINDER,))
    shear = STEEL.shear_modulus * BOX.shear_area
    for name, shear_stiffness, allowed in (
        ("elements", np.inf, EXACT),
        ("Timoshenko's elements", shear, EXACT),
        ("a series of 24 terms", np.inf, SERIES),
        ("a shell", shear, WALLS),
    ):
        progress(f"a luffed boom of {name}")
        system = _MODELS[name](boom).gather_loads()
        at_rest = static_response(system, system.load)
        force, tip = (
            float(system.observers[one].row @ at_rest) for one in ("cylinder_force", "tip")
        )
        what = f"hinge and inclined cylinder, {name}: "
        expected = -1e-3 * TIP_LOAD * LENGTH / lever(CYLINDER)
        bent = 1e3 * TIP_LOAD * tip_compliance(boom.segments[0], CYLINDER, shear_stiffness)
        yield Verification(f"{what}its force", 1e-3 * force, expected, "kN", *LEVERS)
        criterion: Criterion = ("analytic", "Castigliano 1879", allowed)
        yield Verification(f"{what}the tip", 1e3 * tip, bent, "mm", *criterion)


def _turning(progress: Progress) -> Iterator[Verification]:
    spring = Support(0.0, rotation_stiffness=ROTATION)
    # The closed form has no rotary inertia; a shell's walls have it.
    thick = replace(_segment(), supports=(spring,))
    slender = replace(thick, rotary_inertia=0.0)
    boom = Boom((slender,), (), (_PUSHED,))
    blevins: Criterion = ("analytic", "Blevins 1979", 1e-5)
    theory = first_frequency(slender, ROTATION), blevins
    beam = _MODELS["Timoshenko's elements"](Boom((thick,), ())).frequencies[0]
    references: Mapping[str, tuple[float, Criterion]] = {
        "elements": theory,
        "a series of 24 terms": theory,
        "a shell": (float(beam), ("other code", "Timoshenko's elements", WALLS)),
    }
    for name, (reference, criterion) in references.items():
        progress(f"a hinge that resists rotation, {name}")
        found = _MODELS[name](boom).frequencies[0]
        what = f"hinge with a spring against rotation, {name}: first frequency"
        yield Verification(what, found, reference, "Hz", *criterion)


def _swinging(progress: Progress) -> Iterator[Verification]:
    """Compare the decrements of rigid booms on springs k and dashpots c with closed forms.

    A boom on a hinge has ω = r √(k/I), ζ = c r/2√(k I) and δ = 2πζ/√(1 − ζ²). A segment on both
    stations of a joint, in vertical motion, has ω = √(2k/m) and ζ = c/√(2k m).
    """
    boom, stiffness = _segment(), CYLINDER.stiffness
    mass = boom.mass_per_length * LENGTH
    inertia = mass * LENGTH**2 / 3.0 + boom.rotary_inertia * LENGTH
    elastic = replace(
        boom, supports=(Support(0.0), Support(2.5, stiffness=stiffness, dashpot=DASHPOT))
    )
    held = replace(boom, section=None, supports=(Support(0.0, "clamped"),))
    fly = replace(held, name="fly", start=LENGTH - 1.0, supports=())
    both_ways = PowerContact(stiffness, exponent=1.0)
    joint = Joint(0, 1, (LENGTH - 0.75, LENGTH - 0.25), 0.0, both_ways, dashpot=DASHPOT)
    for what, stands, arm, effective in (
        ("cylinder", Boom((boom,), (), cylinders=(_DRAGGED,)), lever(_DRAGGED), inertia),
        ("support", Boom((elastic,), ()), 2.5, inertia),
        ("joint", Boom((held, fly), (joint,)), np.sqrt(2.0), mass / LENGTH),
    ):
        progress(f"a dashpot at a {what}")
        models = [rigid_segment(one) for one in stands.segments]
        system = gap_system(stands, models)
        omega = arm * np.sqrt(stiffness / effective)
        ratio = 0.5 * DASHPOT * arm / np.sqrt(stiffness * effective)
        if not system.laws:
            name = f"rigid boom on a hinge and a {what}: frequency"
            yield Verification(name, system.frequencies[0], omega / (2.0 * np.pi), "Hz", *LEVERS)
        # Rotation about the hinge, or vertical motion without one.
        rows = system.rows if system.laws else np.ones((1, 1))
        raised = np.linalg.lstsq(rows, np.full(len(rows), 1.0e-3), rcond=None)[0]
        found = decrement(system, raised, 2.0 * np.pi / omega)
        expected = 2.0 * np.pi * ratio / np.sqrt(1.0 - ratio**2)
        name = f"dashpot at a {what}, rigid boom: logarithmic decrement"
        yield Verification(name, found, expected, "", "analytic", "an oscillator", DECREMENT)


_PUSHED = Load(0, "z", TIP_LOAD, LENGTH, Step())
_DRAGGED = replace(CYLINDER, dashpot=DASHPOT)


def _segment() -> Segment:
    return Segment.of_section("boom", 0.0, LENGTH, STEEL, BOX, supports=(Support(0.0),))


def _shell(boom: Boom) -> GapSystem:
    from mpi4py import MPI

    from shell_model.boom_shell import ShellOptions
    from shell_model.reduced_shell import reduce_boom

    return reduce_boom(boom, ShellOptions(0.2), MPI.COMM_SELF).system


def _elements(boom: Boom, theory: Theory) -> GapSystem:
    return gap_system(boom, finite_element_segments(boom, 0.5, theory, rotary_inertia=True))


_MODELS: Mapping[str, Callable[[Boom], GapSystem]] = {
    "elements": partial(_elements, theory="euler-bernoulli"),
    "Timoshenko's elements": partial(_elements, theory="timoshenko"),
    "a series of 24 terms": lambda boom: gap_system(
        boom, kantorovich_segments(boom, [24], "complete", rotary_inertia=True)
    ),
    "a shell": _shell,
}

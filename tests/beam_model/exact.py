# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plain beams, and their closed-form solutions, independent of the program.

Statics follows from Macaulay's brackets, frequencies follow from determinants.
"""

from collections.abc import Callable, Sequence
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

from protractile.beam_model.component import Component, SegmentModel, natural_modes
from protractile.beam_model.finite_element import Theory, finite_element_segments
from protractile.beam_model.kantorovich import Base, kantorovich_segments
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Material, Segment, Support
from protractile.geometry.box import BoxSection

STEEL = Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
BOX = BoxSection(height=0.60, width=0.40, flange=0.04, web=0.01)


def beam(*, supports: Sequence[float | Support] = (), **changes: Any) -> Segment:
    """Return a beam of BOX on [3, 8] m; numbers in ``supports`` are pinned supports."""
    numbers: dict[str, Any] = {
        "name": "beam", "start": 3.0, "end": 8.0, "material": STEEL,
        "mass_per_length": BOX.mass_per_length(STEEL.density),
        "second_moment_of_area": BOX.second_moment_of_area,
        "rotary_inertia": STEEL.density * BOX.second_moment_of_area, "section": BOX,
        "supports": tuple(x if isinstance(x, Support) else Support(x) for x in supports),
    }  # fmt: skip
    return Segment(**numbers | changes)


def beam_series(boom: Boom, terms: Sequence[int], base: Base = "as printed") -> list[SegmentModel]:
    return kantorovich_segments(boom, terms, base, False)


def beam_elements(
    boom: Boom, length: float, theory: Theory = "euler-bernoulli"
) -> list[SegmentModel]:
    return finite_element_segments(boom, length, theory, False)


Build = Callable[[Boom], Sequence[SegmentModel]]
# Elements and series without rotary inertia, as the parameter ``build``.
MODELS: dict[str, Build] = {
    "euler-bernoulli": lambda boom: beam_elements(boom, 0.25),
    "timoshenko": lambda boom: beam_elements(boom, 0.25, "timoshenko"),
    "series": lambda boom: beam_series(boom, [12] * len(boom.segments), "complete"),
}
BUILDS = pytest.mark.parametrize("build", MODELS.values(), ids=MODELS)

# βL of a beam of length L with a free, a clamped or a pinned end on either side (Blevins 1979).
FREE_FREE = (4.730040744862704, 7.853204624095838, 10.995607838001671)
CLAMPED_FREE = (1.875104068711961, 4.694091132974175, 7.854757438237613)
PINNED_FREE = (3.926602312047919, 7.068582745628732, 10.210176122813031)
PINNED_PINNED = (np.pi, 2.0 * np.pi, 3.0 * np.pi)


def angular_frequencies(segment: Segment, numbers: Sequence[float]) -> Array:
    """Return ω in rad/s for values of βL."""
    beta = np.array(numbers) / segment.length
    return beta**2 * np.sqrt(segment.bending_stiffness / segment.mass_per_length)


class OverhangingBeam:
    """A beam on two supports under forces (place in m, N) and a uniform load over its length.

    ``shear_stiffness`` G A in N makes it flexible in shear.
    """

    def __init__(
        self,
        segment: Segment,
        forces: Sequence[tuple[float, float]],
        load: float,
        shear_stiffness: float = np.inf,
    ) -> None:
        a, b = (support.x for support in segment.supports)
        total = sum(force for _, force in forces) + load * segment.length
        turning = sum(force * (x - a) for x, force in forces) + load * segment.length * (
            0.5 * (segment.start + segment.end) - a
        )
        at_b = -turning / (b - a)
        self.forces = [(a, -total - at_b), (b, at_b), *forces]
        self.load, self.start = load, segment.start
        self.bending_stiffness, self.shear_stiffness = segment.bending_stiffness, shear_stiffness
        self.line = (0.0, 0.0)
        slope = (self.deflection(b) - self.deflection(a)) / (b - a)
        self.line = (self.deflection(a) - slope * a, slope)

    def deflection(self, x: float) -> float:
        """EI w'''' = q + Σ P δ and G A w_s'' = −(q + Σ P δ), both zero at the supports."""
        run = x - self.start
        cubes = self.load * run**4 / 24.0
        ramps = self.load * run**2 / 2.0
        for place, force in self.forces:
            arm = max(x - place, 0.0)
            cubes += force * arm**3 / 6.0
            ramps += force * arm
        constant, slope = self.line
        return cubes / self.bending_stiffness - ramps / self.shear_stiffness - constant - slope * x


class Span:
    """Four solutions of EI w'''' = m ω² w on [a, b], each at most 1 there, and derivatives."""

    def __init__(self, segment: Segment, a: float, b: float, omega: float) -> None:
        self.a, self.b, self.bending_stiffness = a, b, segment.bending_stiffness
        self.beta = (segment.mass_per_length * omega**2 / segment.bending_stiffness) ** 0.25

    def derivative(self, x: float, order: int) -> Array:
        """(4,) derivative of each solution at x."""
        angle = self.beta * (x - self.a)
        quarters = 0.5 * np.pi * order
        cosine, sine = np.cos(angle + quarters), np.sin(angle + quarters)
        fading = (-1.0) ** order * np.exp(-angle)
        growing = np.exp(self.beta * (x - self.b))
        return self.beta**order * np.array([cosine, sine, fading, growing])

    def forces(self, x: float) -> Array:
        """(2, 4) shear force and moment of each solution at x, on the part beyond it."""
        shear, moment = self.derivative(x, 3), self.derivative(x, 2)
        return self.bending_stiffness * np.array([shear, -moment])


def bonded_determinant(boom: Boom, omega: float) -> float:
    """Return a determinant, up to a positive factor, of the bonded boom's exact equations at ω.

    A span between supports, stations and ends has the dynamic stiffness F U⁻¹, with the forces F
    and the displacements U of its four solutions at its ends. Both segments have equal deflections
    at the stations, and slopes of their own. The determinants of U remove the poles.
    """
    held = [support.x for support in boom.segments[0].supports]
    tail, head = boom.joints[0].stations
    runs = (*held, tail, head), (tail, head, boom.tip)
    free = [tail, head, boom.tip, *((number, x) for number in (0, 1) for x in runs[number])]
    index = {place: number for number, place in enumerate(free + held)}
    whole, factors = np.zeros((len(index), len(index))), []
    for number, (segment, places) in enumerate(zip(boom.segments, runs, strict=True)):
        for a, b in pairwise(places):
            span = Span(segment, a, b, omega)
            moved = np.array([span.derivative(x, order) for x in (a, b) for order in (0, 1)])
            forces = np.concatenate([span.forces(a), -span.forces(b)])
            at = [index[place] for place in (a, (number, a), b, (number, b))]
            whole[np.ix_(at, at)] += forces @ np.linalg.inv(moved)
            factors.append(moved)
    dofs = slice(len(free))
    signs, logarithms = zip(*map(np.linalg.slogdet, (whole[dofs, dofs], *factors)), strict=True)
    return float(np.prod(signs) * np.exp(np.sum(logarithms)))


def bonded_frequencies(boom: Boom, highest: float) -> Array:
    """Return the exact natural frequencies of the bonded boom in Hz, up to ``highest``."""
    lowest, largest = 2.0 * np.pi * 0.5, 2.0 * np.pi * highest
    found = roots(partial(bonded_determinant, boom), lowest, largest)
    return np.array(found) / (2.0 * np.pi)


def roots(function: Callable[[float], float], low: float, high: float) -> list[float]:
    """Return the ascending roots of a function in an interval; it must exceed 600 times their
    distance.
    """
    grid = np.linspace(low, high, 600)
    values = np.array([function(place) for place in grid])
    (changes,) = np.nonzero(np.sign(values[:-1]) != np.sign(values[1:]))
    return [float(brentq(function, grid[k], grid[k + 1], xtol=1e-13)) for k in changes]


def frequencies(model: Component) -> Array:
    """Return ω of the elastic modes in rad/s."""
    modes = natural_modes(model.stiffness, model.mass, model.rigid_modes)
    return np.sqrt(modes.omega2[model.rigid_modes :])

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Comparison with measurements, published benchmarks and other programs.

``docs/validation.md`` contains the results. It also lists published results that this program
cannot compute, with reasons.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import NamedTuple, cast

import numpy as np
from scipy.optimize import brentq

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import DryFriction, Gap, PowerContact
from protractile.dynamics.excitation import Excitation, Sine
from protractile.dynamics.gap_system import GapSystem, Observer
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Joint, Material, PointMass, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.runs.measured.fit import fit
from protractile.shell_model.segment.forms import DRILLING_OF_CURVED
from studies.reference_models.benchmarks import X, Y, Z, grid
from studies.reference_models.single_segment import natural_frequencies
from studies.reference_models.static_shell import StaticShell, hold
from studies.study import Kind, Piece, Progress, Verification, define_study

# DROPBEAR: the size of the beam in m, and the assumed mass in kg of sensors at its free end.
BEAM_LENGTH, BEAM_WIDTH, BEAM_THICKNESS = 0.501, 0.051, 0.00666
BEAM_STEEL = Material(2.0e11, 0.3, 7850.0)
ACCELEROMETERS = 0.06
# Mean transducer voltages at six roller positions in V, and measured first frequencies in Hz with
# their relative uncertainty, which is assumed.
VOLTS = np.array([1.23, 1.65, 2.08, 2.50, 2.94, 3.37])
MEASURED = np.array([26.4, 28.15, 30.8, 33.9, 37.5, 41.95])
UNCERTAINTY = 0.005
DROPBEAR = "DROPBEAR data set 8, Vereen et al. 2023"

# The boom lift of MathWorks: length, height, width and wall of its boxes in feet, from base to fly.
FOOT = 0.3048
BOXES = (
    (16.7, 1.055, 0.825, 0.02082), (15.7, 0.8745, 0.6585, 0.02802), (14.69, 0.757, 0.5335, 0.02109),
)  # fmt: skip
ALUMINIUM = Material(70.0e9, 0.33, 2700.0)
# Fractions of the fly that are retracted, and the first frequencies in Hz that a chart gives.
RETRACTED, CHART = (0.05, 0.35), (0.89, 1.40)
# Stiffness factor of rigid pieces, and length in m over which they overlap their neighbours.
RIGID, GRIP = 30.0, 0.1
BOOM_LIFT = "Simscape boom lift, MathWorks 2023"

# NAFEMS R0015: side of the square in m, and its material.
SIDE, NAFEMS_STEEL = 10.0, Material(200.0e9, 0.3, 8000.0)


@define_study("validation", "Measurements, published benchmarks and other programs")
def study(progress: Progress) -> Iterator[Piece]:
    """Yield all comparisons; comparisons with measurements are first."""
    for what, rows in (
        ("a measured beam on a moving roller", moving_roller),
        ("a boom lift", boom_lift),
        ("Code_Aster's friction and impact", code_aster),
        ("NAFEMS' plates", nafems),
    ):
        progress(what)
        yield from rows()


def moving_roller() -> Iterator[Verification]:
    """Compare the first frequency of a beam at several roller positions with measurements.

    The position is x = offset + scale · voltage, with fitted offset and scale.
    """

    def frequencies(parameters: Array) -> Array:
        return np.array([roller_frequency(x) for x in parameters[0] + parameters[1] * VOLTS])

    roller = fit(
        lambda parameters: (frequencies(parameters) / MEASURED - 1.0) / UNCERTAINTY,
        [-0.06, 0.02],
        [0.05, 0.09],
        [-0.02, 0.06],
    )
    assert roller.determined.all()
    offset, scale = roller.values
    for volt, value, reference in zip(VOLTS, frequencies(roller.values), MEASURED, strict=True):
        what = f"first frequency, roller at {1e3 * (offset + scale * volt):.0f} mm"
        yield Verification(what, value, reference, "Hz", "measured", DROPBEAR, 0.02)


def roller_frequency(x: float) -> float:
    """Return the first frequency in Hz of the clamped beam with a roller at x in m."""
    steel, area = BEAM_STEEL, BEAM_WIDTH * BEAM_THICKNESS
    second = BEAM_WIDTH * BEAM_THICKNESS**3 / 12.0
    beam = Segment(
        "beam", 0.0, BEAM_LENGTH, steel, steel.density * area, second, steel.density * second,
        supports=(Support(0.0, "clamped"), Support(x)),
        masses=(PointMass(BEAM_LENGTH, ACCELEROMETERS),),
    )  # fmt: skip
    return _first_frequency(Boom((beam,), ()), 0.05, rotary_inertia=True)


def boom_lift() -> Iterator[Verification]:
    """Compare the first frequency of the retracted boom lift with another program.

    The tip mass is fitted to the frequency of the extended boom lift.
    """
    mass = brentq(lambda mass: lift_frequency(RETRACTED[0], mass) - CHART[0], 10.0, 2000.0)
    what = f"first frequency, {100 * RETRACTED[1]:g} % retracted, {mass:.0f} kg at the tip"
    value = lift_frequency(RETRACTED[1], mass)
    yield Verification(what, value, CHART[1], "Hz", "other code", BOOM_LIFT, 0.05)


def lift_frequency(retracted: float, mass: float) -> float:
    """Return the first frequency in Hz for a retracted fraction of the fly and a tip mass in kg."""
    boxes = [
        (FOOT * length, BoxSection(*(FOOT * (size - wall) for size in sizes), *[FOOT * wall] * 2))
        for length, *sizes, wall in BOXES
    ]
    lap, far = retracted * boxes[-1][0], len(boxes) - 1
    # Length, section, and sections together, of a flexible piece and of the rigid one behind it.
    pieces: list[tuple[float, float, float]] = []
    for number, (length, box) in enumerate(boxes):
        area = box.area
        free = length - lap * (1 if number in (0, far) else 2)
        pieces.append((free, box.second_moment_of_area, area))
        if number < far:
            pieces.append(
                (lap, RIGID * box.second_moment_of_area, area + boxes[number + 1][1].area)
            )
    ends = np.cumsum([0.0, *(length for length, _, _ in pieces)])
    segments = []
    for number, (_, second, area) in enumerate(pieces):
        # Rigid pieces overlap their neighbours.
        start, end = ends[number] - GRIP * (number % 2), ends[number + 1] + GRIP * (number % 2)
        tip = number == len(pieces) - 1
        segments.append(
            Segment(
                f"piece {number}", float(start), float(end), ALUMINIUM, ALUMINIUM.density * area,
                second, 0.0, supports=() if number else (Support(0.0, "clamped"),),
                masses=(PointMass(float(end), mass),) if tip else (),
            )
        )  # fmt: skip
    joints = [
        Joint(number, number + 1, (inner.start, outer.end), 0.0, bonded=True)
        for number, (outer, inner) in enumerate(pairwise(segments))
    ]
    boom = Boom(tuple(segments), tuple(joints))
    return _first_frequency(boom, 0.25, rotary_inertia=False)


class Oscillators(NamedTuple):
    """Masses on springs on an accelerated base, with displacements relative to the base."""

    mass: float  #: mass of each oscillator in kg
    stiffness: float  #: stiffness of each spring in N/m
    accelerations: Sequence[float]  #: amplitude of the base acceleration of each in m/s²
    frequency: float  #: frequency of the bases in Hz
    damping_ratio: float = 0.0

    def system(self, friction: float = 0.0, laws: Sequence[Gap] = ()) -> GapSystem:
        """Return the system of masses, with friction in N and contact laws of the first mass.

        With a second mass, the approach is the sum of both displacements.
        """
        n = len(self.accelerations)
        scale = 1.0 / np.sqrt(self.mass)
        omega2 = np.full(n, self.stiffness / self.mass)
        push = -np.sqrt(self.mass) * np.asarray(self.accelerations)
        row = scale * np.array([1.0, -1.0][:n])
        rubs = [DryFriction(1.0, 0, friction)] if friction else []
        return GapSystem(
            omega2=omega2,
            load=np.zeros(n),
            rows=np.tile(row, (len(laws), 1)).reshape(len(laws), n),
            laws=list(laws),
            station_of_row=np.zeros(len(laws), dtype=np.int64),
            stations=[0.0],
            observers={f"x{i}": Observer(scale * one) for i, one in enumerate(np.eye(n))},
            excitations=[Excitation(push, Sine(self.frequency))],
            damping=2.0 * self.damping_ratio * np.sqrt(omega2),
            frictions=rubs,
            friction_rows=np.tile(scale * np.eye(n)[0], (len(rubs), 1)).reshape(len(rubs), n),
        )


def code_aster() -> Iterator[Verification]:
    """Compare SDND100, 102 and 104 of Code_Aster's validation manual V5.01."""
    yield from released_slider()
    yield impact_pair()
    yield from rubbing_mass()


def released_slider() -> Iterator[Verification]:
    """Compare the turning points of 1 kg on 1e4 N/m under 1 N of friction (SDND100)."""
    slider = Oscillators(1.0, 1.0e4, [0.0], 1.0).system(friction=1.0)
    half = np.pi / 100.0
    run = FixedStep(half / 1000.0)(Motion(slider, 4.0 * half, half, position=np.array([0.85e-3])))
    for turn, value in enumerate(run.data["x0"].values[1:], start=1):
        reference = (-1.0) ** turn * (0.85 - 0.2 * turn)
        what = f"SDND100, turning point {turn} of a slider"
        source = "r₀ − 2 n μN/k, Code_Aster V5.01.100"
        yield Verification(what, 1e3 * float(value), reference, "mm", "analytic", source, 1.0e-4)


def impact_pair() -> Verification:
    """Compare one oscillator against a wall with two that collide (SDND102)."""
    wall, pair = PowerContact(5.76e7, 1.0), PowerContact(2.88e7, 1.0)
    one = Oscillators(25.0, 98696.0, [1.0], 10.0, 0.07).system(
        laws=[wall.upper().with_clearance(5.0e-4)]
    )
    both = Oscillators(25.0, 98696.0, [1.0, -1.0], 10.0, 0.07).system(
        laws=[pair.upper().with_clearance(1.0e-3)]
    )
    runs = [FixedStep(1.0e-5)(Motion(system, 1.0, 1.0e-3)).data for system in (one, both)]
    single, mutual = (run["x0"].values for run in runs)
    value = float(np.abs(single - mutual).max() / np.ptp(single))
    what = "SDND102, one of two colliding oscillators off one against a wall, part of range"
    return Verification(what, value, 0.0, "", "analytic", "symmetry, Code_Aster V5.01.102", 1.0e-6)


def rubbing_mass() -> Iterator[Verification]:
    """Compare the mean wear power of 1 kg on a shaken plane, from 4 to 12 s (SDND104).

    The power is the friction force, μ = 0.1 times 10 N, times the sliding speed.
    """
    for amplitude, reference in ((15.0, 15.2671), (1.5, 0.409062), (1.01, 2.26164e-4), (0.99, 0.0)):
        system = Oscillators(1.0, 0.0, [amplitude], 1.0).system(friction=1.0)
        loss = FixedStep(1.0e-4)(Motion(system, 12.0, 0.01)).data["friction_loss"].values
        wear = float(loss[-1] - loss[400]) / 8.0 / 0.1
        what = f"SDND104, power of wear at {amplitude:g} m/s²"
        source = "stick and slip in turn, Code_Aster V5.01.104"
        yield Verification(what, wear, reference, "W", "external", source, 5.0e-3)


def nafems() -> Iterator[Verification]:
    """Compare FV12, FV32 and FV52 of NAFEMS R0015 with the shell.

    The reference of FV52 has an error of 2 %: a model of 4 × 4 × 1 bricks with fixed lower edges.
    """
    for name, values, kind, source, references, allowed in (
        ("FV12, free thin plate", free_plate(), "external", "NAFEMS R0015, closed form",
         (1.622, 2.360, 2.922, 4.233, 4.233, 7.416), 0.01),
        ("FV32, tapered membrane", tapered_membrane(), "external", "NAFEMS R0015",
         (44.623, 130.03, 162.70, 246.05, 379.90, 391.44), 0.01),
        ("FV52, thick plate", thick_plate(), "other code", "NAFEMS, Code_Aster V2.03.502",
         (44.762, 110.52, 110.52, 169.08, 193.93), 0.05),
    ):  # fmt: skip
        for mode, (value, reference) in enumerate(zip(values, references, strict=True), start=1):
            what = f"{name}, elastic mode {mode}"
            yield Verification(
                what, float(value), reference, "Hz", cast(Kind, kind), source, allowed
            )


def free_plate(edges: int = 32) -> Array:
    """Return six elastic frequencies in Hz of a free plate of 0.05 m, in transverse motion."""
    shell = _plate(edges, 0.05)
    held = hold(shell.node_dofs[:, [X, Y]]) | hold(shell.rotation_dofs[:, [Z]])
    return natural_frequencies(shell.held(held), 9)[3:]


def tapered_membrane(edges: int = 32) -> Array:
    """Return six frequencies in Hz of a membrane that tapers from 5 m at the support to 1 m."""
    shell = _plate(edges, 0.05, (5.0, 1.0))
    held = hold(shell.node_dofs[:, [Z]]) | hold(shell.rotation_dofs[:, [X, Y]])
    return natural_frequencies(shell.held(held | shell.hold_at(X, 0.0, [X, Y])), 6)


def thick_plate(edges: int = 32) -> Array:
    """Return five elastic frequencies in Hz of a plate of 1 m with supported edges."""
    shell = _plate(edges, 1.0)
    held: dict[int, float] = {}
    for axis, place in ((X, 0.0), (X, SIDE), (Y, -0.5 * SIDE), (Y, 0.5 * SIDE)):
        held |= shell.hold_at(axis, place, [Z])
    return natural_frequencies(shell.held(held), 8)[3:]


def _plate(edges: int, thickness: float, widths: tuple[float, float] = (SIDE, SIDE)) -> StaticShell:
    """Return a plate on [0, SIDE], whose width changes linearly between two values."""

    def surface(x: Array, y: Array) -> Array:
        width = widths[0] + (widths[1] - widths[0]) * x
        return np.stack([SIDE * x, width * (y - 0.5), np.zeros_like(x)], axis=1)

    return StaticShell(*grid(surface, edges, edges), thickness, NAFEMS_STEEL, DRILLING_OF_CURVED)


def _first_frequency(boom: Boom, length: float, rotary_inertia: bool) -> float:
    """Return the lowest frequency in Hz of a boom by Euler-Bernoulli elements of a length in m."""
    models = finite_element_segments(boom, length, "euler-bernoulli", rotary_inertia)
    return float(gap_system(boom, models).frequencies[0])

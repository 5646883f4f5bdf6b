# SPDX-License-Identifier: LGPL-3.0-or-later
"""References of results: a row has a result, its value, a tolerance, the kind of reference and its
source. A new reference is a row.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from math import hypot, pi, sqrt
from typing import Any, Literal, NamedTuple

import numpy as np
import pytest

import protractile as pt
from protractile.analysis.fatigue import Life, count_stress_ranges, endurance, life_rows
from protractile.analysis.measure import Measured
from protractile.analysis.plate_buckling import normal_coefficient, panel_factor, winter
from protractile.analysis.rows import INITIAL
from protractile.beam_model.static_model import estimate_critical_factor
from protractile.beam_model.statics import static_state
from tests.beam_model.exact import beam
from tests.booms import ARM, PAD, STEEL, cantilever, force, telescope


class Reference(NamedTuple):
    """Result of the program and what it should be."""

    what: str
    found: Callable[[], Any]
    value: Any
    tolerance: float  #: relative
    kind: Literal["analytic", "external", "other code", "non-regression"]
    source: str


@cache
def _rows(boom: pt.Boom) -> pt.Rows:
    return pt.statics(boom).rows.where(state=INITIAL)


def result(boom: pt.Boom, quantity: str, part: str, place: str = "") -> Callable[[], float]:
    """Return the static value of a quantity at t = 0."""

    def found() -> float:
        (row,) = _rows(boom).where(quantity=quantity, part=part, place=place)
        return row.value

    return found


def reactions(boom: pt.Boom) -> Callable[[], list[float]]:
    """Return forces and moments of supports, lugs and stations at rest, by x."""
    return lambda: [f for r in static_state(boom).reactions for f in (r.force, r.moment)]


LENGTH, FORCE = 8.0, -5.0e3
TIP = cantilever(force("arm", LENGTH, FORCE))
(SEGMENT,) = TIP.segments
EJ, GA, J = SEGMENT.bending_stiffness, SEGMENT.shear_stiffness, ARM.second_moment_of_area
FIBRE = 0.5 * (ARM.height + ARM.flange)
UNIFORM = cantilever(load=-300.0)
TURNED = cantilever(pt.Moment("arm", "z", 900.0, x=LENGTH, history=pt.Step()))
PULLED = telescope(force("fly", 14.0, -1000.0))
# The centres of the pads of 0.1 m are within the overlap.
ON_HEAD, ON_TAIL = 1000.0 * 7.95 / 1.9, 1000.0 * 6.05 / 1.9
HELD = beam(supports=[pt.Support(3.0, "clamped")], load=-100.0, masses=(pt.PointMass(8.0, 50.0),))
LOADED = pt.Boom(
    [HELD],
    loads=[
        force("beam", 8.0, -2000.0),
        pt.PartialLoad("beam", "z", -300.0, x=None, history=pt.Step(), span=(5.0, 7.0)),
        pt.Moment("beam", "z", 400.0, x=6.0, history=pt.Step()),
        force("beam", 8.0, -1.0e6, history=pt.Ramp(1.0)),
    ],
)
SPANS = pt.Boom([beam(supports=[3.0, 5.5, 8.0], load=-100.0, section=None)])
JACK = pt.Cylinder(0, 5.0, depth=0.3, ground=(5.0, -2.0), stiffness=1.0e7)
LIFTED = pt.Boom([beam(supports=[3.0], load=-100.0)], cylinders=[JACK])

STATICS = (
    Reference("tip under a force", result(TIP, "tip", "tip"),
              FORCE * LENGTH**3 / (3.0 * EJ) + FORCE * LENGTH / GA, 1e-6, "analytic",
              "Timoshenko 1955"),
    Reference("its moment at the clamp", result(TIP, "support_moment", "arm", "at 0 m"),
              -FORCE * LENGTH, 1e-6, "analytic", "statics"),
    Reference("its reaction", result(TIP, "reaction", "arm", "at 0 m"), -FORCE, 1e-6, "analytic",
              "statics"),
    Reference("tip under a uniform load", result(UNIFORM, "tip", "tip"),
              -300.0 * LENGTH**4 / (8.0 * EJ) - 300.0 * LENGTH**2 / (2.0 * GA), 1e-6, "analytic",
              "Timoshenko 1955"),
    Reference("its moment at the clamp", result(UNIFORM, "bending_moment", "arm"),
              300.0 * LENGTH**2 / 2.0, 2e-3, "analytic", "statics; elements of L/20"),
    Reference("tip under a moment", result(TURNED, "tip", "tip"), 900.0 * LENGTH**2 / (2.0 * EJ),
              1e-6, "analytic", "Timoshenko 1955"),
    Reference("a clamp under all kinds of loads", reactions(LOADED),
              [3100.0, 500.0 * 2.5 + 2000.0 * 5.0 + 600.0 * 3.0 - 400.0], 1e-6, "analytic",
              "statics; a mass has no weight, and a ramp is 0 at t = 0"),
    Reference("three supports of two spans", reactions(SPANS),
              [93.75, 0.0, 312.5, 0.0, 93.75, 0.0], 1e-6, "analytic", "5/4 q L in the middle"),
    Reference("a hinge and an upright cylinder", reactions(LIFTED), [-125.0, 0.0, 625.0, 0.0],
              1e-5, "analytic", "500 N at 2.5 m about the hinge, 2 m from the cylinder"),
)  # fmt: skip
CONTACT = (
    Reference("force of the head's station",
              result(PULLED, "contact_force", "fly", "station 2"), -ON_HEAD, 1e-6, "analytic",
              "lever rule between the centres of pads"),
    Reference("force of the tail's station",
              result(PULLED, "contact_force", "fly", "station 1"), ON_TAIL, 1e-6, "analytic",
              "lever rule between the centres of pads"),
    Reference("penetration of the head's pads",
              result(PULLED, "penetration", "fly", "station 2"),
              ON_HEAD / (2.0 * 2e9 * PAD.area / 0.02), 1e-6, "analytic", "E A/t of both pads"),
)  # fmt: skip
PADS = (
    Reference("force of a pad at the head",
              result(PULLED, "pad_force", "fly", "station 2, below"), 0.5 * ON_HEAD, 1e-6,
              "analytic", "a pair carries the force of a side"),
    Reference("force of the pad on the other side",
              result(PULLED, "pad_force", "fly", "station 2, above"), 0.0, 1e-6, "analytic",
              "contacts only press"),
    Reference("its pressure", result(PULLED, "pad_pressure", "fly", "station 1, above"),
              0.5 * ON_TAIL / 0.008, 1e-6, "analytic", "force over area"),
)  # fmt: skip
STRESSES = (
    Reference("outer fibre at the clamp", lambda: abs(result(TIP, "stress", "arm")()),
              -FORCE * LENGTH * FIBRE / J, 1e-6, "analytic", "M z/J"),
    Reference("under axial force, too",
              lambda: result(cantilever(thrust=2e5), "stress", "arm")(), -2e5 / ARM.area, 1e-6,
              "analytic", "N/A"),
)  # fmt: skip

SLENDERNESS = 80.0
UNIT = pi**2 * 2.1e11 / (12.0 * 0.91) / SLENDERNESS**2


def factor(first: float, second: float, shear: float = 0.0) -> Callable[[], float]:
    """Return the buckling factor of a panel under stresses at its edges, in units of σ_E."""
    edges = first * UNIT, second * UNIT
    return lambda: panel_factor(STEEL, SLENDERNESS, edges, shear * UNIT)


EULER = pi**2 * EJ / (4.0 * LENGTH**2)
EN = "EN 1993-1-5"
BUCKLING = (
    *(
        Reference(f"coefficient for ψ = {ratio:g}", lambda ratio=ratio: normal_coefficient(ratio),
                  exact, 2e-3, "external", f"{EN}, table 4.1")
        for ratio, exact in ((1.0, 4.0), (0.0, 7.81), (-1.0, 23.88), (-2.0, 53.8), (-9.0, 95.7))
    ),
    *(
        Reference(f"stress alone, ψ = {ratio:g}", factor(*edges), normal_coefficient(ratio) / 0.3,
                  1e-12, "analytic", "k σ_E/σ, from either edge")
        for ratio in (1.0, 0.5, 0.0, -0.5, -1.0, -2.0)
        for edges in ((-0.3, -0.3 * ratio), (-0.3 * ratio, -0.3))
    ),
    Reference("compression and shear", factor(-2.0, -2.0, 2.136),
              1.0 / (0.25 + hypot(0.25, 0.4)), 1e-12, "analytic", f"{EN}, (10.6) for ψ = 1"),
    Reference("bending and shear", factor(-11.96, 11.96, 2.136), 1.0 / hypot(0.5, 0.4), 1e-12,
              "analytic", "a circle"),
    Reference("shear in tension", factor(1.0, 1.0, -5.34), 1.0, 1e-12, "analytic", "5.34"),
    Reference("tension", factor(1.0, 1.0), np.inf, 0.0, "analytic", "buckles never"),
    *(
        Reference(f"reduction at {slenderness:g}, ψ = {ratio:g}",
                  lambda at=(slenderness, ratio): winter(*at), reduction, off, "analytic",
                  f"{EN}, 4.4, by hand; 0.673 and 0.874 end its plateaus")
        for slenderness, ratio, reduction, off in (
            (0.673, 1.0, 1.0, 1e-3), (1.0, 1.0, 0.78, 1e-9), (2.0, 1.0, 0.445, 1e-9),
            (1.0, 0.0, 0.835, 1e-9), (2.0, -1.0, 0.4725, 1e-9), (0.874, -1.0, 1.0, 1e-3),
        )
    ),
    Reference("a cantilever under axial force",
              lambda: estimate_critical_factor(cantilever(thrust=1e5)),
              1e-5 / (1.0 / EULER + 1.0 / GA), 1e-4, "analytic", "Euler 1744, Engesser 1891"),
)  # fmt: skip


def frequency(boom: pt.Boom) -> Callable[[], float]:
    return lambda: pt.modes(boom).rows.where(state=INITIAL)[0].value


def shape() -> Any:
    (first,) = pt.modes(cantilever()).curves.where(state="mode 1")
    return list(first.values["deflection"][[0, -1]])


SLENDER = pt.Material(2.1e11, -0.999, 7850.0)
SPEED = sqrt(EJ / SEGMENT.mass_per_length) / LENGTH**2 / (2.0 * pi)
FREQUENCIES = (
    Reference("a cantilever", frequency(cantilever()), 0.99 * 3.51602 * SPEED, 1e-2, "analytic",
              "(βL)² = 3.51602; shear lowers it by less than 2 %"),
    Reference("ends of its shape", shape, [0.0, 1.0], 1e-9, "analytic", "the largest value is 1"),
    Reference("of a stiff web", frequency(cantilever(material=SLENDER)), 3.51602 * SPEED, 3e-3,
              "analytic", "(βL)² = 3.51602; a shear modulus of 500 E; rotary inertia"),
)  # fmt: skip


def life(stress: Sequence[float], *numbers: Any) -> dict[str, float]:
    """Return the values of the rows of a stress history in Pa at x = 2 m."""
    pytest.importorskip("rainflow", reason="the cycles are counted by it")
    history = np.array(stress)[:, None]
    measured = Measured("stress", "arm", "", history, None, (np.array([2.0]),) * 3)
    return {row.quantity: row.value for row in life_rows([measured], "beam", True, Life(*numbers))}


def counted(start: int) -> dict[float, float]:
    """Return how often each range occurs in the history of the standard, from a reversal on."""
    pytest.importorskip("rainflow", reason="the cycles are counted by it")
    stress = np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0])
    sizes, counts = count_stress_ranges(np.roll(stress, start))
    return {size: counts[sizes == size].sum() for size in sizes.tolist()}


SINE = (50e6 * np.cos(2.0 * np.pi * np.linspace(0.0, 10.0, 4001))).tolist()
RISE = [
    *(100e6 * np.minimum(np.linspace(0.0, 2.0, 401), 1.0)[:201]),
    *np.resize([1e8, 9.999e7], 200),
]
OF_SINE: Mapping[str, float] = {
    "cycles": 10.0, "stress_range": 100e6, "equivalent_range": 100e6 * 10.0 ** (1.0 / 3.0),
    "run_damage": 10.0 / 2e6 * (115.0 / 71.0) ** 3,
    "damage": 0.1 * (115.0 / 71.0) ** 3,
}  # fmt: skip
ASTM = "ASTM E1049-85, figure 7 for repeated histories"
DETAIL = "EN 1993-1-9, 7.1"
FATIGUE = (
    *(
        Reference(f"cycles from reversal {start} on", lambda start=start: counted(start),
                  {3.0: 1.0, 4.0: 1.0, 7.0: 1.0, 9.0: 1.0}, 0.0, "external", ASTM)
        for start in range(8)
    ),
    Reference("endurance of category 71",
              lambda: endurance(1e6 * np.array([142.0, 71.0, 52.31, 40.0, 28.74, 28.70]), 71e6),
              [2.5e5, 2e6, 5e6, 5e6 * (52.31 / 40.0) ** 5, 1e8, np.inf], 1e-3, "external", DETAIL),
    *(
        Reference(f"{name} of ten sines", lambda name=name: life(SINE, 71.0, 1.15, 20_000)[name],
                  value, 1e-6, "analytic", DETAIL)
        for name, value in OF_SINE.items()
    ),
    Reference("damage of a rise with noise", lambda: life(RISE, 71.0, 1.0, 20_000)["damage"],
              0.01 * (100.0 / 71.0) ** 3, 1e-6, "analytic", "a repetition also unloads"),
    Reference("a history that rests", lambda: life([0.0] * 5),
              {"cycles": 0.0, "stress_range": 0.0, "equivalent_range": 0.0}, 0.0, "analytic",
              "ranges alone without a category"),
)  # fmt: skip


def proof(quantity: str, **keys: Any) -> Callable[[], tuple[float, float | None]]:
    """Return value and limit of the governing proof of the cantilever in two cases."""

    def found() -> tuple[float, float | None]:
        cases = {"far": [force("arm", LENGTH, 3.0 * FORCE)],
                 "near": [force("arm", 0.5 * LENGTH, 3.0 * FORCE)]}  # fmt: skip
        (row,) = pt.prove(TIP, cases, requested=[quantity], **keys)
        assert row.state == "combination far"
        return row.value, row.limit

    return found


COMBINATIONS = (
    Reference("strength", proof("yield", resistance=pt.Resistance(material=2.0)),
              [4.02 * -FORCE * LENGTH * FIBRE / J, 355e6 / 2.0], 6e-3, "analytic",
              "M z/J; shear adds less than 1 %"),
    Reference("tip", proof("deflection", permitted_tip=0.5),
              [4.0 * abs(STATICS[0].value), 0.5], 1e-6, "analytic", "superposition"),
)  # fmt: skip

TABLES = STATICS, CONTACT, PADS, STRESSES, BUCKLING, FREQUENCIES, FATIGUE, COMBINATIONS


@pytest.mark.parametrize("reference", [row for table in TABLES for row in table],
                         ids=lambda reference: reference.what)  # fmt: skip
def test_a_result_is_its_reference(reference: Reference) -> None:
    found, value = reference.found(), reference.value
    size = np.abs(value).max() if isinstance(value, list) else 0.0
    assert found == pytest.approx(value, rel=reference.tolerance, abs=1e-6 * size + 1e-9)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Properties of any boom at rest, over series and elements, and some over coarse shells.

Reference of all: analytic, by symmetry, linearity, equilibrium or dimensions. A property compares
rows: deflections, contacts, pads, section forces, reactions and stresses.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st

import protractile as pt
from protractile.analysis.rows import Row, Rows
from protractile.dynamics.equilibrium import equilibrium
from protractile.geometry.axial import with_compression
from tests.booms import MODELS, rows_at_rest

# Each example solves two booms. A smaller example would tell no more than the first one.
FEW = settings(max_examples=3, phases=(Phase.explicit, Phase.generate))


@dataclass(frozen=True)
class Numbers:
    """Numbers of a telescope of two boxes in SI units."""

    length: float
    overlap: float
    height: float
    play: float
    part_above: float
    stiffness: float
    exponent: float
    tip: float
    uniform: float
    thrust: float
    kind: str
    lateral: float | None


def telescopes(spatial: bool = False) -> st.SearchStrategy[Numbers]:
    """Return telescopes with loads of any sign; in space if asked for."""
    plays = st.floats(0.004, 0.01)
    lateral = plays if spatial else st.none() | plays
    return st.builds(
        Numbers,
        length=st.floats(6.0, 9.0),
        overlap=st.floats(1.0, 2.0),
        height=st.floats(0.3, 0.5),
        play=st.floats(0.002, 0.012),
        part_above=st.floats(0.2, 0.8),
        stiffness=st.floats(1e8, 1e9),
        exponent=st.sampled_from([1.0, 1.5, 2.0]),
        tip=st.floats(1e3, 4e3) | st.floats(-4e3, -1e3),
        uniform=st.floats(-300.0, 300.0),
        thrust=st.sampled_from([0.0, 2e4]),
        kind=st.sampled_from(["clamped", "pinned", "cylinder"]),
        lateral=lateral,
    )


def boom_of(
    n: Numbers,
    m: float = 1.0,
    force: float = 1.0,
    s: float = 1.0,
    names: str = "arm fly",
    start: float = 0.0,
    up: float = 1.0,
    joints: int = 1,
) -> pt.Boom:
    """Return the boom of numbers in other units: ``m``, ``force``, ``s`` are the size of 1 m, 1 N
    and 1 s in them. It begins at ``start``, is upside down for ``up`` = −1, and its stations are
    in one joint or two.
    """
    pressure = force / m**2
    steel = pt.Material(
        2.1e11 * pressure, 0.3, 7850.0 * force * s**2 / m**4, yield_strength=3e8 * pressure
    )

    def box(height: float, flange: float, bottom: float) -> pt.BoxSection:
        if n.lateral is not None:
            bottom = flange  # a boom in space has sections that mirror themselves in z
        if up < 0.0:
            flange, bottom = bottom, flange
        return pt.BoxSection(
            height * m, 0.7 * height * m, flange * m, 0.006 * m, bottom_flange=bottom * m
        )

    def x(place: float) -> float:
        return (start + place) * m

    holds = {
        "clamped": (pt.Support(x(0.0), "clamped"),),
        "pinned": (pt.Support(x(0.0)), pt.Support(x(1.5), stiffness=3e7 * force / m)),
        "cylinder": (pt.Support(x(0.0), "hinged"),),
    }
    ends = (0.0, n.length), (n.length - n.overlap, 2.0 * n.length - n.overlap)
    first, second = names.split()
    segments: list[pt.Segment] = []
    for name, (low, high), section, more in (
        (first, ends[0], box(n.height, 0.009, 0.008), {"supports": holds[n.kind]}),
        (second, ends[1], box(n.height - 0.05, 0.006, 0.007),
         {"masses": (pt.PointMass(x(ends[1][1]), 120.0 * force * s**2 / m),)}),
    ):  # fmt: skip
        load = up * n.uniform * force / m
        part = pt.Segment.of_section(name, x(low), x(high), steel, section, load=load, **more)
        aside = (
            None if n.lateral is None else replace(part.lateral, load=0.3 * n.uniform * force / m)
        )
        segments.append(replace(part, lateral=aside))
    law = pt.PowerContact(
        n.stiffness * force / m**n.exponent, n.exponent,
        stiffness_below=0.7 * n.stiffness * force / m**n.exponent,
    )  # fmt: skip
    above = n.part_above * n.play
    stations = x(ends[1][0] + 0.1), x(ends[0][1])
    common: dict[str, Any] = {"play": n.play * m, "contact": law, "play_above": above * m}
    if up < 0.0:
        common["play_above"] = (n.play - above) * m
        common["contact"] = replace(law, stiffness=law.below, stiffness_below=law.stiffness)
    if n.lateral is not None:
        common |= {"lateral_play": n.lateral * m, "lateral_contact": law}
    groups = [stations] if joints == 1 else [(place,) for place in stations]
    ties = tuple(pt.Joint(0, 1, stations=group, **common) for group in groups)
    loads = [
        pt.Load(second, "z", up * n.tip * force, x=x(ends[1][1]), history=pt.Step()),
        pt.PartialLoad(
            first, "z", -up * 200.0 * force / m, x=None, history=pt.Step(), span=(x(2.0), x(3.0))
        ),
        pt.Moment(second, "z", up * 700.0 * force * m, x=x(ends[1][1] - 1.0), history=pt.Step()),
    ]
    if n.lateral is not None:
        loads.append(pt.Load(second, "y", 0.4 * n.tip * force, x=x(ends[1][1]), history=pt.Step()))
    cylinders = ()
    if n.kind == "cylinder":
        ground = (x(0.5), -2.0 * up * m)
        jack = pt.Cylinder(first, x(2.0), depth=0.3 * up * m, ground=ground,
                           stiffness=5e8 * force / m)  # fmt: skip
        cylinders = (jack,)
    thrusts = [pt.Thrust(1, x=x(ends[1][1]), force=n.thrust * force)] if n.thrust else []
    pressed = with_compression(segments, ties, thrusts)
    return pt.Boom(pressed, ties, loads, cylinders=cylinders)


Change = Callable[[Row], tuple[object, float]]


def agree(
    rows: Rows, others: Rows, change: Change = lambda row: (row.key, row.value), rel: float = 1e-6
) -> None:
    """Check that other rows are the changed ones: the key and the value that each should have.

    The tolerance is relative to the largest value of a unit, so that round-off of zeros is none.
    """
    sizes: dict[str, float] = {}
    for row in others:
        sizes[row.of.unit] = max(sizes.get(row.of.unit, 0.0), abs(row.value))
    expected = {(row.state, changed[0]): changed[1] for row in rows for changed in [change(row)]}
    found = {(row.state, row.key): row for row in others}
    assert found.keys() == expected.keys()
    for key, row in found.items():
        size = rel * sizes[row.of.unit]
        assert row.value == pytest.approx(expected[key], rel=rel, abs=size), key


def at_rest(kind: str, boom: pt.Boom, m: float = 1.0) -> Rows:
    """Return the rows of a model with elements of 1 m, of which 1 m is ``m`` units of length."""
    return rows_at_rest(MODELS[kind](boom, m), boom, frequencies=3)


EACH = pytest.mark.parametrize("kind", MODELS)
# Exponents of m, N and s in a unit of rows.
DIMENSIONS = {
    "m": (1, 0, 0), "N": (0, 1, 0), "N m": (1, 1, 0), "Pa": (-2, 1, 0), "Hz": (0, 0, -1),
    "rad": (0, 0, 0), "1": (0, 0, 0),
}  # fmt: skip


def in_units(m: float, force: float, s: float) -> Change:
    """Return the change of a row by other units, of which 1 m, 1 N and 1 s are these numbers."""

    def converted(row: Row) -> tuple[object, float]:
        length, newton, time = DIMENSIONS[row.of.unit]
        place = row.place
        if place.startswith("at "):
            place = f"at {float(place.split()[1]) * m:g} m"
        return (row.quantity, row.part, place), row.value * m**length * force**newton * s**time

    return converted


@EACH
@given(n=telescopes(), m=st.floats(0.5, 3.0), force=st.floats(0.1, 9.0), s=st.floats(0.3, 3.0))
@FEW
def test_results_have_the_dimensions_of_their_units(
    kind: str, n: Numbers, m: float, force: float, s: float
) -> None:
    """Any units of length, force and time give the same boom."""
    other = at_rest(kind, boom_of(n, m, force, s), m)
    agree(at_rest(kind, boom_of(n)), other, in_units(m, force, s), 1e-5)


ODD = {
    "tip", "contact_force", "bending_moment", "reaction", "support_moment", "rotation",
    "rotation_tip", "support_torque",
}  # fmt: skip


def agree_upside_down(rows: Rows, others: Rows, rel: float) -> None:
    """Check rows of a boom and of its mirror image in z. Opposite fibres may have one stress."""

    def mirrored(row: Row) -> tuple[object, float]:
        odd = row.quantity in ODD and "lateral" not in row.place
        return row.key, -row.value if odd else row.value

    upright, other = (
        Rows(r._replace(value=abs(r.value)) if r.quantity == "stress" else r for r in each)
        for each in (rows, others)
    )
    agree(upright, other, mirrored, rel)


@EACH
@given(n=telescopes())
@FEW
def test_upside_down_all_is_mirrored(kind: str, n: Numbers) -> None:
    agree_upside_down(at_rest(kind, boom_of(n)), at_rest(kind, boom_of(n, up=-1.0)), 1e-6)


def turned(boom: pt.Boom) -> pt.Boom:
    """Return the boom with y and z exchanged."""
    joints = tuple(
        replace(
            joint, play=joint.lateral_play, lateral_play=joint.play, play_above=None,
            lateral_play_right=joint.play_above, contact=joint.lateral_contact,
            lateral_contact=joint.contact,
        )
        for joint in boom.joints
    )  # fmt: skip
    loads = tuple(replace(one, direction="zy"["zy".index(one.direction) - 1]) for one in boom.loads)
    return replace(boom, segments=tuple(s.turned() for s in boom.segments), joints=joints,
                   loads=loads)  # fmt: skip


@EACH
@given(n=telescopes(spatial=True))
@FEW
def test_a_boom_on_its_side_does_the_same_on_its_side(kind: str, n: Numbers) -> None:
    """A moment about y becomes one about z, and the torque changes its sign."""
    boom = boom_of(replace(n, kind="clamped"))

    def on_its_side(row: Row) -> tuple[object, float]:
        names = {"tip": "tip_lateral", "reaction": "lateral_reaction",
                 "support_moment": "lateral_support_moment",
                 "bending_moment": "lateral_bending_moment"}  # fmt: skip
        names |= {there: here for here, there in names.items()}
        place = row.place
        if place.startswith("station") and row.quantity != "closed_play":
            place = place.removesuffix(", lateral") if "lateral" in place else f"{place}, lateral"
        sign = -1.0 if row.quantity == "support_torque" else 1.0
        return (names.get(row.quantity, row.quantity), row.part, place), sign * row.value

    planar = ("rotation", "rotation_tip", "closed_play")  # of the vertical plane alone
    rows, others = (
        Rows(row for row in at_rest(kind, each) if row.quantity not in planar)
        for each in (boom, turned(boom))
    )
    agree(rows, others, on_its_side)


@EACH
@given(n=telescopes(), part=st.floats(0.1, 0.9))
@FEW
def test_a_load_in_two_parts_is_the_load(kind: str, n: Numbers, part: float) -> None:
    """Forces are split by size, and loads along a span at a place within it."""
    boom = boom_of(n)
    parts: list[pt.Load] = []
    for load in boom.loads:
        if isinstance(load, pt.PartialLoad):
            low, high = load.span
            middle = low + part * (high - low)
            parts += [replace(load, span=span) for span in ((low, middle), (middle, high))]
        else:
            parts += [replace(load, magnitude=f * load.magnitude) for f in (part, 1.0 - part)]
    split = at_rest(kind, replace(boom, loads=tuple(parts)))
    # The place is an end of elements, which are shorter then; shear forces feel it most.
    of_shear = "reaction", "lateral_reaction", "foot_reaction", "support_moment"
    rows, others = (
        Rows(row for row in each if row.quantity not in of_shear)
        for each in (at_rest(kind, boom), split)
    )
    agree(rows, others, rel=1e-3)


@EACH
@given(n=telescopes(), factor=st.floats(-3.0, -0.1))
@FEW
def test_without_play_results_are_in_proportion_to_loads(
    kind: str, n: Numbers, factor: float
) -> None:
    """All but forces of a pin, of two components, and axial forces with their stresses."""
    boom = boom_of(replace(n, uniform=0.0)).bonded
    loads = [replace(load, magnitude=factor * load.magnitude) for load in boom.loads]
    others = "foot_reaction", "stress", "axial_reaction", "frequency"
    rows, scaled = (
        Rows(row for row in at_rest(kind, each) if row.quantity not in others)
        for each in (boom, replace(boom, loads=loads))
    )
    agree(rows, scaled, lambda row: (row.key, factor * row.value))


@EACH
@given(n=telescopes(), x=st.tuples(st.floats(0.1, 1.0), st.floats(0.1, 1.0)))
@FEW
def test_deflections_are_reciprocal(kind: str, n: Numbers, x: tuple[float, float]) -> None:
    """Reference: analytic, Betti (1872), for a force on the arm and one on the fly."""
    boom = boom_of(replace(n, uniform=0.0)).bonded
    at = [s.start + part * s.length for s, part in zip(boom.segments, x, strict=True)]
    seen = [pt.Observation(str(k), k, place) for k, place in enumerate(at)]
    moved = []
    for k in (0, 1):
        load = pt.Load(k, "z", 1e3, x=at[k], history=pt.Step())
        model = MODELS[kind](replace(boom, loads=(load,), observations=seen), 1.0)
        system = model.system().gather_loads()
        rest = equilibrium(system, system.load)
        moved.append([system.observers[one.name].row @ rest for one in seen])
    assert moved[0][1] == pytest.approx(moved[1][0], rel=1e-7, abs=1e-12)
    assert min(moved[0][0], moved[1][1]) > 0.0


@EACH
@given(n=telescopes(), start=st.floats(-5.0, 5.0))
@FEW
def test_names_order_joints_and_start_change_nothing(kind: str, n: Numbers, start: float) -> None:
    """The rotation in a joint needs two stations of it; with a thrust, joints are no others."""
    joints = 1 if n.thrust else 2
    other = boom_of(n, names="mast jib", start=start, joints=joints)
    names = {"arm": "mast", "fly": "jib"}

    def renamed(row: Row) -> tuple[object, float]:
        place = row.place.replace("in arm", "in mast")
        if place.startswith("at "):
            place = f"at {float(place.split()[1]) + start:g} m"
        return (row.quantity, names.get(row.part, row.part), place), row.value

    rows, others = (
        Rows(row for row in at_rest(kind, each) if not row.quantity.startswith("rotation"))
        for each in (boom_of(n), replace(other, loads=other.loads[::-1]))
    )
    agree(rows, others, renamed)


@given(n=telescopes())
@FEW
def test_reactions_balance_the_loads(n: Numbers) -> None:
    """Reference: analytic, forces and moments about x = 0, without axial forces. Between forces,
    shear forces of beams are exact without a uniform load.
    """
    n = replace(n, thrust=0.0, uniform=0.0)
    boom = boom_of(n)
    rows = at_rest("elements", boom)
    # Each load as its force and the x at which it acts.
    acting = [(load.magnitude, load.x) for load in boom.loads
              if load.direction == "z" and type(load) is pt.Load]  # fmt: skip
    acting += [(-200.0, 2.5)]
    reactions = [(r.value, float(r.place.split()[1])) for r in rows.where(quantity="reaction")
                 if r.state == "initial"]  # fmt: skip
    moments = [r.value for r in rows.where(quantity="support_moment", state="initial")]
    for row in rows.where(quantity="cylinder_force", state="initial"):
        (jack,) = boom.cylinders
        line = np.array([jack.x, -jack.depth]) - jack.ground
        across, along = row.value * line[1] / np.hypot(*line), row.value * line[0] / np.hypot(*line)
        reactions.append((across, jack.x))
        # The pin is on the axis, and the lug below it.
        moments.append(along * jack.depth)
    size = sum(abs(force) for force, _ in acting)
    assert sum(force for force, _ in acting + reactions) == pytest.approx(0.0, abs=1e-5 * size)
    turning = sum(force * x for force, x in acting + reactions) + 700.0 + sum(moments)
    assert turning == pytest.approx(0.0, abs=1e-5 * size * boom.tip)


@EACH
@given(n=telescopes(), pads=st.lists(st.floats(0.02, 0.05), min_size=2, max_size=2))
@FEW
def test_pads_share_the_force_of_their_station(kind: str, n: Numbers, pads: list[float]) -> None:
    """Two pads on a side carry its force as each is stiff, and press as they are wide."""
    boom = boom_of(replace(n, lateral=None, thrust=0.0))
    (joint,) = boom.joints
    several = tuple(
        pt.SlidePad(length=0.1, width=width, side=side, thickness=0.02, offset=0.05 * k)
        for side in ("above", "below")
        for k, width in enumerate(pads)
    )
    padded = replace(boom, joints=(replace(joint, contact=None, pads=several, play_above=None),))
    rows = at_rest(kind, padded)
    for station in ("station 1", "station 2"):
        (force,) = rows.where(quantity="contact_force", place=station, state="initial")
        side = "above" if force.value > 0.0 else "below"
        loaded = [
            rows.where(quantity="pad_force", place=f"{station}, {side}{number}", state="initial")[0]
            for number in ("", " 2")
        ]
        assert 2.0 * sum(row.value for row in loaded) == pytest.approx(abs(force.value), rel=1e-6)
        assert loaded[0].value / loaded[1].value == pytest.approx(pads[0] / pads[1], rel=1e-6)
        pressed = rows.where(quantity="pad_pressure", place=f"{station}, {side}", state="initial")
        assert pressed[0].value == pytest.approx(loaded[0].value / (0.1 * pads[0]), rel=1e-9)


SHORT = Numbers(
    length=3.0, overlap=1.0, height=0.4, play=0.006, part_above=0.3, stiffness=3e8, exponent=1.0,
    tip=-3e3, uniform=-200.0, thrust=0.0, kind="clamped", lateral=None,
)  # fmt: skip


def shell_at_rest(boom: pt.Boom, m: float = 1.0) -> Rows:
    """Return the rows of a coarse shell with edges of 0.4 m, of which 1 m is ``m`` units."""
    shell = pt.Shell(boom, mesh_size=0.4 * m, contact_tolerance="any")
    return rows_at_rest(shell, boom, frequencies=2)


@pytest.mark.slow
def test_a_shell_is_mirrored_and_has_the_dimensions_of_its_units() -> None:
    units = 2.0, 3.0, 0.5
    rows, mirrored = (shell_at_rest(boom_of(SHORT, up=up)) for up in (1.0, -1.0))
    agree_upside_down(rows, mirrored, 1e-4)
    agree(rows, shell_at_rest(boom_of(SHORT, *units), units[0]), in_units(*units), 1e-4)

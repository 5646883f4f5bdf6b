# SPDX-License-Identifier: LGPL-3.0-or-later
"""Calls of the program from Python, with drawn arguments.

``python -m tests.fuzz.python_calls N`` repeats the call of a seed.
"""

import sys
import tomllib
from collections.abc import Callable, Mapping
from datetime import date
from functools import partial
from random import Random
from typing import Any

import numpy as np

import protractile as pt
from tests.fuzz.command_lines import USUAL, WRONG_KEYS
from tests.fuzz.valid import small

_OBJECTS = (
    None, True, "", "text", "https://x.y\n", [], {}, (), [1.0, 2.0], {"a": 1.0}, b"\xff", 1j,
    0, 0.0, -1, -0.5, 1e-300, 1e300, -1e300, 10**400, float("nan"), float("inf"), 2**63,
    np.float64(0.01), np.array([1.0, 2.0]), np.array([]), date(2000, 1, 1), object(), "\udcff",
)  # fmt: skip
# Share of the arguments with another object.
_SPOILED = 0.02


def call(seed: int) -> object:
    """Call functions of the program with the arguments of a seed."""
    random = Random(seed)
    return random.choice((_case, _case, _boom, _boom, _boom))(random)


def _drawn(random: Random, **arguments: Any) -> dict[str, Any]:
    """Return arguments with numbers changed by up to 5 %, and rarely with another object."""
    for name, value in arguments.items():
        if isinstance(value, float):
            arguments[name] = value * random.uniform(0.95, 1.05)
        if random.random() < _SPOILED:
            arguments[name] = random.choice(_OBJECTS)
    return arguments


def _case(random: Random) -> object:
    tables: dict[str, Any] = tomllib.loads(small(random))
    if random.random() < 0.15:
        table = tables[random.choice(list(tables))]
        table = random.choice(table) if isinstance(table, list) else table
        if isinstance(table, dict):
            table[random.choice(list(table))] = random.choice(_OBJECTS)
    case = pt.load_case(tables)
    key, ends = random.choice(list(USUAL.items()))
    value: object = random.choice(ends)
    if random.random() < 0.15:
        key = random.choice(WRONG_KEYS)
    if random.random() < 0.15:
        value = random.choice(_OBJECTS)
    if random.random() < 0.6:
        case = pt.change(case, **{key: value})
    calls: tuple[Callable[[], object], ...] = (
        partial(pt.check, case),
        partial(pt.run_case, case, **_drawn(random, models=["beam"])),
        partial(pt.run_case, case, models=random.choice((["series", "beam"], [], "beam", ["x"]))),
        partial(pt.frequencies, case, models=["beam"], vary={key: ends}),
    )
    return random.choices(calls, (4, 4, 1, 2))[0]()


def _boom(random: Random) -> object:
    """Return the difference of two models of a boom of two boxes."""
    drawn = partial(_drawn, random)
    steel = pt.Material(**drawn(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0))
    arm = pt.BoxSection(**drawn(height=0.40, width=0.30, flange=0.008, web=0.006))
    fly = pt.hexagon(**drawn(height=0.36, width=0.26, flat=0.1, top=0.006, bottom=0.006, web=0.006))
    law = pt.PowerContact(**drawn(stiffness=1e9, exponent=1.2, damping=0.0))
    stations = random.choice(((6.5, 7.5), (6.6, 7.4), ("tail", "head"), (6.5,), (), 6.5))
    histories: Mapping[Any, Mapping[str, Any]] = {
        pt.Step: {}, pt.Ramp: {"duration": 0.01}, pt.Sine: {"frequency": 2.0, "phase": 0.1},
        pt.PiecewiseLinear: {"times": [0.0, 0.1], "values": [0.0, 1.0]},
        pt.SCurve: {"travel": 1.0, "duration": 0.1},
    }  # fmt: skip
    history, numbers = random.choice(list(histories.items()))
    load = {"direction": "z", "magnitude": -100.0, "history": history(**drawn(**numbers))}
    jack = {"segment": "arm", "x": 2.0, "ground": (0.5, -1.0), "stiffness": 1e7}
    parts: tuple[tuple[str, Any, Mapping[str, Any]], ...] = (
        ("loads", pt.Load, {"segment": "fly", "x": 13.0, **load}),
        ("cylinders", pt.Cylinder, jack),
        ("stops", pt.Stop, {"segment": "fly", "x": 13.0, "play": 0.1, "contact": law}),
    )
    more = {name: [part(**drawn(**keys))] for name, part, keys in parts if random.random() < 0.3}
    supports = (pt.Support(**drawn(x=0.0, kind="clamped")),)
    masses = (pt.PointMass(**drawn(x=12.0, mass=50.0)),)
    first = drawn(name="arm", start=0.0, end=8.4, material=steel, section=arm)
    second = drawn(name="fly", start=6.0, end=14.0, material=steel, section=fly, load=-500.0)
    segments = [
        pt.Segment.of_section(**first, supports=supports),
        pt.Segment.of_section(**second, masses=masses),
    ]
    joint = pt.Joint(**drawn(outer="arm", inner="fly", stations=stations, play=0.01, contact=law))
    boom = pt.Boom(**drawn(segments=segments, joints=[joint], **more))
    if random.random() < 0.3:
        boom = pt.with_weight(boom, **drawn(angle=30.0, acceleration=9.81))
    models = (
        pt.BeamElements(boom, **drawn(element_length=1.0, theory="timoshenko")),
        pt.Kantorovich(boom, **drawn(terms=[4, 4], base="complete")),
        pt.Rigid(boom),
    )
    given = {"at_rest": False, "damping_ratio": 0.02, "tolerance": 0.002}
    one, other = (
        model.simulate(0.02, 0.001, **drawn(**given))
        for model in random.choices(models, (3, 2, 1), k=2)
    )
    return one.compare(other, **drawn(name="tip", until=0.01))


if __name__ == "__main__":
    print(call(int(sys.argv[1])))

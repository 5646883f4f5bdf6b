# SPDX-License-Identifier: LGPL-3.0-or-later
"""Usual ranges of keys by their tables, for numbers that one table gives alone."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import prod
from typing import NamedTuple

from protractile.geometry.boom import Boom
from protractile.geometry.cylinder import Cylinder
from protractile.geometry.fields import names_of
from protractile.geometry.joint import PadSize
from protractile.geometry.support import Pin
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.limits import units_of, walk_tables
from protractile.runs.case.load_tables import (
    AxialTable,
    FactorsTable,
    LoadCaseTable,
    PayloadTable,
    ResistanceTable,
)
from protractile.runs.case.motion_tables import HoistTable, LuffTable, SlewTable
from protractile.runs.case.schema import Case, LifeTable


class Usual(NamedTuple):
    """Usual range of a key: description, limits in SI units, factor to impossible values."""

    what: str
    least: float
    most: float
    margin: float


class KeyValue(NamedTuple):
    """Size of a number of a case in SI units, with its key, SI unit and usual range."""

    key: str
    value: float
    unit: str
    usual: Usual


def key_values(case: Case, boom: Boom) -> Iterator[KeyValue]:
    """Yield the numbers of a case whose tables have usual ranges."""
    ranges = _ranges(case, boom)
    for where, table in walk_tables(case):
        for of, usual_of_keys in ranges.items():
            if not isinstance(table, of):
                continue
            for key, usual in usual_of_keys.items():
                value = getattr(table, names_of(type(table))[key])
                size = prod(value) if isinstance(value, tuple) else value
                if size is not None:
                    unit = units_of(table, key)[0]
                    yield KeyValue(f"{where}.{key}", abs(size), unit, usual)


def _ranges(case: Case, boom: Boom) -> Mapping[type, Mapping[str, Usual]]:
    """Return the usual ranges of keys by the classes of their tables.

    Forces, masses and stiffnesses are compared with those of the boom, so that laboratory booms of
    1 m and cranes of 60 m are within them.
    """
    bare = boom.mass - (0.0 if case.payload is None else case.payload.mass)
    weight = STANDARD_GRAVITY * bare
    hoisted = STANDARD_GRAVITY * (bare if case.hoist is None else case.hoist.mass)
    return {
        ResistanceTable: {
            key: Usual("the resistance factor", 1.0, 3.0, 10.0) for key in names_of(ResistanceTable)
        },
        FactorsTable: {
            key: Usual("the factor on loads", 0.0, 3.0, 10.0) for key in names_of(FactorsTable)
        },
        LifeTable: {"partial_factor": Usual("the partial factor of fatigue", 1.0, 2.0, 5.0)},
        Pin: {
            "diameter": Usual("the diameter of the pin", 0.003, 0.5, 20.0),
            "strength": Usual("the strength of the pin", 2.0e8, 2.0e9, 10.0),
        },
        PadSize: {
            "allowable_pressure": Usual("the allowable pressure of the pad", 1.0e6, 3.0e8, 1.0e5)
        },
        Cylinder: {
            "stiffness": Usual(
                "the stiffness of the cylinder", 1e2 * weight / boom.length,
                1e7 * weight / boom.length, 1.0e4,
            ),
            "capacity": Usual("the capacity of the cylinder", 0.5 * weight, 1e3 * weight, 1.0e3),
        },
        AxialTable: {"mass": Usual("the mass on the rope", 0.0, 50.0 * bare, 1.0e4)},
        PayloadTable: {"mass": Usual("the mass of the payload", 0.0, 50.0 * bare, 1.0e4)},
        LoadCaseTable: {"payload": Usual("the payload", 0.0, 50.0 * bare, 1.0e4)},
        HoistTable: {
            "mass": Usual("the mass of the load", 0.0, 50.0 * bare, 1.0e4),
            "stiffness": Usual("the stiffness of the rope", hoisted / 2.0, hoisted / 1e-5, 100.0),
            "area": Usual("the cross-section of a fall", 1.0e-6, 1.0e-2, 10.0),
            "modulus": Usual("the modulus of the rope", 1.0e9, 3.0e11, 10.0),
            "length": Usual("the length of the falls", 0.3, 300.0, 20.0),
            "speed": Usual("the speed of hoisting", 0.0, 5.0, 20.0),
            "travel": Usual("the length of hoisting", 0.0, 200.0, 20.0),
            "slack": Usual("the slack of the rope", 0.0, 5.0, 20.0),
            "pendulum": Usual("the length of the pendulum", 0.1, 200.0, 20.0),
            "phi_2_min": Usual("the least dynamic factor", 1.0, 2.0, 5.0),
            "beta_2": Usual("the increase of the dynamic factor", 0.0, 1.0, 20.0),
        },
        LuffTable: {
            "travel": Usual("the angle of turning", 0.0, 720.0, 10.0),
            "speed": Usual("the speed of turning", 0.0, 30.0, 20.0),
        },
        SlewTable: {"radius": Usual("the radius of the foot", 0.0, boom.length, 20.0)},
    }  # fmt: skip

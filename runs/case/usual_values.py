# SPDX-License-Identifier: LGPL-3.0-or-later
"""Usual ranges of keys by their tables, for numbers that one table gives alone."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from math import inf, prod, sqrt
from typing import Any, NamedTuple

from protractile.geometry.boom import Boom
from protractile.geometry.chassis import Chassis
from protractile.geometry.cylinder import Cylinder
from protractile.geometry.fields import names_of
from protractile.geometry.head import Head, Sheave
from protractile.geometry.joint import BareStop, Pad, SlidePad
from protractile.geometry.material import Material
from protractile.geometry.place import Level
from protractile.geometry.segment import PointMass
from protractile.geometry.stiffeners import Collar, Diaphragm
from protractile.geometry.support import Pin, Support
from protractile.runs.case.actions import STANDARD_GRAVITY
from protractile.runs.case.combination_tables import (
    FactorsTable,
    LoadCaseTable,
    ResistanceTable,
)
from protractile.runs.case.contact import ContactTable, JointTable, RestitutionTable
from protractile.runs.case.kinds.model import ModelTable
from protractile.runs.case.limits import LimitsTable, is_table, units_of, walk_tables
from protractile.runs.case.load_tables import (
    AxialTable,
    GroundAccelerationTable,
    HistoryTable,
    LoadTable,
    PayloadTable,
    RopeTable,
    TelescopingTable,
    WindPressureTable,
)
from protractile.runs.case.motion_tables import (
    DriveTable,
    HoistTable,
    LuffTable,
    SlewTable,
    TravelTable,
    WindTable,
)
from protractile.runs.case.schema import (
    BucklingTable,
    Case,
    DampingTable,
    EnsembleTable,
    GravityTable,
    LifeTable,
    StopTable,
    TimeTable,
    VelocityTable,
)
from protractile.runs.case.sections import PinnedMassTable, SegmentTable

# Larger numbers overflow in other units.
_MOST = 1.0e300


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


# Usual range of a key: of its numbers, of each column of its pairs, or by its table and key.
UsualOfKey = Usual | tuple[Usual | None, ...] | Callable[[Any, str], Usual]
Ranges = Mapping[type, Mapping[str, UsualOfKey]]


def key_values(case: Case, boom: Boom) -> Iterator[KeyValue]:
    """Yield the numbers of a case whose tables have usual ranges, of a list its extremes."""
    ranges = usual_of_tables(case, boom)
    for where, table in walk_tables(case):
        for of, usual_of_keys in ranges.items():
            if not isinstance(table, of):
                continue
            for key, usual in usual_of_keys.items():
                value = getattr(table, names_of(type(table))[key])
                if is_table(value) or isinstance(value, str) or (not value and value != 0.0):
                    continue
                expected = usual(table, key) if callable(usual) else usual
                columns = [expected] if isinstance(expected, Usual) else expected
                for column, unit, sizes in zip(
                    columns, units_of(table, key), _columns(table, key, value), strict=False
                ):
                    for size in dict.fromkeys((max(sizes), min(sizes))):
                        # 0 means none where it is not usual.
                        if column is not None and (size or not column.least):
                            yield KeyValue(f"{where}.{key}", size, unit, column)


def _columns(table: Any, key: str, value: Any) -> list[list[float]]:
    """Return the sizes of the numbers of a key, by the columns of its pairs."""
    if isinstance(table, FactorsTable):
        value = prod(value)
    if isinstance(table, HistoryTable) and key == table.amount:
        value *= max((abs(factor) for _, factor in table.table or ()), default=1.0)
    if not isinstance(value, tuple):
        return [[min(abs(value), _MOST)]]
    columns = zip(*value, strict=True) if isinstance(value[0], tuple) else [value]
    return [[min(abs(number), _MOST) for number in column] for column in columns]


# Ranges of several tables that do not depend on the boom.
_CATEGORY = Usual("the detail category after EN 1993-1-9, in N/mm^2,", 36.0, 160.0, 10.0)
_FRICTION = Usual("the coefficient of friction", 0.0, 1.0, 10.0)
_INTERFERENCE = Usual("the interference of shims", 0.0, 0.005, 20.0)
_GRAVITY = Usual("the acceleration of gravity", 0.0, 12.0, 50.0)
_TIME = Usual("the time", 0.0, 1.0e5, 1.0e3)
_FREQUENCY = Usual("the frequency", 1.0e-3, 1.0e3, 100.0)
_EXPONENT = Usual("the exponent of the contact law", 1.0, 3.0, 10.0)
_STIFFENER = Usual("the thickness of the stiffener", 3.0e-4, 0.2, 20.0)
_STRESS = Usual("the limit of stresses", 1.0e6, 4.0e9, 100.0)
_SPEED = Usual("the speed at t = 0", 0.0, 20.0, 20.0)
_TURN = Usual("the rate of rotation at t = 0", 0.0, 20.0, 20.0)
_TURNING = Usual("the angle of turning", 0.0, 720.0, 10.0)

# Usual ranges of keys that do not depend on the boom.
_FIXED: Ranges = {
    TimeTable: {
        "duration": Usual("the duration", 1.0e-3, 1.0e5, 1.0e3),
        "output_step": Usual("the output step", 1.0e-7, 10.0, 1.0e3),
        "step": Usual("the time step", 1.0e-9, 1.0, 1.0e3),
    },
    ModelTable: {"step": Usual("the time step", 1.0e-9, 1.0, 1.0e3)},
    EnsembleTable: {"relative": Usual("the relative change", 0.0, 0.1, 20.0)},
    Material: {
        "poissons_ratio": Usual("Poisson's ratio", 0.0, 0.49, 10.0),
        "yield_by_thickness": (
            Usual("the thickness of a plate", 1.0e-4, 0.5, 100.0),
            Usual("the yield strength", 1.0e7, 4.0e9, 10.0),
        ),
    },
    Collar: {"thickness": _STIFFENER, "detail_category": _CATEGORY},
    Diaphragm: {"thickness": _STIFFENER, "detail_category": _CATEGORY},
    Pin: {
        "diameter": Usual("the diameter of the pin", 0.003, 0.5, 20.0),
        "strength": Usual("the strength of the pin", 2.0e8, 2.0e9, 10.0),
    },
    RestitutionTable: {
        "coefficient": Usual("the coefficient of restitution", 0.05, 1.0, 50.0),
        "speed": Usual("the impact speed", 1.0e-4, 10.0, 1.0e3),
    },
    HistoryTable: {
        "ramp": _TIME._replace(what="the time of the ramp", least=1.0e-6),
        "frequency": _FREQUENCY,
        "half_sine": _TIME._replace(what="the time of the pulse", least=1.0e-6),
        "table": (_TIME, None),
    },
    GroundAccelerationTable: {
        "acceleration": Usual("the acceleration of the ground", 0.0, 100.0, 100.0)
    },
    GravityTable: {"acceleration": _GRAVITY},
    TravelTable: {
        "time": _TIME._replace(what="the time of the motion", least=1.0e-4),
        "ramp": _TIME._replace(what="the time of the ramp"),
        "start": _TIME._replace(what="the time of the start"),
        "shaper": (_FREQUENCY, None),
    },
    VelocityTable: {"z": _SPEED, "y": _SPEED, "turn": _TURN, "lateral_turn": _TURN},
    DampingTable: {
        "modal": Usual("the damping ratio", 0.0, 0.1, 100.0),
        "mass": Usual("the mass-proportional damping", 0.0, 50.0, 100.0),
        "stiffness": Usual("the stiffness-proportional damping", 0.0, 0.1, 100.0),
    },
    LifeTable: {
        "detail_category": _CATEGORY,
        "partial_factor": Usual("the partial factor of fatigue", 1.0, 2.0, 5.0),
        "wear": Usual("the coefficient of wear", 1.0e-8, 1.0e-4, 1.0e3),
    },
    BucklingTable: {"curve": (Usual("the slenderness", 0.0, 10.0, 100.0), None)},
    FactorsTable: {
        key: Usual("the factor on loads", 0.0, 3.0, 10.0) for key in names_of(FactorsTable)
    },
    ResistanceTable: {
        key: Usual("the resistance factor", 1.0, 3.0, 10.0) for key in names_of(ResistanceTable)
    },
}  # fmt: skip


class _Sizes(NamedTuple):
    """Sizes of a boom with which those of its parts are compared.

    Forces, masses, stiffnesses and dashpots are compared with those of the boom, so that laboratory
    booms of 1 m and cranes of 60 m are within them.
    """

    bare: float  #: mass of the segments in kg
    weight: float  #: their weight in N
    length: float  #: length of the boom in m
    most_axial: float  #: largest usual axial force in N
    hoisted: float  #: weight of the load on the rope in N

    @classmethod
    def of_boom(cls, case: Case, boom: Boom) -> _Sizes:
        bare = sum(segment.mass_per_length * segment.length for segment in boom.segments)
        hoisted = STANDARD_GRAVITY * (bare if case.hoist is None else case.hoist.mass)
        most_axial = 100.0 * STANDARD_GRAVITY * boom.mass
        return cls(bare, STANDARD_GRAVITY * bare, boom.length, most_axial, hoisted)

    def dashpot(self, of: str) -> Usual:
        # Twice the square root of the largest usual stiffness and the mass of the boom.
        critical = 2.0e4 * self.bare * sqrt(STANDARD_GRAVITY / self.length)
        return Usual(f"the dashpot of the {of}", 0.0, critical, 1.0e4)

    def spring(self, of: str) -> Usual:
        least, most = (factor * self.weight / self.length for factor in (1.0, 1.0e8))
        return Usual(f"the stiffness of the {of}", least, most, 1.0e4)

    def contact(self, table: Any, key: str) -> Usual:
        """Return the range in which half the weight presses a contact in by 1e-9 m at least."""
        n = table.exponent_of(key) if isinstance(table, ContactTable) else table.exponent
        most = 0.5 * self.weight / 1e-9 ** (n or 2.0)
        return Usual("the stiffness of the contact", 0.0, most, 1e3)


def usual_of_tables(case: Case, boom: Boom) -> Ranges:
    """Return the usual ranges of keys by the classes of their tables."""
    sizes = _Sizes.of_boom(case, boom)
    return {**_FIXED, **_of_parts(sizes), **_of_contacts(sizes), **_of_actions(sizes)}


def _of_parts(sizes: _Sizes) -> Ranges:
    """Return the usual ranges of the keys of segments, supports and cylinders."""
    bare, weight, length, *_ = sizes
    carried = Usual("the mass at one place", 0.0, 50.0 * bare, 1.0e4)
    return {
        SegmentTable: {
            "rotary_inertia": Usual("the rotary inertia", 0.0, bare * length / 25.0, 100.0),
            "lateral_rotary_inertia": Usual(
                "the lateral rotary inertia", 0.0, bare * length / 25.0, 100.0
            ),
            "polar_inertia": Usual("the polar inertia", 0.0, bare * length / 12.0, 100.0),
            "height_to_width": Usual("the ratio of height to width", 0.1, 10.0, 10.0),
            "lateral_load": Usual(
                "the lateral load along the segment", 0.0, 100.0 * weight / length, 100.0
            ),
            "viscous_damping": Usual("the viscous damping", 0.0, 1.0e3 * bare / length, 1.0e4),
        },
        PointMass: {"mass": carried},
        PinnedMassTable: {
            "mass": carried, "centre": Usual("the place of the centre", 0.0, length, 50.0),
        },
        Support: {
            "stiffness": sizes.spring("support"),
            "rotation_stiffness": Usual(
                "the rotational stiffness of the support", 0.01 * weight * length,
                1.0e7 * weight * length, 1.0e4,
            ),
            "dashpot": sizes.dashpot("support"),
            "depth": Usual("the depth of the pin", 0.0, 0.3 * length, 20.0),
        },
        Chassis: {
            "mass": Usual("the mass of the chassis", 0.1 * bare, 100.0 * bare, 100.0),
            "counterweight": Usual("the mass of the counterweight", 0.0, 100.0 * bare, 100.0),
            **{
                key: Usual(f"the distance '{key}'", 0.0, 2.0 * length, 20.0)
                for key in ("centre", "behind", "front", "rear", "side", "foot_ahead", "foot_above")
            },
        },
        Cylinder: {
            "stiffness": Usual(
                "the stiffness of the cylinder", 1e2 * weight / length,
                1e7 * weight / length, 1.0e4,
            ),
            "capacity": Usual("the capacity of the cylinder", 0.5 * weight, 1e3 * weight, 1.0e3),
            **dict.fromkeys(
                ("closed", "open", "stroke"),
                Usual("the length of the cylinder", 0.02 * length, length, 20.0),
            ),
            **dict.fromkeys(
                ("bore", "rod"), Usual("the diameter of the cylinder", 0.02, 0.6, 20.0)
            ),
            "pressure": Usual("the pressure of the cylinder", 5e6, 7e7, 50.0),
            "oil_modulus": Usual("the bulk modulus of the oil", 5e8, 2.2e9, 20.0),
            "depth": Usual("the depth of the lug", 0.0, 0.3 * length, 20.0),
            "dashpot": sizes.dashpot("cylinder"),
            "spread": Usual("the spread of the cylinders", 0.0, 0.3 * length, 20.0),
        },
    }  # fmt: skip


def _of_contacts(sizes: _Sizes) -> Ranges:
    """Return the usual ranges of the keys of joints, pads and stops."""
    _, weight, length, *_ = sizes
    contact_length = Usual("the length of contact", 1.0e-3, 0.2 * length, 20.0)
    return {
        ContactTable: {
            "stiffness": sizes.contact,
            "stiffness_below": sizes.contact,
            "exponent": _EXPONENT,
            "force_table": (
                Usual("the penetration", 0.0, 0.1 * length, 20.0),
                Usual("the contact force", 0.0, 1.0e4 * weight, 1.0e4),
            ),
        },
        JointTable: {
            "lateral_stiffness": sizes.contact,
            "lateral_exponent": _EXPONENT,
            "friction": _FRICTION,
            "interference": _INTERFERENCE,
            "lateral_interference": _INTERFERENCE,
            "normal_forces": Usual("the normal force of friction", 0.0, 100.0 * weight, 1.0e3),
            "contact_length": contact_length,
            "dashpot": sizes.dashpot("joint"),
            "detail_category": _CATEGORY._replace(least=12.0),
        },
        Pad: {
            "length": Usual("the length of the pad", 0.001, 0.2 * length, 20.0),
            "width": Usual("the width of the pad", 0.001, 0.1 * length, 20.0),
            "offset": Usual("the offset of the pad", 0.0, 0.1 * length, 20.0),
            **dict.fromkeys(
                ("thickness", "lateral_thickness"),
                Usual("the thickness of the pad", 0.0005, 0.1, 10.0),
            ),
            "modulus": Usual("the modulus of the pad", 1.0e6, 3.0e11, 100.0),
            "allowable_pressure": Usual("the allowable pressure of the pad", 1.0e6, 3.0e8, 1.0e5),
        },
        SlidePad: {"shim": Usual("the shim beyond the play", 0.0, 0.02, 10.0)},
        BareStop: {
            "play": Usual("the play of the stop", 0.0, 0.1 * length, 20.0),
            "contact_length": contact_length,
        },
        StopTable: {
            "stiffness": sizes.contact, "stiffness_below": sizes.contact, "exponent": _EXPONENT,
        },
    }  # fmt: skip


def _of_actions(sizes: _Sizes) -> Ranges:
    """Return the usual ranges of the keys of loads, motions and limits."""
    bare, weight, length, most_axial, hoisted = sizes
    # The overlap refuses long ones, and a length of almost 0 is a constant extension.
    travel = Usual("the length of telescoping", 1.0e-3 * length, length, inf)
    hoisting = Usual("the length of hoisting", 2.0e-3 * length, 200.0, 1.0e3)
    offset = Usual("the distance of the load", 0.0, 10.0, 100.0)
    deflection = Usual("the limit of deflections", 1.0e-5 * length, length, 1.0e3)
    return {
        # Smaller loads are compared with the boom as a whole.
        LoadTable: {"magnitude": Usual("the load", 0.0, 1.0e6 * weight, 1.0e3)},
        WindTable: {"force": Usual("the force on the load", 0.0, 10.0 * hoisted, 1.0e3)},
        AxialTable: {
            "force": Usual("the size of the force along the boom", 0.0, most_axial, 100.0),
        },
        WindPressureTable: {
            "pressure": Usual("the wind pressure", 0.0, 3.0e3, 50.0),
            "speed": Usual("the wind speed", 0.0, 70.0, 20.0),
            "load_area": Usual("the area of the load in the wind", 0.0, 500.0, 100.0),
            **dict.fromkeys(
                ("shape_factor", "load_shape_factor"), Usual("the shape factor", 0.3, 3.0, 10.0)
            ),
        },
        TelescopingTable: {
            "retracted": Usual("the extension of a retracted joint", 0.0, length, 50.0)
        },
        RopeTable: {"winch": Usual("the distance of the winch behind the foot", 0.0, 20.0, 50.0)},
        Level: dict.fromkeys(("bottom", "top"), Usual("the distance", 0.0, 0.3 * length, 20.0)),
        Sheave: dict.fromkeys(("ahead", "below"), offset),
        Head: {
            **dict.fromkeys(("ahead", "below", "beside"), offset),
            "mass": Usual("the mass of the head", 0.0, 10.0 * bare, 1.0e4),
        },
        PayloadTable: {
            "mass": Usual("the mass of the payload", 0.0, 50.0 * bare, 1.0e4),
            "gravity": _GRAVITY,
        },
        LoadCaseTable: {"payload": Usual("the payload", 0.0, 50.0 * bare, 1.0e4)},
        LimitsTable: {
            "tip": deflection,
            "tip_at_rest": deflection,
            "tip_lateral": deflection,
            "stress": _STRESS,
            "wall_stress": _STRESS,
            "pad_pressure": Usual("the limit of the pressure of pads", 1.0e5, 1.0e9, 1.0e3),
            "first_frequency": Usual("the limit of the first frequency", 0.01, 1.0e3, 100.0),
            "decay_time": Usual("the limit of the decay time", 0.01, 1.0e4, 1.0e3),
            "settling_time": Usual("the limit of the settling time", 0.01, 1.0e4, 1.0e3),
        },
        DriveTable: {
            "travel": travel,
            "speed": Usual("the speed of telescoping", 1.0e-4, 5.0, 200.0),
            "table": (_TIME, travel._replace(least=0.0)),
            "least_overlap": Usual("the least overlap", 0.0, 0.5 * length, 20.0),
            "stiffness": sizes.spring("drive"),
            "dashpot": sizes.dashpot("drive"),
            "static_friction": _FRICTION,
        },
        HoistTable: {
            "mass": Usual("the mass of the load", 0.0, 50.0 * bare, 1.0e4),
            "stiffness": Usual("the stiffness of the rope", hoisted / 2.0, hoisted / 1e-5, 100.0),
            "area": Usual("the cross-section of a fall", 1.0e-6, 1.0e-2, 10.0),
            "modulus": Usual("the modulus of the rope", 1.0e9, 3.0e11, 10.0),
            "length": Usual("the length of the falls", 0.3, 300.0, 20.0),
            "speed": Usual("the speed of hoisting", 0.003, 5.0, 1.0e3),
            "travel": hoisting,
            "table": (_TIME, hoisting._replace(least=0.0)),
            "slack": Usual("the slack of the rope", 0.0, 5.0, 20.0),
            "pendulum": Usual("the length of the pendulum", 0.1, 200.0, 20.0),
            "phi_2_min": Usual("the least dynamic factor", 1.0, 2.0, 5.0),
            "beta_2": Usual("the increase of the dynamic factor", 0.0, 1.0, 20.0),
        },
        LuffTable: {
            "travel": _TURNING,
            "speed": Usual("the speed of turning", 0.0, 30.0, 20.0),
            "table": (_TIME, _TURNING),
        },
        SlewTable: {"radius": Usual("the radius of the foot", 0.0, length, 20.0)},
    }  # fmt: skip

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Every number of a case has a usual range, limits in the schema, or a reason for neither."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, get_args, get_origin

import pytest

from protractile.geometry.fields import fields_of, names_of
from protractile.runs.case.reading import load_checked
from protractile.runs.case.schema import Case
from protractile.runs.case.usual_values import usual_of_tables
from protractile.runs.process.bad_input import BadInput
from tests.runs.case_texts import CASES, edited
from tests.runs.test_real_booms import HOIST, LIFT, cautions

# Keys without a range of their own, as TABLE.KEY or KEY, by reason.
EXEMPT = {
    "its place is checked on its segment": (
        "x", "from", "to", "span", "across", "stations", "locked_at",
    ),
    "its range follows from its material and section (part_ranges)": (
        "youngs_modulus", "density", "yield_strength", "yield_strengths", "mass_per_length",
        "torsion_constant", "second_moment_of_area", "lateral_second_moment_of_area",
    ),
    "the sizes of the whole section have ranges (part_ranges)": (
        "SectionTable", "UnequalBoxTable", "PolygonTable", "HexagonTable", "OctagonTable", "UTable",
    ),
    "its range follows from the joint or the cylinder (sanity)": (
        "JointTable.play", "lateral_play", "extension", "ground", "EarthPoint",
    ),
    "its range follows from the boom (chart.run)": ("ChartTable",),
    "a part of the play, which is checked": ("play_above", "lateral_play_right"),
    "its section is compared with it (part_ranges)": ("SegmentTable.length",),
    "loads are compared with the weight of the boom (cautions.loads)": ("load",),
    "the limit is that of the mesh or of the cost (check)": (
        "mesh_size", "element_length", "contact_tolerance", "Shell.modes",
        "surface_points",
    ),
    "a reading is compared with the model (runs.measured)": ("Channel",),
    "its unit depends on the law of a joint, and its row on the mesh": ("surface_stiffness",),
}  # fmt: skip


def classes_in(annotation: Any) -> Iterator[type]:
    if isinstance(annotation, type):
        yield annotation
    for part in get_args(annotation):
        yield from classes_in(part)


def rules_of(field: Any) -> Iterator[Any]:
    """Yield the rules of a field, not those of the numbers of a list."""
    yield from field.metadata
    for part in get_args(field.annotation):
        for rule in get_args(part) if get_origin(part) is Annotated else ():
            yield from getattr(rule, "metadata", ())


def numbers_of(table: type, seen: set[type]) -> Iterator[tuple[type, str]]:
    """Yield the table and the key of each number of the schema, also in the tables within."""
    seen.add(table)
    for key, name in names_of(table).items():
        field = fields_of(table)[name]
        classes = list(classes_in(field.annotation))
        limits = {
            name
            for one in rules_of(field)
            for name in ("gt", "ge", "lt", "le")
            if hasattr(one, name)
        }
        both = limits & {"gt", "ge"} and limits & {"lt", "le"}
        if {int, float} & {*classes} and not both:
            yield table, key
        for one in classes:
            if hasattr(one, "__pydantic_fields__") and one not in seen:
                yield from numbers_of(one, seen)


def test_each_number_of_the_schema_has_a_range() -> None:
    """Reference: the schema; an exemption that a range has made superfluous fails, too."""
    checked = load_checked(str(CASES / "lift.toml"))
    ranges = usual_of_tables(checked.case, checked.boom)
    exempt = {key for keys in EXEMPT.values() for key in keys}
    missing, used = [], set()
    for table, key in numbers_of(Case, set()):
        names = {key, table.__name__, f"{table.__name__}.{key}"} & exempt
        used |= names
        ranged = any(key in keys for of, keys in ranges.items() if issubclass(table, of))
        if ranged == bool(names):
            missing.append(f"{table.__name__}.{key}")
    assert missing == []
    assert used == exempt


STOP = "[[stop]]\nsegment = 'fly'\nx = 11.0\nplay = {}\nstiffness = {}\n[ensemble]"
SHAKEN = (
    edited(LIFT, ("wind = 1.1", "wind = 1.1, dynamic = 1.0")).replace(
        '"equilibrium"', '"equilibrium", velocity = { fly = 0.1 }'
    )
    + """
[[base]]
acceleration = 1.0
frequency = 2.0
[ensemble]
members = 3
[damping]
mass = 0.1
[limits]
tip = 0.2
"""
)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("tip = 0.2", "tip = 50.0",
         "limits.tip: the limit of deflections is 50 m, usual is from 0.000113 up to 11.3 m; if it "
         "is in mm, give 0.05 m"),
        ("tip = 0.2", "stress = 235.0", "limits.stress: the limit of stresses is 235 Pa, "),
        ("tip = 0.2", "pad_pressure = 20.0", "limits.pad_pressure: "),
        ("tip = 0.2", "first_frequency = 1e6", "limits.first_frequency: "),
        ("tip = 0.2", "decay_time = 1e-6", "limits.decay_time: "),
        ("members = 3", "members = 3\nrelative = 0.5", "ensemble.relative: the relative change "),
        ("frequency = 2.0", "frequency = 1e9", "base[1].frequency: the frequency is 1e+09 Hz, "),
        ("frequency = 2.0", "half_sine = 1e-9", "base[1].half_sine: "),
        ("frequency = 2.0", "ramp = 1e-12", "base[1].ramp: the time of the ramp is 1e-12 s, "),
        ("acceleration = 1.0", "acceleration = 9810.0", "base[1].acceleration: "),
        ("frequency = 2.0", "table = [[0.0, 0.0], [1.0, 1e308]]",
         "base[1].acceleration: the acceleration of the ground is 1e+300 m/s², usual is "),
        ("magnitude = -30.0", "magnitude = -1e300", "load_case[1].load[1].magnitude: the load is "),
        ("mass = 0.1", "mass = 1e6", "damping.mass: the mass-proportional damping is "),
        ("mass = 0.1", "stiffness = 50.0", "damping.stiffness: "),
        ("fly = 0.1", "fly = 500.0", "start.velocity.fly.z: the speed at t = 0 is 500 m/s, "),
        ("fly = 0.1", "fly = { turn = 1e5 }", "start.velocity.fly.turn: "),
        ("play = 0.003", "play = 0.003\nfriction = 0.1\nnormal_forces = [1e9, 1e9]",
         "joint[1].normal_forces: the normal force of friction is "),
        ("play = 0.003", "play = 0.003\ncontact_length = 50.0", "joint[1].contact_length: "),
        ("play = 0.003", "play = 0.003\ndashpot = 1e12", "joint[1].dashpot: the dashpot of the "),
        ("play = 0.003", "play = 0.003\nrestitution = { coefficient = 1e-3, speed = 0.1 }",
         "joint[1].restitution.coefficient: the coefficient of restitution is "),
        ("play = 0.003", "play = 0.003\nrestitution = { coefficient = 0.5, speed = 1e3 }",
         "joint[1].restitution.speed: the impact speed is "),
        ("length = 0.12", "length = 1e-6", "joint[1].pad.length: the length of the pad is 1e-06 m"),
        ("width = 0.05", "width = 1e-6", "joint[1].pad.width: the width of the pad is 1e-06 m"),
        ("thickness = 0.012", "thickness = 0.012, modulus = 1.9",
         "joint[1].pad.modulus: the modulus of the pad is 1.9 Pa, "),
        ("stiffness = 30000000.0", "stiffness = 30000000.0\ndashpot = 1e15",
         "cylinder[1].dashpot: "),
        ("depth = 0.25", "depth = 250.0", "cylinder[1].depth: the depth of the lug is 250 m, "),
        ("[ensemble]", STOP.format(50.0, 1e6),
         "stop[1].play: the play of the stop is 50 m, "),
        ("[ensemble]", STOP.format(0.1, 1e30),
         "stop[1].stiffness: the stiffness of the contact is 1e+30 N/m, "),
    ],
)  # fmt: skip
def test_numbers_without_sense_are_told(tmp_path: Path, old: str, new: str, line: str) -> None:
    """Reference: exact words of the key; the case without them has no caution."""
    assert cautions(tmp_path, SHAKEN) == []
    text = edited(SHAKEN, (old, new))
    try:
        told = cautions(tmp_path, text)
    except BadInput as error:
        told = [f"{error.key}: {error.what}"]
    assert any(one.startswith(line) for one in told), told


@pytest.mark.parametrize(
    ("key", "value", "line"),
    [
        ("travel", "0.005",
         "hoist.travel: the length of hoisting is 5 mm, usual is from 79.8 up to 2e+05 mm; if it "
         "is in m, give 5000 mm"),
        ("speed", "0.0005",
         "hoist.speed: the speed of hoisting is 0.5 mm/s, usual is from 3 up to 5e+03 mm/s; if it "
         "is in m/s, give 500 mm/s"),
    ],
)  # fmt: skip
def test_metres_in_millimetres_are_cautioned(
    tmp_path: Path, key: str, value: str, line: str
) -> None:
    """Reference: exact words of a hoist of 5 m, or at 0.5 m/s, whose case is in mm."""
    given = 'shown_units = "mm-t-s"\n' + HOIST.replace("ramp = 0.2", "ramp = 0.0")
    hoist = given.index("[hoist]")
    text = given[:hoist] + re.sub(rf"(?m)^{key} = .*", f"{key} = {value}", given[hoist:], count=1)
    assert line in cautions(tmp_path, text)

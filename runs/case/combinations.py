# SPDX-License-Identifier: LGPL-3.0-or-later
"""Load cases and combinations: static cases with changed keys and with factors on loads.

The case of a combination has the masses of its load case. A load on a rope hangs at rest, as a
mass at the tip. If the payload and the dead weight have different factors, the payload has an
acceleration of gravity of its own.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, TypeVar, get_args

from protractile.geometry.boom import BoomError
from protractile.geometry.typography import choices
from protractile.runs.case.actions import in_wind, payload_weight
from protractile.runs.case.build import build_boom, check_names, hold_ground, telescoped_joints
from protractile.runs.case.combination_tables import (
    CombinationTable,
    LoadCaseTable,
)
from protractile.runs.case.limits import CaseTable
from protractile.runs.case.load_tables import (
    AxialTable,
    GroundAccelerationTable,
    Group,
    LoadTable,
    PayloadTable,
    TelescopingTable,
    WindPressureTable,
)
from protractile.runs.case.messages import key_of_part
from protractile.runs.case.schema import Case

Table = TypeVar("Table", bound=CaseTable)

# Factors by group of loads, and factors 1 for a load case without combination.
Factors = Mapping[Group, float]
UNIT: Factors = dict.fromkeys(get_args(Group), 1.0)

# The load case of a case without load cases.
_PLAIN = LoadCaseTable.model_validate({"name": "case"})


class CombinedCase(NamedTuple):
    """The case of a combination in a load case, with the names of both."""

    name: str  #: names of the combination and the load case, if any; otherwise ``case``
    case: Case  #: the case with the loads of the combination
    combination: CombinationTable  #: the combination; a default one if the case gives none
    of: Case  #: the case with the combination
    table: LoadCaseTable  #: the load case
    factors: Factors  #: the factors of the combination by group of loads


def combined_cases(case: Case) -> Iterator[CombinedCase]:
    """Yield the case of each combination in each of its load cases."""
    default = CombinationTable.model_validate({"name": "case", "factors": {}})
    for combination in case.combinations or (default,):
        factors = UNIT
        if combination is not default:
            factors = {group: combination.factors.of(group) or 0.0 for group in UNIT}
        for load_case in case.load_cases or (_PLAIN,):
            if combination.load_cases is None or load_case.name in combination.load_cases:
                names = [combination.name] if case.combinations else []
                if load_case is not _PLAIN or not names:
                    names.append(load_case.name)
                combined = combine(case, load_case, factors)
                yield CombinedCase(
                    ", ".join(names), combined, combination, case, load_case, factors
                )


def combine(case: Case, table: LoadCaseTable, factors: Factors = UNIT) -> Case:
    """Return the case with the keys of a load case, and with its loads times ``factors``.

    Raises:
        BoomError: an angle needs gravity, or an extension has no joint.
    """
    gravity, payload = case.gravity, case.payload
    if table.angle is not None:
        if gravity is None:
            raise BoomError("angle", "the case has no table gravity, whose angle it replaces")
        gravity = gravity.model_copy(update={"angle": table.angle})
    telescoping = None if table.extension else case.telescoping
    if table.telescoped is not None:
        update = {"extension": table.telescoped}
        telescoping = (telescoping or TelescopingTable()).model_copy(update=update)
    if hung := _hung_mass(case, table):
        mass = hung + (payload.mass if payload else 0.0)
        payload = (payload or PayloadTable(mass=mass)).model_copy(update={"mass": mass})
    replacements: Mapping[str, Any] = {
        key: getattr(case if getattr(table, key) is None else table, key)
        for key in ("loads", "axial", "base")
    }
    changed = case.model_copy(
        update={
            **replacements,
            "gravity": gravity,
            "payload": payload,
            "joints": _joints(case, table),
            "telescoping": telescoping,
            "wind": _wind(case, table),
            **dict.fromkeys(("hoist", "slew", "luff")),
            "load_cases": (),
            "combinations": (),
            "spectra": (),
        }
    )
    combined = hold_ground(changed, case)
    dead = factors["dead"]
    segments = [_times(segment, dead, "load", "lateral_load") for segment in combined.segments]
    loads = [_times(load, factors[load.group], load.amount) for load in combined.loads]
    axial = [_times(axial, factors[axial.group], "force") for axial in combined.axial]
    base = [_times(action, factors[action.group], action.amount) for action in combined.base]
    masses = [(group, factors[group] * mass) for group, mass in tip_masses(case, table)]
    loaded = in_wind(case, masses)
    if payload is not None:
        total = payload_weight(combined) / payload.mass
        weighed = sum(mass for _, mass in masses) / payload.mass
        group = "payload" if loaded else payload.group
        payload = payload.model_copy(update={"gravity": total * weighed, "group": group})
    if gravity is not None:
        gravity = _times(gravity, dead, "acceleration")
    wind, rope = combined.wind, combined.rope
    if wind is not None:
        pressure = factors["wind"] * wind.dynamic_pressure
        area = wind.load_area if loaded else 0.0
        wind = wind.model_copy(update={"pressure": pressure, "speed": None, "load_area": area})
    if rope is not None and rope.falls is None and case.hoist is not None:
        rope = rope.model_copy(update={"falls": case.hoist.falls})
    return combined.model_copy(
        update={
            "segments": tuple(segments),
            "loads": tuple(loads),
            "axial": tuple(axial),
            "base": tuple(base),
            "gravity": gravity,
            "payload": payload,
            "wind": wind,
            "rope": rope,
        }
    )


def tip_masses(case: Case, table: LoadCaseTable) -> list[tuple[Group, float]]:
    """Return the masses in kg at the tip in a load case, each with its group."""
    masses: list[tuple[Group, float]] = [("payload", _hung_mass(case, table))]
    if case.payload is not None:
        masses.append((case.payload.group, case.payload.mass))
    return masses


def _hung_mass(case: Case, table: LoadCaseTable) -> float:
    """Return the mass in kg at the tip in addition to the table ``payload`` of the case."""
    if table.payload is not None:
        return table.payload
    return 0.0 if case.hoist is None else case.hoist.mass


def _wind(case: Case, table: LoadCaseTable) -> WindPressureTable | None:
    return case.wind if table.wind is None else table.wind.over(case.wind)


def _times(table: Table, factor: float, *keys: str) -> Table:
    return table.model_copy(update={key: factor * getattr(table, key) for key in keys})


def _joints(case: Case, table: LoadCaseTable) -> tuple[Any, ...]:
    inner = [joint.inner for joint in case.joints]
    for name in table.extension:
        if name not in inner:
            what = f"no joint has {name!r} as inner segment; give {choices(inner)}"
            raise BoomError(f"extension.{name}", what)
    if not table.extension:
        return case.joints
    full = case.telescoping and case.telescoping.model_copy(update={"extension": 1.0})
    return tuple(
        replace(joint, extension=table.extension.get(joint.inner, joint.extension))
        for joint in telescoped_joints(case.model_copy(update={"telescoping": full}))
    )


def check_combinations(case: Case) -> None:
    """Check load cases and combinations.

    Raises:
        BoomError: a name is given twice or unknown, a load case has no valid boom, or a combination
            has no factor for a group of its load cases.
    """
    check_names("load_case", [load_case.name for load_case in case.load_cases])
    check_names("combination", [combination.name for combination in case.combinations])
    for number, load_case in enumerate(case.load_cases, start=1):
        try:
            build_boom(combine(case, load_case))
        except BoomError as error:
            where = f"load_case[{number}].{key_of_part(error.where)}"
            raise BoomError(where, error.what) from None
    names = [load_case.name for load_case in case.load_cases]
    for number, combination in enumerate(case.combinations, start=1):
        selected = names if combination.load_cases is None else combination.load_cases
        _check_names(f"combination[{number}].load_cases", selected, names)
        _check_factors(case, number, combination, selected)
        if "tipping" in combination.proofs and case.chassis is None:
            what = "tipping needs the tipping lines of a chassis; give [chassis]"
            raise BoomError(f"combination[{number}].proofs", what)
    for number, spectrum in enumerate(case.spectra, start=1):
        _check_names(f"spectrum[{number}].load_cases", spectrum.load_cases, names)


def _check_names(where: str, selected: Sequence[str], names: Sequence[str]) -> None:
    for name in selected:
        if not names:
            raise BoomError(where, "the case has no [[load_case]]; leave it out")
        if name not in names:
            raise BoomError(where, f"{name!r} is no load case; give {choices(names)}")


def _check_factors(
    case: Case, number: int, combination: CombinationTable, selected: Sequence[str]
) -> None:
    tables = [load_case for load_case in case.load_cases if load_case.name in selected]
    for table in tables or [_PLAIN]:
        for group, what in _groups(case, table):
            if combination.factors.of(group) is None:
                raise BoomError(
                    f"combination[{number}].factors.{group}",
                    f"missing, and {what} is of this group; give its factor, 0 where it does not "
                    "act",
                )


def _groups(case: Case, table: LoadCaseTable) -> Iterator[tuple[Group, str]]:
    """Yield the load group (``dead``, ``payload`` …) and the name of each load of a load case."""
    if case.gravity is not None or any(
        segment.load or segment.lateral_load for segment in case.segments
    ):
        yield "dead", "the weight of the boom"
    if case.payload is not None:
        yield case.payload.group, "the weight of the payload"
    wind = _wind(case, table)
    if wind is not None and wind.dynamic_pressure:
        yield "wind", "the table wind"
    if _hung_mass(case, table):
        yield "payload", f"the payload of {table.name!r}" if table.payload else "the load of hoist"
    parts: dict[str, Sequence[LoadTable | AxialTable | GroundAccelerationTable]] = {
        "load": case.loads if table.loads is None else table.loads,
        "axial": case.axial if table.axial is None else table.axial,
        "base": case.base if table.base is None else table.base,
    }
    for key, several in parts.items():
        for number, combination in enumerate(several, start=1):
            yield combination.group, f"{key}[{number}]"

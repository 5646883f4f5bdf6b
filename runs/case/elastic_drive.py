# SPDX-License-Identifier: LGPL-3.0-or-later
"""Data of elastic drives: drives of finite stiffness."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import pi

from dynamics.gap_system import GapSystem
from dynamics.stick_slip import ElasticDrive
from geometry.boom import Boom, BoomError
from geometry.telescoping import drives_below, telescoping_stations
from runs.case.contact import JointTable
from runs.case.motion_tables import DriveTable
from runs.case.schema import Case

# Largest natural frequency or decay rate of an elastic drive in Hz; stiffer drives must be rigid.
_MAX_RATE = 1.0e3


def elastic_drives(case: Case, boom: Boom) -> dict[int, ElasticDrive]:
    """Return the data of the elastic drives of a checked case, by the indices of their joints."""
    return {
        number: ElasticDrive(
            _moved_mass(boom, number),
            drive.stiffness,
            drive.dashpot,
            1.0 if drive.static_friction is None else drive.static_friction / joint.friction,
            boom.segments[boom.joints[number].inner].compression.transferred,
            tuple(
                (_moved_mass(boom, number, other), neighbour.drive.history)
                for other, neighbour in enumerate(boom.joints)
                if other != number and neighbour.drive is not None
            ),
        )
        for number, joint, drive in _drives(case)
        if drive.stiffness is not None and boom.joints[number].drive is not None
    }


def with_elastic_drives(system: GapSystem, case: Case, boom: Boom) -> GapSystem:
    """Return the gap system of a model with the data of its elastic drives."""
    drives = elastic_drives(case, boom)
    suffixes = {group.suffix: drives.get(group.joints[0]) for group in telescoping_stations(boom)}
    travels = [
        replace(one, elastic=None if one.suffix is None else suffixes[one.suffix])
        for one in system.travels
    ]
    return replace(system, travels=travels)


def check_elastic_drives(case: Case, boom: Boom) -> None:
    """Check the data of elastic drives.

    Raises:
        BoomError: data of an elastic drive are invalid.
    """
    for number, joint, drive in _drives(case):
        where = f"joint[{number + 1}].drive"
        if drive.stiffness is None:
            for key in ("dashpot", "static_friction"):
                if getattr(drive, key):
                    raise BoomError(
                        f"{where}.{key}",
                        "without a stiffness the drive is stiff, and its segment neither sticks "
                        f"nor slips; give stiffness, or leave {key} out",
                    )
            continue
        if drive.static_friction is not None and joint.friction == 0.0:
            raise BoomError(
                f"{where}.static_friction",
                "nothing rubs in the joint; give it friction, or leave static_friction out",
            )
        if drive.static_friction is not None and drive.static_friction < joint.friction:
            raise BoomError(
                f"{where}.static_friction",
                f"must be at least the joint's friction of sliding, {joint.friction:g}, got "
                f"{drive.static_friction:g}",
            )
        mass = _moved_mass(boom, number) if boom.joints[number].drive is not None else 0.0
        rates = 2.0 * pi * _MAX_RATE
        for key, value, most, unit in (
            ("stiffness", drive.stiffness, mass * rates**2, "N/m"),
            ("dashpot", drive.dashpot, mass * rates, "N s/m"),
        ):
            if value > most > 0.0:
                raise BoomError(
                    f"{where}.{key}",
                    f"must be at most {most:.3g} {unit} for the {mass:.4g} kg that it draws, got "
                    f"{value:g} {unit}; leave it out where the drive is stiff",
                )


def _drives(case: Case) -> Iterator[tuple[int, JointTable, DriveTable]]:
    for number, joint in enumerate(case.joints):
        if joint.drive is not None:
            yield number, joint, joint.drive


def _moved_mass(boom: Boom, *joints: int) -> float:
    """Return the mass in kg of the segments that every one of these joints' drives moves."""
    return sum(
        segment.mass
        for number, segment in enumerate(boom.segments)
        if set(joints) <= set(drives_below(boom.joints, number))
    )

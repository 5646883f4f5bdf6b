# SPDX-License-Identifier: LGPL-3.0-or-later
"""Descriptions of drives, and predictions of stick-slip."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from protractile.analysis.equilibria import equilibria, extended_equilibria, instants
from protractile.beam_model.statics import telescoping_system
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.stick_slip import ElasticDrive
from protractile.dynamics.travel import Travel
from protractile.geometry.boom import Boom
from protractile.geometry.typography import TO_KILO, TO_PERCENT
from protractile.geometry.units import System
from protractile.runs.case.motion_tables import max_speed
from protractile.runs.case.motions import elastic_drives, with_elastic_drives
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.statics import boom_with_play, statics

# Upper limit of (R_s − R)/(v √(k m)) in the search for the critical speed.
_MAX_DROP = 1.0e6


def drive_lines(boom: Boom, system: System) -> Iterator[str]:
    """Yield a sentence for each drive: travel, time, speed and remaining overlap."""
    for joint in boom.joints:
        if joint.drive is None:
            continue
        kinks, (low, high) = joint.drive.history.kinks, joint.drive.reach
        travels = [
            f"{verb} {boom.segments[joint.inner].name!r} by {system.text(travel, 'm')}"
            for travel, verb in ((high, "extends"), (-low, "retracts"))
            if travel > 0.0
        ]
        yield (
            f"A drive {' and '.join(travels)} from {max(0.0, min(kinks)):g} to {max(kinks):g} s, "
            f"at {system.text(max_speed(joint.drive.history), 'm/s')} at most; the smallest "
            f"overlap is {system.text(boom.smallest_overlap(joint), 'm')}."
        )


@dataclass(frozen=True, slots=True)
class StickSlipEstimate:
    """Data of an elastic drive from which its stick-slip is predicted."""

    inner: str  #: name of the inner segment
    elastic: ElasticDrive  #: data of the elastic drive
    friction: float  #: largest sliding friction R in the static states, in N
    max_speed: float  #: largest commanded speed in m/s

    @property
    def critical_speed(self) -> float:
        """The critical speed of the drive in m/s, see :func:`critical_speed`."""
        return critical_speed(self.elastic, self.friction)


def critical_speed(drive: ElasticDrive, friction: float) -> float:
    """Return the speed in m/s above which a slipping segment does not stick again.

    Without damping it is infinite. The sliding friction R is in N.
    """
    drop = (drive.sticking - 1.0) * friction
    if drop == 0.0 or drive.damping_ratio >= 1.0:
        return 0.0
    if drive.damping_ratio == 0.0:
        return np.inf
    impedance = float(np.sqrt(drive.stiffness * drive.mass))
    return drop / (_critical_drop(drive.damping_ratio) * impedance)


def _critical_drop(ratio: float) -> float:
    """Return the limit of D = (R_s − R)/(v √(k m)) below which slip continues, for a ratio ζ < 1.

    At the start of a slip ż/v = 1, with the slope −D over ωt; then the drive vibrates freely. The
    next maximum of ż/v is √(1 − 2ζD + D²) e^{−ζ(θ + π)/√(1 − ζ²)}, θ = arg((ζD − 1)/√(1 − ζ²)
    + iD). The segment sticks again if it reaches 1. For small damping, the limit is √(4πζ).
    """
    from scipy.optimize import brentq

    beat = np.sqrt(1.0 - ratio**2)

    def beyond(drop: float) -> float:
        angle = np.arctan2(drop, (ratio * drop - 1.0) / beat)
        grown = 0.5 * np.log1p(drop * (drop - 2.0 * ratio))
        return float(grown - ratio * (angle + np.pi) / beat)

    if beyond(_MAX_DROP) < 0.0:
        return np.inf
    return float(brentq(beyond, 2.0 * ratio, _MAX_DROP, xtol=1e-14))


def stick_slip_estimates(case: Case, boom: Boom) -> Iterator[StickSlipEstimate]:
    """Yield the estimate for each elastic drive, from static pad forces."""
    joints = elastic_drives(case, boom)
    if not joints or statics(case, boom) is None:
        return
    system = with_elastic_drives(telescoping_system(boom_with_play(case, boom)), case, boom)
    travels = (travel for travel in system.travels if travel.elastic is not None)
    for (number, elastic), travel in zip(joints.items(), travels, strict=True):
        joint = boom.joints[number]
        assert joint.drive is not None
        name, friction = boom.segments[joint.inner].name, _friction(system, travel, case)
        yield StickSlipEstimate(name, elastic, friction, max_speed(joint.drive.history))


def _friction(system: GapSystem, travel: Travel, case: Case) -> float:
    """Return the largest friction R in N over the static states of the run."""
    from protractile.dynamics.time_step import axial_friction

    duration, most = case.time.duration, 0.0
    rests = equilibria(system, instants(system, duration)) | extended_equilibria(system, duration)
    for time, position in rests.items():
        gaps = system.at_time(time).rows @ position
        forces = [law.force(gap) for law, gap in zip(system.laws, gaps, strict=True)]
        most = max(most, float(axial_friction(system, travel, np.array([forces]))[0]))
    return most


def stick_slip_lines(estimates: Iterable[StickSlipEstimate], system: System) -> Iterator[str]:
    """Yield a sentence on the stick-slip of each elastic drive."""
    for drive in estimates:
        if drive.critical_speed == 0.0:
            slips = "does not stick again once it slips"
        elif drive.critical_speed == np.inf:
            slips = "sticks and slips at any speed"
        else:
            slips = f"sticks and slips below {system.text(drive.critical_speed, 'm/s', 3)}"
        yield (
            f"The drive of {drive.inner!r} moves {system.text(drive.elastic.mass, 'kg')}, with a "
            f"frequency of {drive.elastic.frequency:.3g} Hz and a damping ratio of "
            f"{TO_PERCENT * drive.elastic.damping_ratio:.3g} %; against the largest static "
            f"friction of {drive.friction * TO_KILO:.3g} kN it {slips}."
        )

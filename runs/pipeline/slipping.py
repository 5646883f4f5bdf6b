# SPDX-License-Identifier: LGPL-3.0-or-later
"""Whether what a drive of a given stiffness draws will stick and slip, before anything moves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from beam_model.statics import drawn_out
from dynamics.drive.stick_slip import Pulled
from dynamics.drive.travel import Travel
from dynamics.gap_system import GapSystem
from geometry.boom import Boom
from geometry.typography import TO_KILO, TO_PERCENT
from runs.case.drive import fastest
from runs.case.pulled import pulled_by, with_pulled
from runs.case.schema import Case
from runs.case.units import System
from runs.pipeline.at_rest import drawn_positions, instants, positions
from runs.pipeline.statics import laws, statics

if TYPE_CHECKING:
    import xarray as xr


# Part of the least overlap beyond which what lags behind presses pads in other places.
FAR_BEHIND = 0.01


@dataclass(frozen=True, slots=True)
class Slipping:
    """What is known of a drive before it draws.

    Args:
        inner: the name of the segment.
        pulled: what goes along.
        friction: R in N where pads press most at rest.
        fastest: the largest speed that is asked, in m/s.
    """

    inner: str
    pulled: Pulled
    friction: float
    fastest: float

    @property
    def critical(self) -> float:
        """From which speed in m/s on it does not stick again once it slips."""
        return self.pulled.critical_speed(self.friction)


def slippings(case: Case, boom: Boom) -> Iterator[Slipping]:
    """Of each drive of a given stiffness, with the pads of beam elements at rest on its way."""
    joints = pulled_by(case, boom)
    if not joints or statics(case, boom) is None:
        return
    system = with_pulled(drawn_out(boom, *laws(case, boom)), case, boom)
    travels = (travel for travel in system.travels if travel.pulled is not None)
    for (number, pulled), travel in zip(joints.items(), travels, strict=True):
        joint = boom.joints[number]
        assert joint.drive is not None
        name, friction = boom.segments[joint.inner].name, _friction(system, travel, case)
        yield Slipping(name, pulled, friction, fastest(joint.drive))


def _friction(system: GapSystem, travel: Travel, case: Case) -> float:
    """The largest R in N at rest, under the loads of t = 0 and where drives have drawn it to."""
    from dynamics.time_step import axial_friction

    duration, most = case.time.duration, 0.0
    rests = positions(system, instants(system, duration)) | drawn_positions(system, duration)
    for time, position in rests.items():
        gaps = system.standing(time).rows @ position
        forces = [law.force(gap) for law, gap in zip(system.laws, gaps, strict=True)]
        most = max(most, float(axial_friction(system, travel, np.array([forces]))[0]))
    return most


def slip_lines(found: Iterable[Slipping], system: System) -> Iterator[str]:
    """A sentence for each drive of a given stiffness."""
    for one in found:
        mass = f"{system.of(one.pulled.mass, 'kg'):.4g} {system.label('kg')}"
        yield (
            f"What the drive of {one.inner!r} draws, {mass}, swings at {one.pulled.frequency:.3g} "
            f"Hz, damped by {TO_PERCENT * one.pulled.damping_ratio:.3g} %, and against "
            f"{one.friction * TO_KILO:.3g} kN of friction, the most at rest, "
            f"{_slips(one, system)}."
        )


def _slips(one: Slipping, system: System) -> str:
    if one.critical == 0.0:
        return "slips on once it slips"
    if one.critical == np.inf:
        return "sticks and slips at any speed"
    return f"sticks and slips below {_speed(one.critical, system)}"


def _speed(value: float, system: System) -> str:
    return f"{system.of(value, 'm/s'):.3g} {system.label('m/s')}"


def _length(value: float, system: System) -> str:
    return f"{system.of(value, 'm'):.4g} {system.label('m')}"


def slip_cautions(found: Iterable[Slipping], system: System) -> list[str]:
    """Where it would stick and slip all the way, a line each."""
    return [
        f"caution: the drive of {one.inner!r} lets it stick and slip all the way: it draws at "
        f"{_speed(one.fastest, system)} at most, and {_remedy(one, system)}"
        for one in found
        if one.critical > one.fastest
    ]


def _remedy(one: Slipping, system: System) -> str:
    if one.critical == np.inf:
        return "nothing damps what swings on it; give it a dashpot"
    smooth = _speed(one.critical, system)
    return f"{smooth} would be smooth; draw faster, or by what is stiffer or damped more"


def lag_cautions(boom: Boom, data: xr.Dataset, system: System) -> list[str]:
    """Where what is drawn lags so far behind that pads press in other places, a line each.

    Args:
        boom: of a case.
        data: the trajectories of its models.
        system: of the lines.
    """
    found = []
    for number, joint in enumerate(boom.joints, start=1):
        name = "drive_lag" if number == 1 else f"drive_lag-{number}"
        if name in data:
            lag, overlap = float(np.abs(data[name]).max()), boom.overlap_left(joint)
            if lag > FAR_BEHIND * overlap:
                found.append(
                    f"caution: {boom.segments[joint.inner].name!r} lags up to "
                    f"{_length(lag, system)} behind its drive, more than "
                    f"{TO_PERCENT * FAR_BEHIND:g} % of the {_length(overlap, system)} of overlap: "
                    "the motion across the boom, which goes by the drive, does not feel that"
                )
    return found

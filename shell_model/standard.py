# SPDX-License-Identifier: LGPL-3.0-or-later
"""Common reduced shell of booms that differ only in play and magnitudes of loads.

The reduced coordinates do not depend on play and magnitudes of loads. So the boom is reduced
without play and under unit loads, and its system then receives play, loads and histories. In space,
contact points depend on the play, so that only booms of equal play have a common shell.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from protractile.dynamics.excitation import Excitation, InitialImpulse, ReleasedLoad, Step
from protractile.geometry.boom import Boom, Joint, Segment
from protractile.geometry.load import Load
from protractile.shell_model.reduced_shell import ReducedShell


def standard_boom(boom: Boom) -> Boom:
    """Return the boom with unit loads, if flat also without play."""
    joints = boom.joints
    if not boom.spatial:
        joints = tuple(
            joint
            if _has_shims(joint)
            else replace(joint, play=0.0, play_above=None, interference=0.0)
            for joint in joints
        )
    return replace(
        boom,
        segments=tuple(map(_unit_segment, boom.segments)),
        joints=joints,
        loads=tuple(
            replace(load, magnitude=float(load.magnitude != 0.0), history=Step())
            if _is_varying(load)
            else load
            for load in boom.loads
        ),
        axial_changes=(),
    )


def with_plays_and_loads(shell: ReducedShell, boom: Boom) -> ReducedShell:
    """Return the reduced shell of ``boom``, from ``shell``, that of its :func:`standard_boom`."""
    system = shell.system
    # Rows of stops and pads with shims, and all rows of 3-D booms, already have their clearances.
    clearances = [
        (0.0, 0.0)
        if boom.spatial or station.joint is None or _has_shims(station.joint)
        else station.joint.clearances("z")
        for station in boom.stations
    ]
    factors = np.array([_own_load(segment) for segment in boom.segments])
    changing = [load for load in boom.loads if _is_varying(load)]
    system_with_play = replace(
        system,
        laws=[
            law.with_clearance(*clearances[station]) if any(clearances[station]) else law
            for law, station in zip(system.laws, system.station_of_row.tolist(), strict=True)
        ],
        load=system.load - shell.own_loads.sum(axis=0) + factors @ shell.own_loads,
        excitations=[
            Excitation(load.magnitude * unit.load, load.history)
            for load, unit in zip(changing, system.excitations, strict=True)
        ],
    )
    return replace(shell, system=system_with_play, own_loads=factors[:, None] * shell.own_loads)


def _own_load(segment: Segment) -> float:
    """Return the magnitude of the uniform loads of a segment in N/m."""
    return segment.load or (0.0 if segment.lateral is None else segment.lateral.load)


def _unit_segment(segment: Segment) -> Segment:
    unit = _own_load(segment)
    if unit == 0.0:
        return segment
    lateral = segment.lateral
    if lateral is not None:
        lateral = replace(lateral, load=lateral.load / unit)
    return replace(segment, load=segment.load / unit, lateral=lateral)


def _is_varying(load: Load) -> bool:
    """Return whether a load acts after t = 0."""
    return not isinstance(load.history, ReleasedLoad | InitialImpulse)


def _has_shims(joint: Joint) -> bool:
    return any(pad.shim for pad in joint.pads)

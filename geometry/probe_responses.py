# SPDX-License-Identifier: LGPL-3.0-or-later
"""Probe responses: compliance of a shell segment to loads that a calibrated beam reproduces.

The probes are forces and torques at the ends and stations of the segment, and moments at its ends.
Each is distributed over the section like the stress of a beam, which avoids local deformation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom

ProbedMotion = Literal["z", "y", "twist"]

# Frequency of probes in Hz, far below all elastic modes.
PROBE_FREQUENCY = 2.0


@dataclass(frozen=True, slots=True)
class ProbeResponses:
    """Dynamic compliance of a segment to unit forces and moments (probes)."""

    #: ascending x in m of forces and torques. Moments act at the first and the last x.
    places: tuple[float, ...]
    #: matrices (num_probes, num_probes) in m/N, rad/N and rad/(N·m) at ``PROBE_FREQUENCY``, keyed
    #: by motion; for bending, forces come before moments
    compliance: Mapping[ProbedMotion, Array]


def probe_places(boom: Boom, number: int) -> tuple[float, ...]:
    """Return the x in m of a segment's probes."""
    segment = boom.segments[number]
    return tuple(sorted({segment.start, *boom.stations_of(number), segment.end}))

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Probe responses: compliance of a segment to beam-like loads, which a calibrated beam matches.

The probes are forces and torques at the segment's ends and stations, and moments at its ends. Each
is distributed over the section like the stress of a beam, so that it causes no local deformation.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from geometry.arrays import Array
from geometry.boom import Boom

ProbedMotion = Literal["z", "y", "twist"]

# Frequency of probes in Hz, low compared with all elastic motion. Self-equilibrated forces do not
# excite rigid motion.
PROBE_FREQUENCY = 2.0


@dataclass(frozen=True, slots=True)
class ProbeResponses:
    """Compliance of a segment to probes.

    Args:
        places: ascending x in m of forces and torques; the first and the last one also of moments.
        compliance: compliance (num_probes, num_probes) at σ = (2π · ``PROBE_FREQUENCY``)² in m/N,
            rad/N and rad/(N·m), by motion; for bending, forces come before moments.
    """

    places: tuple[float, ...]
    compliance: Mapping[ProbedMotion, Array]


def probe_places(boom: Boom, number: int) -> tuple[float, ...]:
    """Return the x in m of a segment's probes."""
    segment = boom.segments[number]
    return tuple(sorted({segment.start, *boom.stations_of(number), segment.end}))

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Far field: compliance of a segment far from its loads, which a beam has to match.

Forces at the segment's ends and stations, moments at its ends, and torques where forces are. Each
is distributed over the section as the stress of a beam, so that only the segment bends.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from geometry.arrays import Array
from geometry.boom import Boom

ProbedMotion = Literal["z", "y", "twist"]

# Hz: slow beside all elastic motion; forces that leave a free segment at rest do not excite it.
PROBE_FREQUENCY = 2.0


@dataclass(frozen=True, slots=True)
class ProbeResponses:
    """Compliance of a segment between the places where it is probed.

    Args:
        places: x in m of forces and torques, rising; the first and the last also of moments.
        compliance: motion → (num_probes, num_probes) at σ = (2π · ``PROBE_FREQUENCY``)² in m/N,
            rad/N and rad/(N·m); of bending the forces come first.
    """

    places: tuple[float, ...]
    compliance: Mapping[ProbedMotion, Array]


def probe_places(boom: Boom, number: int) -> tuple[float, ...]:
    """Return the x in m where a segment is probed."""
    segment = boom.segments[number]
    return tuple(sorted({segment.start, *boom.stations_of(number), segment.end}))

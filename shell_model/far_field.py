# SPDX-License-Identifier: LGPL-3.0-or-later
"""The far field of a shell's segment, of which a beam's stiffness is read."""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.boom import Boom
from geometry.far_field import FAR_SHIFT, Bent, FarField, far_places
from shell_model.contact.local_compliance import shell_compliance
from shell_model.reduction.symmetry import Folding


def far_field(boom: Boom, number: int, folding: Folding) -> FarField:
    """Probe a segment, all degrees of freedom in. Collective.

    Of a boom in space sideways and about its axis, too; the mesh has lines at its places.
    """
    places, shell = far_places(boom, number), folding.shell
    probes: dict[Bent, list[Array]] = {
        direction: [
            *(shell.force(x, direction) for x in places),
            *(shell.moment(x, direction) for x in (places[0], places[-1])),
        ]
        for direction in boom.directions
    }
    if boom.spatial:
        probes["twist"] = [shell.torque(x) for x in places]
    whole = shell_compliance(
        folding, np.array([row for rows in probes.values() for row in rows]).T, FAR_SHIFT
    )
    found, first = {}, 0
    for motion, rows in probes.items():
        own = slice(first, first + len(rows))
        found[motion], first = whole[own, own], own.stop
    return FarField(places, found)

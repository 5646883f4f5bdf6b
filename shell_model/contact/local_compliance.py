# SPDX-License-Identifier: LGPL-3.0-or-later
"""Local compliance of walls at contacts, the scale of errors of mesh and reduction.

The compliance of a contact row at a low shift is mainly rigid motion, about 1e-6 m/N compared with
3e-9 m/N of the wall. Opposite unit forces on both sides of a station cause no rigid motion and no
beam bending. Half of the relative displacement of both sides is the *local compliance*.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from protractile.dynamics.contact import ContactLaw
from protractile.dynamics.gap_builder import LawRow
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.probe_responses import ProbedMotion, ProbeResponses, probe_places
from protractile.shell_model.reduction.symmetry import Job, SymmetryReduction
from protractile.shell_model.segment.cross_section import Operator
from protractile.shell_model.segment.segment_shell import SegmentShell
from protractile.shell_model.segment.solver import ShiftedSolver, squared

# Frequency f in Hz of the shift σ = (2π f)², between rigid and elastic modes.
SLOW = 20.0


def compliance(omega2: Array, rows: Array) -> Array:
    """Return B diag(ω² + σ)⁻¹ Bᵀ (num_rows, num_rows) in m/N for rows B (num_rows, num_modes)."""
    return np.asarray(rows / (omega2 + squared(SLOW)) @ rows.T)


def full_compliance(
    shells: Sequence[SegmentShell], contacts: Sequence[LawRow[Operator, ContactLaw]]
) -> Array:
    """Return the compliance (num_contacts, num_contacts) in m/N of full shells. Collective."""
    compliance = np.zeros((len(contacts), len(contacts)))
    for number, shell in enumerate(shells):
        touching = [i for i, contact in enumerate(contacts) if number in contact.operator]
        parts = [shell.row(contacts[i].operator[number]) for i in touching]
        rows = np.array(parts).reshape(-1, shell.free.size).T
        # These symmetry reductions are used only once.
        compliance[np.ix_(touching, touching)] += shell_compliance(SymmetryReduction(shell), rows)
    return compliance


def shell_compliance(symmetry: SymmetryReduction, rows: Array, frequency: float = SLOW) -> Array:
    """Return the compliance (num_rows, num_rows) in m/N of a full shell. Collective.

    Rows are (num_owned, num_rows). The frequency of the shift is in Hz.
    """

    def compliance_of_class(_: int, job: Job) -> Array:
        solve = ShiftedSolver(job.shell(symmetry.cell), frequency)
        compliance = job.forces.T @ solve(job.forces)
        solve.destroy()
        return compliance

    return symmetry.sum_classes(rows, np.zeros((rows.shape[1], rows.shape[1])), compliance_of_class)


def local_compliance(
    whole: Array, laws: Sequence[ContactLaw], station_of_row: Sequence[int]
) -> Array:
    """Return the local compliance (num_rows,) in m/N; NaN for a row without an opposite contact.

    Args:
        whole: compliance (num_rows, num_rows) in m/N.
        laws, station_of_row: contact law and station of each row.
    """
    local = np.full(len(laws), np.nan)
    for up, down in _opposite(laws, station_of_row):
        opening = whole[up, up] + whole[down, down] - 2.0 * whole[up, down]
        local[[up, down]] = 0.5 * opening
    return local


def _opposite(
    laws: Sequence[ContactLaw], station_of_row: Sequence[int]
) -> Iterator[tuple[int, int]]:
    """Yield pairs of indices of rows on opposite sides of a station.

    If one side has more rows, several rows of this side have the same opposite row.
    """
    for station in set(station_of_row):
        there = [i for i, at in enumerate(station_of_row) if at == station]
        above = [i for i in there if laws[i].terms[0].side > 0.0]
        below = [i for i in there if laws[i].terms[0].side < 0.0]
        most = max(len(above), len(below)) if above and below else 0
        for k in range(most):
            yield above[k * len(above) // most], below[k * len(below) // most]


def probe_loads(boom: Boom, number: int, shell: SegmentShell) -> Array:
    """Return the load vectors (num_owned, num_probes) of all probes of a segment.

    In space they include lateral bending and torsion. The mesh needs mesh lines at all probes.
    """
    places = probe_places(boom, number)
    loads = [
        load
        for direction in boom.directions
        for load in (
            *(shell.unit_load_vector(x, direction) for x in places),
            *(shell.moment(x, direction) for x in (places[0], places[-1])),
        )
    ]
    if boom.spatial:
        loads += [shell.torque(x) for x in places]
    return np.array(loads).T


def probe_responses(boom: Boom, number: int, compliance: Array) -> ProbeResponses:
    """Return the probe responses of a segment from the compliance of its :func:`probe_loads`.

    The compliance is (num_probes, num_probes), at ``PROBE_FREQUENCY``.
    """
    places, responses, first = probe_places(boom, number), {}, 0
    motions: Sequence[ProbedMotion] = [*boom.directions, "twist"] if boom.spatial else ["z"]
    for motion in motions:
        block = slice(first, first + len(places) + (0 if motion == "twist" else 2))
        responses[motion], first = compliance[block, block], block.stop
    return ProbeResponses(places, responses)

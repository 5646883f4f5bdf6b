# SPDX-License-Identifier: LGPL-3.0-or-later
"""Local compliance of walls at contacts, the reference of errors of mesh and reduction.

Rigid motion dominates the compliance of a contact row, B (Ω² + σ)⁻¹ Bᵀ at a low shift: about 1e-6
m/N, compared with 3e-9 m/N of the wall. Equal and opposite forces on the two sides of a station are
in equilibrium. They cause no rigid motion and no beam bending, and half of the station's opening
under unit forces is the *local compliance* of each side. Errors of the compliance are fractions of
it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from dynamics.contact import ContactLaw
from dynamics.gap_builder import LawRow
from geometry.arrays import Array
from geometry.boom import Boom
from geometry.probe_responses import PROBE_FREQUENCY, ProbedMotion, ProbeResponses, probe_places
from shell_model.reduction.symmetry import Job, SymmetryReduction
from shell_model.segment.cross_section import Reading
from shell_model.segment.segment_shell import SegmentShell
from shell_model.segment.solver import ShiftedSolver

# Frequency of the shift in Hz, above rigid motion and below all elastic motion.
SLOW = 20.0


def compliance(omega2: Array, rows: Array) -> Array:
    """Return the compliance B (Ω² + σ)⁻¹ Bᵀ (num_rows, num_rows) in m/N of the rows B.

    The shift is σ = (2π · ``SLOW``)².
    """
    return np.asarray(rows / (omega2 + (2.0 * np.pi * SLOW) ** 2) @ rows.T)


def full_compliance(
    shells: Sequence[SegmentShell], contacts: Sequence[LawRow[Reading, ContactLaw]]
) -> Array:
    """Return the compliance (num_contacts, num_contacts) of unreduced shells. Collective."""
    found = np.zeros((len(contacts), len(contacts)))
    for number, shell in enumerate(shells):
        touching = [i for i, contact in enumerate(contacts) if number in contact.reading]
        parts = [shell.row(contacts[i].reading[number]) for i in touching]
        rows = np.array(parts).reshape(-1, shell.free.size).T
        # The function needs only the symmetry reductions of these shells.
        found[np.ix_(touching, touching)] += shell_compliance(SymmetryReduction(shell), rows)
    return found


def shell_compliance(symmetry: SymmetryReduction, rows: Array, frequency: float = SLOW) -> Array:
    """Return the compliance (num_rows, num_rows) in m/N of an unreduced shell. Collective.

    Rows are (num_owned, num_rows); a frequency in Hz determines the shift.
    """

    def answers(_: int, job: Job) -> Array:
        solve = ShiftedSolver(job.shell(symmetry.cell), frequency)
        found = job.forces.T @ solve(job.forces)
        solve.destroy()
        return found

    return symmetry.sum_classes(rows, np.zeros((rows.shape[1], rows.shape[1])), answers)


def local_compliance(
    whole: Array, laws: Sequence[ContactLaw], station_of_row: Sequence[int]
) -> Array:
    """Return the local compliance (num_rows,) in m/N; NaN without a contact on the other side.

    Args:
        whole: compliance (num_rows, num_rows) in m/N.
        laws, station_of_row: contact law and station of each row.
    """
    found = np.full(len(laws), np.nan)
    for up, down in _opposite(laws, station_of_row):
        opening = whole[up, up] + whole[down, down] - 2.0 * whole[up, down]
        found[[up, down]] = 0.5 * opening
    return found


def extrapolated_error(fine: Array, coarse: Array, order: float) -> Array:
    """Estimate the relative discretisation error of values by extrapolation (Richardson 1911).

    Args:
        fine, coarse: values of the mesh, and of a mesh with edges of twice the length.
        order: convergence order of the values.
    """
    return np.asarray(np.abs(1.0 - coarse / fine) / (2.0**order - 1.0))


def _opposite(
    laws: Sequence[ContactLaw], station_of_row: Sequence[int]
) -> Iterator[tuple[int, int]]:
    """Pair the rows that press up with those that press down at the same place of their station.

    If one side has more pads, several of them have the same opposite pad.
    """
    for station in set(station_of_row):
        there = [i for i, at in enumerate(station_of_row) if at == station]
        above = [i for i in there if laws[i].terms[0].side > 0.0]
        below = [i for i in there if laws[i].terms[0].side < 0.0]
        most = max(len(above), len(below)) if above and below else 0
        for k in range(most):
            yield above[k * len(above) // most], below[k * len(below) // most]


def probe_segment(boom: Boom, number: int, symmetry: SymmetryReduction) -> ProbeResponses:
    """Compute the unit responses of a segment with all degrees of freedom. Collective.

    In space they include lateral bending and torsion. The mesh must have lines at the places of
    unit loads.
    """
    places, shell = probe_places(boom, number), symmetry.shell
    probes: dict[ProbedMotion, list[Array]] = {
        direction: [
            *(shell.unit_load_vector(x, direction) for x in places),
            *(shell.moment(x, direction) for x in (places[0], places[-1])),
        ]
        for direction in boom.directions
    }
    if boom.spatial:
        probes["twist"] = [shell.torque(x) for x in places]
    whole = shell_compliance(
        symmetry, np.array([row for rows in probes.values() for row in rows]).T, PROBE_FREQUENCY
    )
    found, first = {}, 0
    for motion, rows in probes.items():
        own = slice(first, first + len(rows))
        found[motion], first = whole[own, own], own.stop
    return ProbeResponses(places, found)

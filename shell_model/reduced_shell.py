# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reduction of the boom's shells to a gap system, with errors of reduction and mesh."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import BrokenExecutor, Executor
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
import xarray as xr
from mpi4py import MPI

from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.stability import closed_contact_factor, closing_loads
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.plating import PlatedMesh
from protractile.geometry.probe_responses import ProbeResponses
from protractile.shell_model.boom_shell import BoomShell, ShellOptions, assemble_boom
from protractile.shell_model.contact.local_compliance import (
    compliance,
    full_compliance,
    local_compliance,
    probe_loads,
    probe_responses,
)
from protractile.shell_model.contact.rows import ties
from protractile.shell_model.contact.surface import (
    SURFACE_MOMENTS,
    SURFACE_SHIFTS,
    without_stiff_modes,
)
from protractile.shell_model.reduction.coordinates import BoomCoordinates
from protractile.shell_model.reduction.segment import ReducedSegment, SegmentInputs, reduce_segments
from protractile.shell_model.reduction.symmetry import result_or_compute
from protractile.shell_model.stages import Stages
from protractile.shell_model.stress.fields import gather_fields
from protractile.shell_model.telescoping import MOMENTS, TelescopingShell


@dataclass(frozen=True, slots=True)
class ReducedShell:
    """Gap system of the reduced shells, with errors and computing times."""

    system: GapSystem  #: gap system of all segments
    num_dofs: int  #: number of degrees of freedom before the reduction
    #: displacements and stresses of all modes on rank 0, see
    #: :func:`.shell_model.stress.fields.gather_fields`
    fields: xr.Dataset | None
    #: largest reduction errors of all segments: ``contact_compliance``, relative to the local
    #: compliance, NaN without contacts; ``deflections``, of outputs such as the tip. Natural
    #: frequencies are accurate up to ``frequency_limit_in_hz``.
    errors: dict[str, float]
    #: local compliances (num_rows,) of the contacts in m/N, see
    #: :func:`.shell_model.contact.local_compliance.local_compliance`
    local_compliance: Array
    #: largest relative discretisation error of the local compliance; NaN without contacts
    mesh_error: float
    seconds: dict[str, float]  #: wall time of each stage in s
    meshes: Sequence[PlatedMesh]  #: mesh of each segment, on rank 0
    #: buckling factor of the axial forces with bonded joints, see
    #: :func:`.dynamics.second_order.buckling_factor`; infinite without axial forces
    critical_factor: float | None = float("inf")
    #: probe responses of the segments, for the calibration of beams
    probe_responses: Sequence[ProbeResponses] = ()
    #: contributions (num_segments, num_modes) of the uniform loads of segments to ``system.load``,
    #: in N/√kg
    own_loads: Array = field(default_factory=lambda: np.zeros((0, 0)))
    #: K_G (num_modes, num_modes) of axial forces in 1/s², which ``system`` includes; without
    #: springs of telescoping shells, which come last
    geometric: Array = field(default_factory=lambda: np.zeros((0, 0)))
    #: orthonormal coefficients (num_modes, num_coarser) of a coarser basis within that of
    #: ``system``; as many as modes if there is none
    coarser: Array = field(default_factory=lambda: np.zeros((0, 0)))

    def critical_factor_at(self, system: GapSystem, load: Array) -> float:
        """Return the buckling factor of all axial forces with the contacts closed under a load.

        A small force across the tip closes contacts that the load does not press. In space the
        factor is the lower one of both directions.

        Args:
            system: completed system of this shell, at a fixed extension.
            load: modal load (num_modes,) in N/√kg.

        Raises:
            NumericsError: there is no equilibrium under the load.
        """
        geometric = np.pad(self.geometric, (0, system.num_modes - len(self.geometric)))
        if system.geometric_stiffness.size:
            geometric = geometric + system.geometric_stiffness
        rests = [equilibrium(system, closing) for closing in closing_loads(system, load)]
        return min(closed_contact_factor(system, geometric, rest) for rest in rests)


def reduce_boom(
    boom: Boom,
    options: ShellOptions,
    comm: MPI.Comm,
    progress: Callable[[str, float], None] | None = None,
    helper: Executor | None = None,
) -> ReducedShell:
    """Return the reduced shells of a boom. Collective.

    Args:
        boom: boom whose segments all have sections.
        options: options of mesh, contact and reduction.
        comm: ranks that share the work; the result is the same on each.
        progress: callback that receives the stage and its completed fraction.
        helper: second process that shares the work, for a single rank.

    Raises:
        BoomError: a segment has no section, or the contact line does not suit the boom.
    """
    stages = Stages(progress)
    full = replace(assemble_boom(boom, options, comm, stages), helper=helper)
    telescoping = None
    if boom.telescopes:
        krylov = replace(options.krylov, moments=MOMENTS, tolerance=None)
        fewer = replace(options, krylov=krylov)
        reduce = partial(_reduce, boom, full, fewer, stages)
        test = options.krylov.tests[0]
        telescoping = TelescopingShell(boom, full, options.mesh_size, reduce, test)
        segments = telescoping.reduced
    else:
        nothing = [np.zeros((shell.free.size, 0)) for shell in full.shells]
        segments = _reduce(boom, full, options, stages, nothing)
    coordinates = BoomCoordinates(full, segments, full.ties, full.lines)
    with stages.stage("rows"):
        own_loads = np.array([coordinates.push(i, load) for i, load in enumerate(full.own_loads)])
        system = _gap_system(full, coordinates, own_loads)
        if telescoping:
            system = telescoping.with_springs(system, coordinates)
            own_loads = np.pad(own_loads, ((0, 0), (0, system.num_modes - own_loads.shape[1])))
    if telescoping:
        whole = compliance(system.omega2, system.rows)
        compliance_errors = telescoping.compliance_error(len(system.laws))
    else:
        whole, compliance_errors = _contact_compliance(full, segments)
    coarse = None
    if helper is not None:
        with suppress(BrokenExecutor):
            coarse = helper.submit(_mesh_compliance, boom, options.coarser)
    with stages.stage("fields"):
        fields = gather_fields(boom, full.shells, segments, coordinates, system)
    with stages.stage("mesh error"):
        local = _contact_local_compliance(whole, full)
        coarse_local = result_or_compute(
            coarse, partial(_mesh_compliance, boom, options.coarser, comm)
        )
        # Extrapolation from the mesh with edges of twice the length (Richardson 1911).
        mesh_error = np.abs(1.0 - coarse_local / local) / (2.0**options.order - 1.0)
    return ReducedShell(
        system=system,
        num_dofs=full.num_dofs,
        fields=fields,
        errors={
            "contact_compliance": _largest(compliance_errors / local),
            "deflections": max(segment.output_error for segment in segments),
            "frequency_limit_in_hz": min(segment.frequency_limit for segment in segments),
        },
        local_compliance=local,
        mesh_error=_largest(mesh_error),
        seconds=stages.seconds,
        meshes=[shell.mesh for shell in full.shells if shell.mesh is not None],
        critical_factor=critical_factor(boom, full, segments),
        probe_responses=[
            probe_responses(boom, number, segment.probe_compliance)
            for number, segment in enumerate(segments)
        ],
        own_loads=own_loads,
        geometric=coordinates.geometric,
        coarser=coordinates.coarser,
    )


def _mesh_compliance(boom: Boom, options: ShellOptions, comm: MPI.Comm = MPI.COMM_SELF) -> Array:
    """Return the local compliance (num_contacts,) in m/N of full shells. Collective."""
    shell = assemble_boom(boom, options, comm)
    return _contact_local_compliance(full_compliance(shell.shells, shell.rows.contacts), shell)


def _contact_local_compliance(whole: Array, shell: BoomShell) -> Array:
    """Return the local compliance (num_contacts,) in m/N from the compliance of all contacts."""
    rows = shell.rows.contacts
    return local_compliance(whole, [row.law for row in rows], [row.station for row in rows])


def _contact_compliance(full: BoomShell, segments: Sequence[ReducedSegment]) -> tuple[Array, Array]:
    """Return compliance (num_contacts, num_contacts) of contacts, and its error, both in m/N.

    The error (num_contacts,) is the sum of the errors of all reduced segments. Collective.
    """
    separate = BoomCoordinates(full, segments, ())
    contacts = full.rows.contacts
    rows = np.array([separate.row(contact.operator) for contact in contacts])
    errors = np.zeros(len(contacts))
    for number, segment in enumerate(segments):
        touching = [i for i, contact in enumerate(contacts) if number in contact.operator]
        errors[touching] += segment.lost_compliance[: len(touching)]
    return compliance(separate.omega2, rows.reshape(-1, separate.omega2.size)), errors


def _reduce(
    boom: Boom,
    full: BoomShell,
    options: ShellOptions,
    stages: Stages,
    extra_forces: Sequence[Array],
) -> list[ReducedSegment]:
    """Return all segments, reduced for their forces, outputs and probes. Collective.

    ``extra_forces`` are further load vectors (num_owned, num_extra) of each segment.
    """
    krylov, observed = options.krylov, [output.operator for output in full.observed.values()]
    at_surface = options.contact_line == "surface"
    if at_surface:
        krylov = replace(krylov, shifts=SURFACE_SHIFTS, moments=SURFACE_MOMENTS, tolerance=None)
    with stages.stage("reduction") as progress:
        inputs = [
            SegmentInputs(
                symmetry,
                np.hstack([full.forces(number), extra]),
                full.columns(number, observed),
                probe_loads(boom, number, full.shells[number]),
            )
            for number, (symmetry, extra) in enumerate(
                zip(full.symmetries, extra_forces, strict=True)
            )
        ]
        segments = reduce_segments(inputs, krylov, progress, full.helper)
        if at_surface:
            joined = [full.joint_rows(number) for number in range(len(segments))]
            segments = [
                without_stiff_modes(full.comm, segment, rows) if rows.size else segment
                for segment, rows in zip(segments, joined, strict=True)
            ]
    return segments


def _gap_system(full: BoomShell, coordinates: BoomCoordinates, own_loads: Array) -> GapSystem:
    """Return the gap system of the boom in reduced coordinates."""
    return full.rows.system(
        coordinates.row,
        coordinates.omega2,
        sum((coordinates.push(*moment) for moment in full.pin_moments), own_loads.sum(axis=0)),
        [(station.x, station.direction) for station in full.touching.boom.stations],
        full.observed,
        [(coordinates.push(load.segment, push), load.history) for load, push in full.loads],
        [
            (line.force, coordinates.push(line.segment, line.push), line.stiffness, line.dashpot)
            for line in full.lines
        ],
    )


def _largest(parts: Array) -> float:
    """Return the maximum of the finite values; NaN if there are none."""
    return float(np.nanmax(parts)) if np.isfinite(parts).any() else float("nan")


def critical_factor(boom: Boom, full: BoomShell, reduced: Sequence[ReducedSegment]) -> float | None:
    """Return the buckling factor of the axial forces with bonded joints. Collective.

    It is infinite without axial forces.

    Raises:
        NumericsError: the factor is 1 or less: the boom buckles.
    """
    if not boom.compressed:
        return float("inf")
    bonds = ties(boom.bonded, full.shells)
    factor = BoomCoordinates(full, reduced, bonds, full.lines).critical_factor
    refuse_buckling(factor)
    return factor


def refuse_buckling(factor: float | None) -> None:
    """Refuse a shell that buckles under its axial forces.

    Raises:
        NumericsError: the buckling factor is 1 or less.
    """
    if factor is not None and factor <= 1.0:
        raise NumericsError(
            f"the shell of the boom buckles under {factor:.3g} times its axial forces; make these "
            "smaller, or the sections larger"
        )

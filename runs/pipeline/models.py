# SPDX-License-Identifier: LGPL-3.0-or-later
"""The gap system of each model of a case."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from beam_model.finite_element import finite_element_segment
from beam_model.kantorovich import kantorovich_segment
from beam_model.segment_model import gap_system, tied_system
from dynamics.damping import with_ratio
from dynamics.gap_system import GapSystem
from geometry.boom import Boom
from runs.case.build import contact_laws, lateral_laws
from runs.case.schema import Case, FiniteElementTable, KantorovichTable, ShellTable
from runs.folder.cache import Cache

if TYPE_CHECKING:
    from mpi4py import MPI

    from shell_model.boom_shell import ReducedShell, ShellOptions
    from shell_model.reduction.krylov import KrylovOptions


def beam_system(case: Case, boom: Boom, model: KantorovichTable | FiniteElementTable) -> GapSystem:
    """A series or beam elements.

    Args:
        case: its joints have the contact laws.
        boom: of the case.
        model: one of the case's.

    Raises:
        BoomError: the boom lacks what the model needs.
    """
    laws, lateral = contact_laws(case, model), lateral_laws(case, model)
    if isinstance(model, KantorovichTable):
        segments = [
            kantorovich_segment(segment, terms, model.base, model.rotary_inertia)
            for segment, terms in zip(boom.segments, model.terms, strict=True)
        ]
        return gap_system(boom, segments, laws, lateral)
    segments = [
        finite_element_segment(
            segment,
            model.element_length,
            boom.stations_of(number),
            model.theory,
            model.rotary_inertia,
        )
        for number, segment in enumerate(boom.segments)
    ]
    if model.tied:
        return tied_system(boom, segments)
    return gap_system(boom, segments, laws, lateral)


def reduce_shell(
    case: Case,
    boom: Boom,
    model: ShellTable,
    comm: MPI.Comm,
    mesh_folder: Path,
    tell: Callable[[str, float], None],
    cache: Cache | None = None,
) -> ReducedShell:
    """The shell, reduced. Collective.

    Args:
        case, boom, model: as in :func:`beam_system`.
        comm: the ranks that share the work.
        mesh_folder: where gmsh's files go, ``SEGMENT.msh``.
        tell: told the stage and the part of it that is done.
        cache: where the same shell may be already, and is kept; computed unless given.
    """
    from runs.folder.shell_cache import remembered
    from shell_model.boom_shell import reduce_boom

    if comm.rank == 0:
        mesh_folder.mkdir(parents=True)
    options = replace(shell_options(model), mesh_folder=mesh_folder)
    laws, lateral = contact_laws(case, model), lateral_laws(case, model)
    compute = partial(reduce_boom, boom, laws, options, comm, tell, lateral)
    if cache is None:
        return compute()
    content = (boom, laws, lateral, replace(options, mesh_folder=None))
    return remembered(cache, content, comm, mesh_folder, compute)


def shell_options(model: ShellTable) -> ShellOptions:
    """How a boom becomes the shells that a model asks for."""
    from shell_model.boom_shell import ShellOptions
    from shell_model.contact.surface import POINTS, SurfaceOptions

    return ShellOptions(
        mesh_size=model.mesh_size,
        contact_line=model.contact_line,
        surface=SurfaceOptions(model.surface_points or POINTS, model.surface_stiffness),
        krylov=_krylov(model),
        contact_tolerance=None if model.contact_tolerance == "any" else model.contact_tolerance,
    )


def _krylov(model: ShellTable) -> KrylovOptions:
    from shell_model.reduction.krylov import KrylovOptions

    if model.modes == "auto":
        return KrylovOptions(tolerance=model.tolerance)
    return KrylovOptions(most=model.modes)


def damped(system: GapSystem, case: Case) -> GapSystem:
    """A model's system with the damping of its case besides the segments' own.

    Rayleigh's is α + β ω² in the modes of the segments; a damping ratio is one of the boom's modes
    with its joints pressed (:func:`dynamics.damping.with_ratio`).
    """
    table = case.damping
    rates = system.damping + table.mass + table.stiffness * system.omega2
    system = replace(system, damping=rates)
    if table.modal == 0.0:
        return system
    return with_ratio(system, table.modal, joint_stations(system, case))


def joint_stations(system: GapSystem, case: Case) -> int:
    """How many stations of a model are those of joints; those of stops follow."""
    return len(system.stations) - len(case.stops)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Export of the shells of a boom at rest as an input deck for CalculiX, in the form of Abaqus.

Each triangle is an S6 element. Elastic supports, cylinders and pads act on weighted means of
displacements. An equation makes each mean the displacement of an additional node, which has a
spring to the ground. A contact that is closed in the static state is a spring with the tangent
stiffness of its law, and a force that gives the static contact force. Axial forces are loads K_G w,
with the static deflection w. Open contacts and friction are left out, so that the deck is linear.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from protractile.dynamics.excitation import InitialImpulse, ReleasedLoad
from protractile.geometry.arrays import Array
from protractile.geometry.typography import choices
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext, select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.folder.cache import Cache
from protractile.runs.folder.files import write_atomically
from protractile.runs.pipeline.models import build
from protractile.runs.process.bad_input import BadInput

if TYPE_CHECKING:
    from mpi4py import MPI

    from protractile.shell_model.segment.cross_section import Row
    from protractile.shell_model.segment.segment_shell import SegmentShell

# Stiffness in N/m for a mean displacement without a spring, since CalculiX permits no free node.
_FREE = 1.0e-3

# Number of terms in a line of an equation.
_TERMS = 4


class SpringRow(NamedTuple):
    """Spring to the ground on a weighted mean of displacements."""

    name: str  #: comment in the deck
    parts: Mapping[int, Array]  #: weights (num_owned,) of displacements, by number of the segment
    stiffness: float = _FREE  #: stiffness in N/m, or in N·m/rad
    force: float = 0.0  #: force in N on the mean displacement


def deck(
    title: str,
    shells: Sequence[SegmentShell],
    springs: Sequence[SpringRow],
    loads: Sequence[Array],
    step: str = "*STATIC",
) -> str:
    """Return the input deck of shells, whose data must be on one process.

    The shells include springs of elastic supports. CalculiX prints the displacements of further
    springs. Loads (num_owned,) of each segment are in N, ``step`` has the lines of the analysis
    step.
    """
    *first, spring_nodes = np.cumsum([1, *(len(shell.nodes) for shell in shells)]).tolist()
    meshes = [shell.mesh for shell in shells if shell.mesh is not None]
    *elements, spring = np.cumsum([1, *(len(mesh.triangles) for mesh in meshes)]).tolist()
    held_rows = [
        SpringRow("support", {n: row}, factor)
        for n, shell in enumerate(shells)
        for row, factor in zip(shell.springs.rows.T, shell.springs.factors, strict=True)
    ]
    rows = [row for row in (*springs, *held_rows) if any(part.any() for part in row.parts.values())]
    lines = ["*HEADING", f"Boom: {title}", "** SI units; x along the boom, z in its plane."]
    for n, shell in enumerate(shells):
        lines += _segment(n + 1, shell, first[n], elements[n])
    lines += ["*NODE, NSET=READINGS"]
    lines += [f"{spring_nodes + i}, 0, 0, 0" for i in range(len(rows))]
    lines += ["*BOUNDARY", "READINGS, 2, 3"]
    for i, row in enumerate(rows):
        terms = [(spring_nodes + i, 1, -1.0)]
        for n, part in row.parts.items():
            terms += _nodal(shells[n], part, first[n])
        lines += [f"** {row.name}", "*EQUATION", str(len(terms))]
        for start in range(0, len(terms), _TERMS):
            some = terms[start : start + _TERMS]
            lines.append(", ".join(f"{node}, {dof}, {weight:.10e}" for node, dof, weight in some))
        lines += [
            f"*ELEMENT, TYPE=SPRING1, ELSET=SPRING-{i + 1}",
            f"{spring + i}, {spring_nodes + i}",
        ]
        lines += [f"*SPRING, ELSET=SPRING-{i + 1}", "1", f"{row.stiffness:.10e}"]
    lines += ["*STEP", step, "*CLOAD"]
    for n, load in enumerate(loads):
        lines += [
            f"{node}, {dof}, {force:.10e}" for node, dof, force in _nodal(shells[n], load, first[n])
        ]
    lines += [f"{spring_nodes + i}, 1, {row.force:.10e}" for i, row in enumerate(rows) if row.force]
    lines += ["*NODE PRINT, NSET=READINGS", "U", "*NODE FILE", "U", "*END STEP"]
    return "\n".join(lines) + "\n"


def _segment(number: int, shell: SegmentShell, first: int, element: int) -> Iterator[str]:
    """Yield nodes, elements, sections and rigid supports of a segment."""
    mesh, material = shell.mesh, shell.segment.material
    assert mesh is not None
    yield f"*NODE, NSET=SEGMENT-{number}"
    for i, (x, y, z) in enumerate(shell.nodes, start=first):
        yield f"{i}, {x:.10e}, {y:.10e}, {z:.10e}"
    corners = mesh.points[mesh.triangles]
    # All normals of a wall point to the same side, since CalculiX makes a fold otherwise.
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    outwards = corners.mean(axis=1) * [0.0, 1.0, 1.0]
    outwards[~mesh.on_walls] = [1.0, 0.0, 0.0]
    inside = (normals * outwards).sum(axis=1) < 0.0
    corners[inside] = corners[inside, ::-1]
    midpoints = 0.5 * (corners + np.roll(corners, -1, axis=1))
    _, nodes = cKDTree(shell.nodes).query(np.concatenate([corners, midpoints], axis=1))
    thicknesses, groups = np.unique(mesh.thickness, return_inverse=True)
    yield f"*MATERIAL, NAME=STEEL-{number}"
    yield from ("*ELASTIC", f"{material.youngs_modulus:.10e}, {material.poissons_ratio:.10e}")
    yield from ("*DENSITY", f"{material.density:.10e}")
    for k, thickness in enumerate(thicknesses):
        name = f"WALLS-{number}-{k + 1}"
        yield f"*ELEMENT, TYPE=S6, ELSET={name}"
        for i in np.flatnonzero(groups == k):
            yield ", ".join(map(str, [element + i, *(nodes[i] + first)]))
        yield f"*SHELL SECTION, ELSET={name}, MATERIAL=STEEL-{number}"
        yield f"{thickness:.10e}"
    yield "*BOUNDARY"
    places, dofs = shell.plates.nodes[1]
    _, turned = cKDTree(shell.nodes).query(places)
    rows = [(shell.node_dofs, np.arange(len(shell.nodes)), 1), (dofs, turned, 4)]
    for global_rows, of, component in rows:
        held = ~shell.free[global_rows - shell.owned[0]]
        for node, axis in zip(*np.nonzero(held), strict=True):
            yield f"{of[node] + first}, {component + axis}, {component + axis}"


def _nodal(shell: SegmentShell, row: Array, first: int) -> list[tuple[int, int, float]]:
    """Return node, component and weight of each displacement in a row (num_owned,)."""
    values = row[shell.node_dofs - shell.owned[0]]
    return [
        (int(node) + first, int(axis) + 1, float(values[node, axis]))
        for node, axis in zip(*np.nonzero(values), strict=True)
    ]


def select_model(case: Case, file: str, name: str | None = None) -> Shell:
    """Return the shell with a name, by default the last one.

    Raises:
        BadInput: the case has no such shell.
    """
    shells = {model.name: model for model in select_kind(Shell, case.models)}
    if shells and name in (None, *shells):
        return shells[name or [*shells][-1]]
    what = f"must be {choices([*shells])}" if shells else "must be a shell, and there is none"
    raise BadInput(file, "--model", what)


def write(case: Case, file: str, comm: MPI.Intracomm, path: Path, cache: Cache | None) -> None:
    """Write the deck of the shell of :func:`select_model` under the loads at t = 0.

    The name ``file`` of the case is for messages, and ``cache`` has reduced shells.

    Raises:
        BadInput: the case has a feature that the deck does not support, or the ranks are several.
        NumericsError: the boom has no static state.
    """
    from protractile.dynamics.equilibrium import equilibrium_at
    from protractile.shell_model.boom_shell import assemble_boom
    from protractile.shell_model.buckling import TOUCHING, lateral_springs, rigid_stiffness
    from protractile.shell_model.segment.solver import times

    model = select_model(case, file)
    model_boom = model.model_boom(build_boom(case))
    boom = model_boom.boom
    for key, present in (
        ("mpirun", comm.size > 1),
        ("joint.lateral_play", boom.spatial),
        ("hoist", case.hoist is not None),
        ("rope", case.rope is not None),
    ):
        if present:
            what = "cannot be exported to CalculiX, for which one process writes a flat boom, with"
            raise BadInput(file, key, f"{what} no load on a rope; leave it out")
    built = build(case, boom, model, BuildContext(comm, cache=cache))
    rest = equilibrium_at(built.system)
    full = assemble_boom(boom, model.options(), comm)
    shells = full.shells

    def parts(operator: Mapping[int, Row]) -> dict[int, Array]:
        return {n: shells[n].row(row) for n, row in operator.items()}

    springs = [SpringRow(what, parts(seen.operator)) for what, seen in full.observed.items()]
    gaps = built.system.rows @ rest
    for contact, law, gap in zip(full.rows.contacts, built.system.laws, gaps, strict=True):
        force = float(law.force(np.array([gap]))[0])
        if force != 0.0:
            slope = float(law.slope(gap + np.array([-TOUCHING, TOUCHING])).max())
            what = f"contact that presses with {force:.6g} N"
            back = slope * gap - force
            springs.append(SpringRow(what, parts(contact.operator), slope, back))
    springs += [
        SpringRow("tie", parts(tie), rigid_stiffness(shells[min(tie)])) for tie in full.ties
    ]
    springs += [
        SpringRow(line.force, {line.segment: line.push}, line.stiffness) for line in full.lines
    ]
    loads = [load.copy() for load in full.own_loads]
    for action, push in full.loads:
        if isinstance(action.history, ReleasedLoad):
            loads[action.segment] += push
        elif not isinstance(action.history, InitialImpulse):
            loads[action.segment] += float(action.history(np.zeros(1))[0]) * push
    for n, moment in full.pin_moments:
        loads[n] = loads[n] + moment
    lines = model.lines(boom, built)
    for n, shell in enumerate(shells):
        springs += [
            SpringRow("held sideways", {n: row}, k) for row, k in lateral_springs(boom, n, shell)
        ]
        if shell.geometric is not None:
            x, rows = dict(lines[n].deflections)["z"]
            axis_deflection = np.zeros(shell.free.size)
            axis_deflection[shell.node_dofs[:, 2] - shell.owned[0]] = CubicSpline(x, rows @ rest)(
                shell.nodes[:, 0]
            )
            loads[n] += times(shell.geometric, axis_deflection[:, None])[:, 0]
    write_atomically(path, deck(f"{case.title}: {model.name}", shells, springs, loads))

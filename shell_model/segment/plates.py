# SPDX-License-Identifier: LGPL-3.0-or-later
"""From a segment's mesh to the plates of its shell: function space, forms, rigid supports."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

import numpy as np
from mpi4py import MPI

from geometry.plating import PlatedMesh
from geometry.section import COMPONENT
from geometry.segment import Segment
from shell_model import compat
from shell_model.segment.cross_section import on_outline
from shell_model.segment.forms import ShellForms
from shell_model.segment.shell import Hold, Plates, hold


def assemble_plates(comm: MPI.Comm, segment: Segment, mesh: PlatedMesh | None) -> Plates:
    """The plates of a mesh, a segment's whole one or a part of it. Collective."""
    held = list(_held(segment))
    points, triangles, of_cells = np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64), None
    if mesh is not None:
        # The plain walls carry the whole axial force, so that it is the same in each section.
        pressed = segment.compression(mesh.along) / segment.area * mesh.even
        points, triangles, of_cells = mesh.points, mesh.triangles, (mesh.thickness, pressed)
    domain = compat.create_triangle_mesh(comm, points, triangles)
    thickness, compression = (
        compat.cellwise_function(domain, values) for values in comm.bcast(of_cells)
    )
    space = compat.shell_space(domain)
    forms = ShellForms(space, thickness, segment.material, compression=compression)
    return Plates(space, forms, [hold(space, *one) for one in held], bool(segment.compression))


def _held(segment: Segment) -> Iterator[Hold]:
    """What rigid supports hold: the outline along y and z, every part of it where they clamp."""
    for support in segment.supports:
        if support.stiffness is not None:
            continue
        outline = partial(on_outline, section=segment.section_at(support.x), x=support.x)
        for part in (0, 1) if support.clamped else (0,):
            for component in (0, 1, 2) if support.clamped else COMPONENT.values():
                yield part, component, outline

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The stiffness of a beam as a shell has it."""

from __future__ import annotations

import pytest
from mpi4py import MPI

from beam_model.calibration import Stiffness, effective_stiffness
from geometry.boom import Boom
from shell_model.boom_shell import ShellOptions, assemble_segments
from shell_model.contact.local_compliance import far_field
from shell_model.reduction.symmetry import Folding
from tests.shell_model.booms import boom_in_space, flat_boom

pytestmark = pytest.mark.slow


def stiffness(boom: Boom, contact_tolerance: float | None = None) -> list[Stiffness]:
    options = ShellOptions(0.25, contact_tolerance=contact_tolerance)
    shells = assemble_segments(boom, options, MPI.COMM_WORLD)
    return [
        effective_stiffness(segment, far_field(boom, number, Folding(shells[number])))
        for number, segment in enumerate(boom.segments)
    ]


@pytest.mark.parametrize("boom", [flat_boom(), boom_in_space()])
def test_plates_are_nearly_the_beam_of_their_section(boom: Boom) -> None:
    """Reference: analytic, E J of the section and G A_s of its shear flow, and Bredt's G J_t.

    Folds, Poisson's effect and shear lag of short stretches make what is allowed.
    """
    for segment, found in zip(boom.segments, stiffness(boom), strict=True):
        planes = (segment, segment.turned())[: len(found.bending)]
        for plane, bending, shear in zip(planes, found.bending, found.shear, strict=True):
            assert plane.shear_stiffness is not None
            assert bending == pytest.approx(plane.bending_stiffness, rel=5e-3)
            assert shear == pytest.approx(plane.shear_stiffness, rel=0.3)
        if boom.spatial:
            assert segment.lateral is not None
            bredt = segment.material.shear_modulus * segment.lateral.torsion_constant
            assert found.torsion == pytest.approx(bredt, rel=0.01)


def test_a_mesh_that_is_fine_where_something_presses_finds_the_same() -> None:
    """Reference: other code, a uniform mesh; the far field does not know of contacts."""
    for coarse, fine in zip(stiffness(flat_boom()), stiffness(flat_boom(), 0.01), strict=True):
        assert coarse.bending == pytest.approx(fine.bending, rel=2e-3)
        assert coarse.shear == pytest.approx(fine.shear, rel=0.02)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""A station without play and without load is closed in the modes."""

import tomllib

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.boom import Boom
from protractile.runs.case.reading import check_tables
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import reduce_boom
from tests.runs.case_texts import CLAMPED, STEEL, box, elements, joint, table

SQUARES = 0.3, 0.26


def boom_of(stiffness: float) -> Boom:
    """Return a boom of two square boxes without play, which a vertical load at the tip presses."""
    outer, inner = ((size, size, 0.0065 - 0.0005 * i, 0.0065 - 0.0005 * i)
                    for i, size in enumerate(SQUARES))  # fmt: skip
    ends = f"lateral_play = 0.0\nstiffness = {stiffness}"
    text = 'title = "square boxes"\ntime = { duration = 0.05 }\n' + STEEL
    text += box("base", (0.0, 4.0), outer, CLAMPED) + box("fly", (3.0, 7.0), inner)
    text += joint("fly", "base", 0.0, (3.0, 4.0), ends) + elements("beam")
    text += table("[[load]]", segment="fly", x="head", magnitude=-100.0)
    return check_tables(tomllib.loads(text), "boom").boom


def first_pair(system: GapSystem) -> tuple[float, float]:
    """Return the first two frequencies in Hz at rest under the loads."""
    load = system.load + np.sum([one.load for one in system.excitations], axis=0)
    first, second = closed_contact_modes(system, equilibrium(system, load))[0][:2]
    return float(first) / (2.0 * np.pi), float(second) / (2.0 * np.pi)


def test_a_beam_moves_alike_in_both_planes() -> None:
    """Reference: analytic, the symmetry of a square; before, 7.66 Hz laterally for 3.71 Hz."""
    models = finite_element_segments(boom := boom_of(1.0e6), 0.5, "timoshenko", rotary_inertia=True)
    first, second = first_pair(gap_system(boom, models))
    assert first == pytest.approx(second, rel=1e-6)


@pytest.mark.slow
def test_a_shell_moves_alike_in_both_planes() -> None:
    """Reference: analytic, the symmetry of a square; before, the lateral one was 27 % lower."""
    shell = reduce_boom(boom_of(1.0e8), ShellOptions(mesh_size=0.1), MPI.COMM_SELF)
    first, second = first_pair(shell.system)
    assert first == pytest.approx(second, rel=1e-3)

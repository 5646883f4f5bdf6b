# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells of booms, each reduced once, and their comparison with beams."""

from collections.abc import Sequence
from concurrent.futures import Executor
from functools import cache, partial
from typing import Any

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.component import natural_modes
from protractile.beam_model.finite_element import finite_element_segment, finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import ContactLaw
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Direction
from protractile.geometry.contact_places import ContactLine
from protractile.runs.folder.cache import Cache, load_or_compute
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import ReducedShell, reduce_boom
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.reduction.segment import ReducedSegment, SegmentInputs, reduce_segments
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from protractile.shell_model.segment.segment_shell import SegmentShell
from studies.reference_models.statics import static_response
from tests.shell_model.booms import LATERAL_LAW, LAW
from tests.touching import touching


@cache
def reduced(
    boom: Boom,
    size: float,
    line: ContactLine = "near webs",
    *,
    law: ContactLaw = LAW,
    lateral: ContactLaw = LATERAL_LAW,
    moments: int = 1,
    **options: Any,
) -> ReducedShell:
    """Return a boom as shells with edges of a size in m, with the same laws in all joints.

    All workers share them.
    """
    inputs = (
        touching(boom, law, lateral),
        ShellOptions(size, line, krylov=KrylovOptions(moments=moments), **options),
    )
    compute = partial(reduce_boom, *inputs, MPI.COMM_WORLD)
    return load_or_compute(Cache.of_user(), inputs, MPI.COMM_WORLD, compute)


def pressed_rest(system: GapSystem, at: Sequence[bool] | slice = slice(None)) -> Array:
    """Return the equilibrium with springs of 1e12 N/m as contact at some or all rows."""
    rows = system.rows[at]
    return np.asarray(np.linalg.solve(np.diag(system.omega2) + 1.0e12 * rows.T @ rows, system.load))


def assert_rests_as_beams(system: GapSystem, boom: Boom, rel: float) -> None:
    """Check all outputs of an equilibrium against bonded Timoshenko elements."""
    rest, beams = pressed_rest(system), bonded_beams(boom)
    expected = static_response(beams, beams.load)
    assert set(beams.observers) <= set(system.observers)
    for name, observer in beams.observers.items():
        found = system.observers[name].row @ rest
        assert found == pytest.approx(observer.row @ expected, rel=rel), name


def bonded_beams(boom: Boom, length: float = 0.25) -> GapSystem:
    """Return bonded Timoshenko elements of a length in m."""
    return gap_system(boom.bonded, finite_element_segments(boom, length, "timoshenko", True))


def reduce_segment(
    symmetry: SymmetryReduction,
    inputs: Array,
    options: KrylovOptions,
    outputs: Array | None = None,
    helper: Executor | None = None,
) -> ReducedSegment:
    """Reduce one segment, without probes."""
    none = np.zeros((len(inputs), 0))
    data = SegmentInputs(symmetry, inputs, none if outputs is None else outputs, none)
    return reduce_segments([data], options, helper=helper)[0]


def frequencies_off(shell: SegmentShell, direction: Direction = "z", count: int = 1) -> Array:
    """Return relative errors (count,) of elastic frequencies against Timoshenko elements."""
    tip = shell.row(shell.outline(10.0).wall_deflection(direction))
    inputs = np.column_stack([shell.unit_loads[direction], tip])
    found = reduce_segment(SymmetryReduction(shell), inputs, KrylovOptions())
    part = finite_element_segment(shell.segment, 0.25, (), "timoshenko", True).components[direction]
    modes = natural_modes(part.stiffness, part.mass, part.rigid_modes)
    assert np.count_nonzero(found.omega2 == 0.0) == part.rigid_modes
    first = slice(part.rigid_modes, part.rigid_modes + count)
    return np.asarray(np.sqrt(found.omega2[first]) / np.sqrt(modes.omega2[first]) - 1.0)

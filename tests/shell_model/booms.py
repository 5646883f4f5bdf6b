# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms for tests of shells, each reduced once, and their comparison with beams."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import cache, partial
from typing import Any
from unittest.mock import patch

import numpy as np
from mpi4py import MPI

from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.contact import ContactLaw, PowerContact
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Joint, Material, Segment, Support
from protractile.geometry.box import BoxSection, infer_inner_section, infer_outer_section
from protractile.geometry.contact_places import ContactLine
from protractile.geometry.section import Section
from protractile.runs.folder.cache import Cache, load_or_compute
from protractile.shell_model import reduced_shell
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import ReducedShell, reduce_boom
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.reduction.segment import ReducedSegment, SegmentInputs, reduce_segments
from protractile.shell_model.reduction.symmetry import SymmetryReduction
from tests.touching import touching

STEEL = Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
HELD = (Support(0.0), Support(2.0))
LAW = PowerContact(stiffness=1.0e13, exponent=2.0).with_clearance(7.0e-3)
LATERAL_LAW = PowerContact(stiffness=1.0e13, exponent=2.0).with_clearance(5.0e-3)


def box_segment(
    name: str,
    start: float,
    end: float,
    section: Section,
    load: float = 0.0,
    supports: tuple[Support, ...] = (),
) -> Segment:
    """Return a steel segment whose beam data, in both planes, are those of its box."""
    return Segment.of_section(name, start, end, STEEL, section, load=load, supports=supports)


def flat_boom(friction: float = 0.0) -> Boom:
    """Return the paper's flat boom, with normal forces if there is friction."""
    outer = infer_outer_section(83.16 / STEEL.density, 3.7986e-4, 1.5)
    inner = infer_inner_section(55.07 / STEEL.density, 2.1829e-4, outer, LAW.above)
    segments = (
        box_segment("outer", 0.0, 10.0, outer, 83.16, HELD),
        box_segment("inner", 9.0, 19.0, inner, 55.07),
    )
    pressed = (4500.0, 5000.0) if friction > 0.0 else ()
    joint = Joint(0, 1, (9.0, 10.0), 2.0 * LAW.above, friction=friction, normal_forces=pressed)
    return Boom(segments, (joint,))


def boom_in_space(friction: float = 0.0, sideways: float = 0.0) -> Boom:
    """Return the same boom with lateral play.

    Args:
        friction: μ, under the contact forces.
        sideways: ratio of the lateral load to the load along z.
    """
    flat = flat_boom()
    segments = tuple(
        replace(segment, lateral=replace(segment.lateral, load=sideways * segment.load))
        for segment in flat.segments
    )
    joint = replace(flat.joints[0], lateral_play=2.0 * LATERAL_LAW.above, friction=friction)
    return Boom(segments, (joint,))


def three_segments(bonded: bool = False) -> Boom:
    """Return the boom with a third box in the second one, with the overlap of the first joint."""
    two = flat_boom()
    inner = two.segments[1].section
    inmost = BoxSection(inner.height - 0.025, inner.width - 0.025, inner.flange, inner.web)
    middle = replace(two.segments[1], end=16.0)
    third = box_segment("third", 15.0, 21.0, inmost, 40.0)
    first = replace(two.joints[0], bonded=bonded)
    second = replace(first, outer=1, inner=2, stations=(15.0, 16.0))
    return Boom((two.segments[0], middle, third), (first, second))


def reduce_quickly(
    boom: Boom, options: ShellOptions, comm: MPI.Comm = MPI.COMM_SELF, fields: bool = False
) -> ReducedShell:
    """Return the reduced shells of a boom without mesh error, and without fields unless asked for.

    These take two fifths of the time.
    """
    with patch.object(reduced_shell, "_mesh_compliance", lambda *_: np.nan):
        if fields:
            return reduce_boom(boom, options, comm)
        with patch.object(reduced_shell, "gather_fields", lambda *_: None):
            return reduce_boom(boom, options, comm)


@cache
def reduced(
    boom: Boom,
    size: float,
    line: ContactLine = "near webs",
    *,
    law: ContactLaw = LAW,
    lateral: ContactLaw = LATERAL_LAW,
    moments: int = 1,
    whole: bool = False,
    **options: Any,
) -> ReducedShell:
    """Return a boom as shells with edges of a size in m, with the same laws in all joints.

    All workers share them. Only a ``whole`` one has its mesh error and fields.
    """
    inputs = (
        touching(boom, law, lateral),
        ShellOptions(size, line, krylov=KrylovOptions(moments=moments), **options),
    )
    compute = partial(reduce_boom if whole else reduce_quickly, *inputs, MPI.COMM_WORLD)
    return load_or_compute(Cache.of_user(), (*inputs, whole), MPI.COMM_WORLD, compute)


def rigid_state(system: GapSystem, readings: Mapping[str, float]) -> Array:
    """Return the rigid motion (num_modes,) of the free inner segment with these outputs."""
    free = np.flatnonzero(system.omega2 == 0.0)
    rows = np.array([system.observers[name].row[free] for name in readings])
    state = np.zeros(system.num_modes)
    state[free] = np.linalg.lstsq(rows, np.array(list(readings.values())), rcond=None)[0]
    return state


def contact_forces(system: GapSystem, state: Array) -> Array:
    """Return the force of each row in N."""
    gaps = system.rows @ state
    return np.array([float(law.force(y)) for law, y in zip(system.laws, gaps, strict=True)])


def pressed_rest(system: GapSystem, at: Sequence[bool] | slice = slice(None)) -> Array:
    """Return the equilibrium with springs of 1e12 N/m as contact at some or all rows."""
    rows = system.rows[at]
    return np.asarray(np.linalg.solve(np.diag(system.omega2) + 1.0e12 * rows.T @ rows, system.load))


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

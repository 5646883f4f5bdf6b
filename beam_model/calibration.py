# SPDX-License-Identifier: LGPL-3.0-or-later
"""Calibration of beams by the shell of the same boom: effective stiffness, local compliance.

With the effective E J and G A_s of a segment, the shear-flexible beam responds to static probes far
from their places as the shell does; likewise G J_t. They include shear lag, Poisson's effect and
folds. The additional local compliance of loaded places is the residual compliance.

With B the rows of contacts, friction and dashpots and C = B Ω⁻² Bᵀ over the
elastic modes, the residual compliance of a coarse model beside a fine one is D = C_fine − C_coarse
(MacNeal 1971). Both have the same rigid motions, so forces that no support carries are carried by
inertia alike, and D is the local compliance alone. Its positive part D = Σ g gᵀ is a set
of massless springs. Each is a coordinate with the rows ω_s g and a frequency ω_s well above the
motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import least_squares

from beam_model.component import Component, SegmentModel, natural_modes
from beam_model.finite_element import finite_element_segment
from beam_model.segment_model import EACH_SIDE, gap_system
from dynamics.gap_system import GapSystem
from dynamics.reduction import with_coordinates
from geometry.arrays import Array
from geometry.boom import Boom, Segment
from geometry.probe_responses import PROBE_FREQUENCY, ProbedMotion, ProbeResponses

# Weight of the logarithm of a factor beside relative errors of responses. It determines a
# stiffness without influence, and changes no other.
_PRIOR = 1.0e-4
# ω_s/2π in Hz: the vibration of a boom is slower by a factor of ten and more.
SPRING_FREQUENCY = 400.0
# A pattern of forces is rigid if its compliance is below this fraction of that of others.
_NOTHING = 1.0e-3
# Minimum elements of a segment; shear-flexible ones are exact at their nodes in statics.
_ELEMENTS = 20


@dataclass(frozen=True, slots=True)
class Stiffness:
    """Effective stiffness of a segment as a beam.

    Args:
        bending: E J in N·m² along z, and in space along y.
        shear: G A_s in N, alike.
        torsion: G J_t in N·m² in space.
    """

    bending: tuple[float, ...]
    shear: tuple[float, ...]
    torsion: float | None = None


@dataclass(frozen=True, slots=True)
class Calibration:
    """Calibration of a beam by the shell of its boom.

    Args:
        segments: their stiffness.
        residual: (num_rows, num_rows) in m/N what contact rows, friction rows and
            dashpots deflect beyond the beam.
    """

    segments: Sequence[Stiffness]
    residual: Array

    def spring(self, row: int) -> float | None:
        """Return the stiffness in N/m in series with a contact row; None of a rigid one."""
        compliance = float(self.residual[row, row])
        return 1.0 / compliance if compliance > 0.0 else None


def calibrate(
    boom: Boom,
    shell: GapSystem,
    probe_responses: Sequence[ProbeResponses],
    segments: Callable[[Boom], Sequence[SegmentModel]],
) -> tuple[GapSystem, Calibration]:
    """Return a beam with the contact places and local compliance of a shell, and its calibration.

    Args:
        boom: all its segments with sections.
        shell: shell of the boom, pressed near its webs or by pads.
        probe_responses: probe responses of the shell's segments.
        segments: makes beams of a boom.
    """
    found = [
        effective_stiffness(segment, far)
        for segment, far in zip(boom.segments, probe_responses, strict=True)
    ]
    stiff = stiffened(boom, found)
    beam = gap_system(stiff, segments(stiff), EACH_SIDE)
    residual = residual_compliance(beam, shell)
    return with_springs(beam, residual), Calibration(found, residual)


def elastic_compliance(system: GapSystem) -> Array:
    """Return B Ω⁻² Bᵀ (num_rows, num_rows) in m/N of contacts, friction, dashpots."""
    elastic = system.omega2 > 0.0
    rows = system.all_rows[:, elastic]
    return np.asarray(rows / system.omega2[elastic] @ rows.T)


def residual_compliance(coarse: GapSystem, fine: GapSystem) -> Array:
    """Return D (num_rows, num_rows) in m/N, which may be indefinite.

    Raises:
        ValueError: the numbers of rows differ.
    """
    if len(coarse.all_rows) != len(fine.all_rows):
        raise ValueError("both models must have the same contact rows, friction rows and dashpots")
    return elastic_compliance(fine) - elastic_compliance(coarse)


def with_springs(system: GapSystem, residual: Array) -> GapSystem:
    """Return the system with springs: the positive part of a residual compliance.

    The residual is (num_rows, num_rows) in m/N.
    """
    sizes = np.sqrt(np.abs(np.diag(residual)))
    sizes[sizes == 0.0] = 1.0
    # Normalised, since friction rows, pads and dashpots differ by orders of magnitude.
    amounts, patterns = np.linalg.eigh(residual / np.outer(sizes, sizes))
    kept = amounts > _NOTHING * max(amounts.max(initial=0.0), 0.0)
    spring = 2.0 * np.pi * SPRING_FREQUENCY
    rows = spring * sizes[:, None] * patterns[:, kept] * np.sqrt(amounts[kept])
    return with_coordinates(system, np.full(rows.shape[1], spring**2), rows)


def stiffened(boom: Boom, stiffness: Sequence[Stiffness]) -> Boom:
    """Return the boom with another stiffness of each segment."""
    return replace(boom, segments=tuple(map(with_stiffness, boom.segments, stiffness)))


def effective_stiffness(segment: Segment, far: ProbeResponses) -> Stiffness:
    """Return the stiffness with which a beam responds to the probes as the shell of the segment.

    For a tapered segment it is the beam's own, half-way.
    """
    in_plane = _bending(segment, far, "z")
    if "y" not in far.compliance:
        return Stiffness((in_plane[0],), (in_plane[1],))
    sideways = _bending(segment.turned(), far, "y")
    lateral = segment.lateral
    assert lateral is not None
    torsion = segment.material.shear_modulus * lateral.torsion_constant
    factor = 1.0 if segment.head_section is not None else _fit(segment, far, "twist", 1)[0]
    return Stiffness(
        (in_plane[0], sideways[0]), (in_plane[1], sideways[1]), float(factor * torsion)
    )


def with_stiffness(segment: Segment, stiffness: Stiffness) -> Segment:
    """Return the segment with another stiffness, and with the rotary inertia of its plates.

    A tapered segment stays unchanged.
    """
    if segment.head_section is not None:
        return segment
    material, section = segment.material, segment.section
    assert section is not None
    e, g = material.youngs_modulus, material.shear_modulus
    # Properties that are unknown in the other plane remain those of the section.
    shear = (*stiffness.shear, g * section.turned().shear_area)[:2]
    changed = replace(
        segment,
        second_moment_of_area=stiffness.bending[0] / e,
        rotary_inertia=material.density * section.second_moment_of_area,
        shear_stiffnesses=(shear[0], shear[1]),
    )
    if stiffness.torsion is None or segment.lateral is None:
        return changed
    lateral = replace(
        segment.lateral,
        second_moment_of_area=stiffness.bending[1] / e,
        rotary_inertia=material.density * section.lateral_second_moment_of_area,
        torsion_constant=stiffness.torsion / g,
        polar_inertia=material.density * section.polar_second_moment_of_area,
    )
    return replace(changed, lateral=lateral)


def _bending(segment: Segment, far: ProbeResponses, motion: ProbedMotion) -> tuple[float, float]:
    """Return E J and G A_s of a segment, turned to bend along y."""
    assert segment.shear_stiffness is not None
    if segment.head_section is not None:
        return segment.bending_stiffness, segment.local(
            0.5 * sum(segment.ends)
        ).shear_stiffness or 0.0
    bending, shear = _fit(segment, far, motion, 2)
    return float(bending * segment.bending_stiffness), float(shear * segment.shear_stiffness)


def _fit(segment: Segment, far: ProbeResponses, motion: ProbedMotion, count: int) -> Array:
    """Return (count,) factors of the stiffnesses, by least squares of the relative errors."""
    first, turns = _component(segment, far, motion, np.ones(count))
    probes = _probes(first, far, motion)
    moved = probes.any(axis=1)
    modes = natural_modes(first.stiffness, first.mass, turns)
    # Combinations of probes that leave a free segment at rest.
    rigid = probes[moved] @ modes.shapes[:, :turns]
    balanced = np.eye(len(probes))[:, moved] @ (
        null_space(rigid.T) if turns else np.eye(moved.sum())
    )
    shell = balanced.T @ far.compliance[motion] @ balanced
    sizes = np.sqrt(np.outer(np.diag(shell), np.diag(shell)))
    pairs = np.triu_indices(len(shell))

    def errors(logarithms: Array) -> Array:
        component, _ = _component(segment, far, motion, np.exp(logarithms))
        sigma = (2.0 * np.pi * PROBE_FREQUENCY) ** 2
        pushes = _probes(component, far, motion).T @ balanced
        beam = pushes.T @ np.linalg.solve(component.stiffness + sigma * component.mass, pushes)
        return np.concatenate([((beam - shell) / sizes)[pairs], _PRIOR * logarithms])

    return np.asarray(np.exp(least_squares(errors, np.zeros(count), x_scale=0.01).x))


def _component(
    segment: Segment, far: ProbeResponses, motion: ProbedMotion, factors: Array
) -> tuple[Component, int]:
    """Return a motion of the segment with factors of its stiffness, and its rigid motions."""
    if motion == "twist":
        assert segment.lateral is not None
        torsion = factors[0] * segment.lateral.torsion_constant
        changed = replace(segment, lateral=replace(segment.lateral, torsion_constant=torsion))
    else:
        stiffness = segment.shear_stiffness
        assert stiffness is not None
        assert segment.section is not None
        changed = replace(
            segment,
            second_moment_of_area=factors[0] * segment.second_moment_of_area,
            rotary_inertia=segment.material.density * segment.section.second_moment_of_area,
            shear_stiffnesses=(factors[1] * stiffness, stiffness),
        )
    length = segment.length / _ELEMENTS
    model = finite_element_segment(changed, length, far.places, "timoshenko", True)
    component = model.components["twist" if motion == "twist" else "z"]
    return component, component.rigid_modes


def _probes(component: Component, far: ProbeResponses, motion: ProbedMotion) -> Array:
    """Return the load vectors (num_probes, num_dofs) of the probes."""
    rows = [component.at(x) for x in far.places]
    if motion != "twist":
        rows += [component.rotation_at(x) for x in (far.places[0], far.places[-1])]
    return np.array(rows)

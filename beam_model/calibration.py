# SPDX-License-Identifier: LGPL-3.0-or-later
"""Calibration of beams by the shell of the same boom: stiffness and local compliance.

The effective stiffnesses E J, G A_s and G J_t of a segment give a Timoshenko beam the static
response of the shell. They include shear lag, Poisson's effect and folds.

Γ = B Ω⁻² Bᵀ is the compliance of the elastic modes of circular frequencies Ω at the rows B of
contacts, friction and dashpots. Shell and beam have the same rigid motions and inertia forces, so
that the residual compliance Γ_shell − Γ_beam (MacNeal 1971) is the local compliance of the walls.
Its positive part Σ b bᵀ becomes springs. A spring is a coordinate with the rows ω_s b, whose
circular frequency ω_s is far above those of the motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space

from protractile.beam_model.component import Component, SegmentModel, natural_modes
from protractile.beam_model.finite_element import finite_element_segment
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.reduction import with_coordinates
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Segment
from protractile.geometry.probe_responses import PROBE_FREQUENCY, ProbedMotion, ProbeResponses
from protractile.geometry.section import EACH_SIDE

# Weight in the least squares that keeps a factor near 1 if it has no influence on the responses.
_PRIOR = 1.0e-4
# ω_s/2π in Hz, at least ten times the frequencies of a boom's vibration.
SPRING_FREQUENCY = 400.0
# Fraction of the largest compliance below which the compliance of a force pattern is neglected.
_NEGLIGIBLE = 1.0e-3
# Minimum number of elements of a segment; their static solution is exact at the nodes.
_ELEMENTS = 20


@dataclass(frozen=True, slots=True)
class Stiffness:
    """Effective stiffness of a segment as a beam."""

    bending: tuple[float, ...]  #: E J in N·m² for z, in three-dimensional booms also for y
    shear: tuple[float, ...]  #: G A_s in N for z, in three-dimensional booms also for y
    torsion: float | None = None  #: G J_t in N·m² of three-dimensional booms


@dataclass(frozen=True, slots=True)
class Calibration:
    """Calibration of a beam by the shell of its boom."""

    segments: Sequence[Stiffness]  #: stiffness of each segment
    #: residual compliance (num_rows, num_rows) in m/N of the rows of contacts, friction and
    #: dashpots
    residual: Array

    def beam(self, stiff: Boom, segments: Sequence[SegmentModel]) -> GapSystem:
        """Return the gap system of a calibrated beam.

        Args:
            stiff: boom from :func:`with_stiffnesses`, with the sections, joints and pads of the
                shell; masses and loads may differ.
            segments: beams of this boom.
        """
        return with_springs(gap_system(stiff, segments, EACH_SIDE), self.residual)

    def spring(self, row: int) -> float | None:
        """Return the wall stiffness in N/m at a contact row; None without local compliance."""
        compliance = float(self.residual[row, row])
        return 1.0 / compliance if compliance > 0.0 else None


def calibrate(
    boom: Boom,
    shell: GapSystem,
    probe_responses: Sequence[ProbeResponses],
    segments: Callable[[Boom], Sequence[SegmentModel]],
) -> Calibration:
    """Return the effective stiffness and the local compliance of a shell for beams of its boom.

    Args:
        shell: gap system of the shell of the boom, with contacts near the webs or at pads.
        probe_responses: probe responses of the segments of the shell.
        segments: function that returns the beams of a boom.
    """
    stiffnesses = [
        effective_stiffness(segment, probed)
        for segment, probed in zip(boom.segments, probe_responses, strict=True)
    ]
    stiff = with_stiffnesses(boom, stiffnesses)
    beam = gap_system(stiff, segments(stiff), EACH_SIDE)
    return Calibration(stiffnesses, residual_compliance(beam, shell))


def elastic_compliance(system: GapSystem) -> Array:
    """Return the compliance Γ (num_rows, num_rows) in m/N of all rows over the elastic modes."""
    elastic = system.omega2 > 0.0
    rows = system.all_rows[:, elastic]
    return np.asarray(rows / system.omega2[elastic] @ rows.T)


def residual_compliance(coarse: GapSystem, fine: GapSystem) -> Array:
    """Return the compliance (num_rows, num_rows) in m/N of the fine less that of the coarse model.

    It may be indefinite.

    Raises:
        ValueError: the numbers of rows differ.
    """
    if len(coarse.all_rows) != len(fine.all_rows):
        raise ValueError("both models must have the same contact rows, friction rows and dashpots")
    return elastic_compliance(fine) - elastic_compliance(coarse)


def with_springs(system: GapSystem, residual: Array) -> GapSystem:
    """Return the system with springs for the positive part of a residual compliance.

    Args:
        residual: residual compliance (num_rows, num_rows) in m/N.
    """
    sizes = np.sqrt(np.abs(np.diag(residual)))
    sizes[sizes == 0.0] = 1.0
    # Rows are scaled, since contacts, friction and dashpots differ by orders of magnitude.
    amounts, patterns = np.linalg.eigh(residual / np.outer(sizes, sizes))
    kept = amounts > _NEGLIGIBLE * max(amounts.max(initial=0.0), 0.0)
    spring = 2.0 * np.pi * SPRING_FREQUENCY
    rows = spring * sizes[:, None] * patterns[:, kept] * np.sqrt(amounts[kept])
    return with_coordinates(system, np.full(rows.shape[1], spring**2), rows)


def with_stiffnesses(boom: Boom, stiffness: Sequence[Stiffness]) -> Boom:
    """Return the boom with a given stiffness of each segment."""
    return replace(boom, segments=tuple(map(with_stiffness, boom.segments, stiffness)))


def effective_stiffness(segment: Segment, probed: ProbeResponses) -> Stiffness:
    """Return the stiffness of a beam that reproduces the probe responses of a shell segment.

    A tapered segment is not calibrated; it has the stiffness of the beam at the middle.
    """
    in_plane = _bending(segment, probed, "z")
    if "y" not in probed.compliance:
        return Stiffness((in_plane[0],), (in_plane[1],))
    sideways = _bending(segment.turned(), probed, "y")
    lateral = segment.lateral
    assert lateral is not None
    torsion = segment.material.shear_modulus * lateral.torsion_constant
    factor = 1.0 if segment.head_section is not None else _fit(segment, probed, "twist", 1)[0]
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
    # Without properties for the other plane, the properties of the section remain.
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


def _bending(segment: Segment, probed: ProbeResponses, motion: ProbedMotion) -> tuple[float, float]:
    """Return E J in N·m² and G A_s in N of a segment in one plane of bending."""
    assert segment.shear_stiffness is not None
    if segment.head_section is not None:
        middle = segment.prismatic_at(0.5 * sum(segment.ends))
        return segment.bending_stiffness, middle.shear_stiffness or 0.0
    bending, shear = _fit(segment, probed, motion, 2)
    return float(bending * segment.bending_stiffness), float(shear * segment.shear_stiffness)


def _fit(segment: Segment, probed: ProbeResponses, motion: ProbedMotion, count: int) -> Array:
    """Return the ratios (count,) of shell stiffness to beam stiffness, by least squares."""
    first = _component(segment, probed, motion, np.ones(count))
    turns = first.rigid_modes
    probes = _probes(first, probed, motion)
    excited = probes.any(axis=1)
    modes = natural_modes(first.stiffness, first.mass, turns)
    # Self-equilibrated combinations of probes.
    rigid = probes[excited] @ modes.shapes[:, :turns]
    balanced = np.eye(len(probes))[:, excited] @ (
        null_space(rigid.T) if turns else np.eye(excited.sum())
    )
    shell = balanced.T @ probed.compliance[motion] @ balanced
    sizes = np.sqrt(np.outer(np.diag(shell), np.diag(shell)))
    pairs = np.triu_indices(len(shell))

    # Imported late: it loads in 0.2 s, and few beams are calibrated.
    from scipy.optimize import least_squares

    def errors(logarithms: Array) -> Array:
        component = _component(segment, probed, motion, np.exp(logarithms))
        sigma = (2.0 * np.pi * PROBE_FREQUENCY) ** 2
        pushes = _probes(component, probed, motion).T @ balanced
        beam = pushes.T @ np.linalg.solve(component.stiffness + sigma * component.mass, pushes)
        return np.concatenate([((beam - shell) / sizes)[pairs], _PRIOR * logarithms])

    return np.asarray(np.exp(least_squares(errors, np.zeros(count), x_scale=0.01).x))


def _component(
    segment: Segment, probed: ProbeResponses, motion: ProbedMotion, factors: Array
) -> Component:
    """Return the component of a motion with scaled stiffnesses."""
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
    model = finite_element_segment(changed, length, probed.places, "timoshenko", True)
    return model.components["twist" if motion == "twist" else "z"]


def _probes(component: Component, probed: ProbeResponses, motion: ProbedMotion) -> Array:
    """Return the load vectors (num_probes, num_dofs) of the probes."""
    rows = [component.at(x) for x in probed.places]
    if motion != "twist":
        rows += [component.at(x, 1) for x in (probed.places[0], probed.places[-1])]
    return np.array(rows)

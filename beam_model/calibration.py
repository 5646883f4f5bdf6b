# SPDX-License-Identifier: LGPL-3.0-or-later
"""A beam as the shell of the same boom has it: its stiffness as it acts, springs where it touches.

E J and G A_s of a segment are those with which the shear-flexible beam answers static probes far
from their places as the shell does, G J_t likewise; shear lag, Poisson's effect and folds are in
them. What pressed places still give way by more is the residual compliance
(:mod:`dynamics.reduction`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import null_space
from scipy.optimize import least_squares

from beam_model.component import Component, SegmentModel, natural_modes
from beam_model.finite_element import finite_element_segment
from beam_model.segment_model import AT_PADS, gap_system
from dynamics.gap_system import GapSystem
from dynamics.reduction import residual_compliance, with_springs
from geometry.arrays import Array
from geometry.boom import Boom, Segment
from geometry.far_field import FAR_SHIFT, Bent, FarField

# What the logarithm of a factor weighs beside relative errors of the far field: it settles a
# stiffness that nothing depends on, and moves no other.
_PRIOR = 1.0e-4
# Elements of a segment, at least; shear-flexible ones are exact at their nodes in statics.
_ELEMENTS = 20


@dataclass(frozen=True, slots=True)
class Stiffness:
    """A segment's as a beam.

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
    """What a beam has read from the shell of its boom.

    Args:
        segments: their stiffness.
        residual: (num_resisting, num_resisting) in m/N what contact rows, friction rows and
            dashpots give way beyond the beam, see :mod:`dynamics.reduction`.
    """

    segments: Sequence[Stiffness]
    residual: Array

    def spring(self, row: int) -> float | None:
        """N/m of a contact row, in series with the contact; None of one that does not give way."""
        compliance = float(self.residual[row, row])
        return 1.0 / compliance if compliance > 0.0 else None


def calibrate(
    boom: Boom,
    shell: GapSystem,
    far_fields: Sequence[FarField],
    segments: Callable[[Boom], Sequence[SegmentModel]],
) -> tuple[GapSystem, Calibration]:
    """A beam that presses where a shell does and gives way as it does.

    Args:
        boom: all its segments with sections.
        shell: of the boom, pressed near its webs or by pads.
        far_fields: of the shell's segments.
        segments: makes beams of a boom.
    """
    found = [
        effective_stiffness(segment, far)
        for segment, far in zip(boom.segments, far_fields, strict=True)
    ]
    stiff = stiffened(boom, found)
    beam = gap_system(stiff, segments(stiff), AT_PADS)
    residual = residual_compliance(beam, shell)
    return with_springs(beam, residual), Calibration(found, residual)


def stiffened(boom: Boom, stiffness: Sequence[Stiffness]) -> Boom:
    """The boom with another stiffness of each segment."""
    return replace(boom, segments=tuple(map(with_stiffness, boom.segments, stiffness)))


def effective_stiffness(segment: Segment, far: FarField) -> Stiffness:
    """What makes a beam answer the probes as the shell of a segment has answered them.

    Of a segment that tapers it is the beam's own, half-way.
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
    """The segment with another stiffness, and with the rotary inertia of its plates.

    One that tapers stays as it is.
    """
    if segment.head_section is not None:
        return segment
    material, section = segment.material, segment.section
    assert section is not None
    e, g = material.youngs_modulus, material.shear_modulus
    # What the segment does not know of its other plane stays the section's.
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


def _bending(segment: Segment, far: FarField, motion: Bent) -> tuple[float, float]:
    """E J and G A_s of a segment that is turned where it is to bend along y."""
    assert segment.shear_stiffness is not None
    if segment.head_section is not None:
        return segment.bending_stiffness, segment.local(
            0.5 * sum(segment.ends)
        ).shear_stiffness or 0.0
    bending, shear = _fit(segment, far, motion, 2)
    return float(bending * segment.bending_stiffness), float(shear * segment.shear_stiffness)


def _fit(segment: Segment, far: FarField, motion: Bent, count: int) -> Array:
    """(count,) factors of the stiffnesses, by least squares of the relative errors."""
    first, turns = _component(segment, far, motion, np.ones(count))
    probes = _probes(first, far, motion)
    moved = probes.any(axis=1)
    modes = natural_modes(first.stiffness, first.mass, turns)
    # Combinations that leave a free segment at rest.
    rigid = probes[moved] @ modes.shapes[:, :turns]
    balanced = np.eye(len(probes))[:, moved] @ (
        null_space(rigid.T) if turns else np.eye(moved.sum())
    )
    shell = balanced.T @ far.compliance[motion] @ balanced
    sizes = np.sqrt(np.outer(np.diag(shell), np.diag(shell)))
    pairs = np.triu_indices(len(shell))

    def errors(logarithms: Array) -> Array:
        component, _ = _component(segment, far, motion, np.exp(logarithms))
        sigma = (2.0 * np.pi * FAR_SHIFT) ** 2
        pushes = _probes(component, far, motion).T @ balanced
        beam = pushes.T @ np.linalg.solve(component.stiffness + sigma * component.mass, pushes)
        return np.concatenate([((beam - shell) / sizes)[pairs], _PRIOR * logarithms])

    return np.asarray(np.exp(least_squares(errors, np.zeros(count), x_scale=0.01).x))


def _component(
    segment: Segment, far: FarField, motion: Bent, factors: Array
) -> tuple[Component, int]:
    """A motion of the segment with so many times its stiffness, and its rigid motions."""
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


def _probes(component: Component, far: FarField, motion: Bent) -> Array:
    """(num_probes, num_dofs)."""
    rows = [component.at(x) for x in far.places]
    if motion != "twist":
        rows += [component.rotation_at(x) for x in (far.places[0], far.places[-1])]
    return np.array(rows)

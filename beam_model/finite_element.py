# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beams of two-node elements, see :mod:`.beam_model.elements`, in each plane of bending.

With linear elements for twist, they are 3D frame elements without axial strain (Przemieniecki
1968).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from operator import attrgetter

import numpy as np

from protractile.beam_model.component import Component, Motion, SegmentModel, products
from protractile.beam_model.elements import GAUSS, Theory, element, quadrature
from protractile.geometry.arrays import Array
from protractile.geometry.boom import SAME_PLACE, Boom, BoomError, Segment
from protractile.geometry.contact_places import load_places
from protractile.geometry.segment_checks import APART

# Distance from another node, as a fraction of a segment's length, within which a mass or a jump of
# the axial force has no node of its own: eigenvalues lose digits with the inverse fourth power of
# the shortest element length. Such a mass acts through shape functions.
_MASS_APART = 5.0e-3

_NUM_GAUSS = GAUSS[0].size

# Shape functions of an element by their order in rows of a component.
_SHAPES = "deflection", "rotation", "curvature"

_MASS, _ROTARY = map(attrgetter, ("mass_per_length", "rotary_inertia"))
_TORSION, _POLAR = map(attrgetter, ("lateral.torsion_constant", "lateral.polar_inertia"))


def finite_element_segments(
    boom: Boom, element_length: float, theory: Theory, rotary_inertia: bool
) -> list[SegmentModel]:
    """Return the models of all segments of a boom, with nodes at all forces and requested outputs.

    Arguments as in :func:`finite_element_segment`.

    Raises:
        BoomError: the boom lacks data that the theory needs.
    """
    # Between its nodes, an element lacks the deflection by the load on it.
    places = [
        (*load_places(boom, number), *boom.observed_places(number))
        for number in range(len(boom.segments))
    ]
    return [
        finite_element_segment(segment, element_length, breaks, theory, rotary_inertia)
        for segment, breaks in zip(boom.segments, places, strict=True)
    ]


def finite_element_segment(
    segment: Segment,
    element_length: float,
    breaks: Sequence[float],
    theory: Theory,
    rotary_inertia: bool,
) -> SegmentModel:
    """Return the model of one segment.

    Args:
        segment: segment. Nodes are at its supports, and at masses and jumps of the axial force
            that are not close to another node. With lateral properties the model includes
            deflection along y and twist.
        element_length: maximum element length in m.
        breaks: further x in m of nodes.
        theory: beam theory; ``timoshenko`` needs the section for its shear area.
        rotary_inertia: whether the mass matrix includes I_p of (3).

    Raises:
        BoomError: a Timoshenko beam has no section.
    """
    if theory == "timoshenko" and segment.section is None:
        raise BoomError(
            "segment",
            f"{segment.name!r} has no box section, which a Timoshenko beam needs for its shear "
            "area; give height_to_width or section",
        )
    nodes = _nodes(segment, element_length, breaks)
    components: dict[Motion, Component] = {"z": _bending(segment, nodes, theory, rotary_inertia)}
    if segment.lateral is not None:
        components["y"] = _bending(segment.turned(), nodes, theory, rotary_inertia)
        components["twist"] = _twist(segment, nodes)
    return SegmentModel(components)


def _bending(segment: Segment, nodes: Array, theory: Theory, rotary_inertia: bool) -> Component:
    """Return the component of deflection along z, with the unknowns w and β at each node."""
    num_dofs = 2 * nodes.size
    stiffness, mass, damping = (np.zeros((num_dofs, num_dofs)) for _ in range(3))
    unit_load, rotation_load, inertia_load = np.zeros((3, num_dofs))
    lengths = np.diff(nodes).tolist()
    elements = [element(segment, theory, *span) for span in zip(nodes, lengths, strict=False)]
    slopes, points = np.zeros((len(elements), _NUM_GAUSS, num_dofs)), list[Array]()
    for k, (here, h) in enumerate(zip(elements, lengths, strict=True)):
        dofs = slice(2 * k, 2 * k + 4)
        weight, w, slope, beta, stiff = quadrature(here)
        x = nodes[k] + h * GAUSS[0]
        masses, inertias = (weight * segment.property_ratio(of, x) for of in (_MASS, _ROTARY))
        stiffness[dofs, dofs] += stiff
        mass[dofs, dofs] += segment.mass_per_length * products(w, masses)
        rotation_load[dofs] += segment.mass_per_length * w @ (masses * x)
        if rotary_inertia:
            mass[dofs, dofs] += segment.rotary_inertia * products(beta, inertias)
            rotation_load[dofs] += segment.rotary_inertia * beta @ inertias
        damping[dofs, dofs] += segment.viscous_damping * products(w, weight)
        slopes[k, :, dofs] = slope.T
        points.append(np.array([x, weight]))
        unit_load[dofs] += w @ weight
        inertia_load[dofs] += w @ masses

    fixed = []
    for support in segment.supports:
        dof = 2 * _nearest(nodes, support.x)
        if support.stiffness is not None:
            stiffness[dof, dof] += support.stiffness
        else:
            fixed.append(dof)
        if support.kind == "clamped":
            fixed.append(dof + 1)
        else:
            stiffness[dof + 1, dof + 1] += support.rotation_stiffness or 0.0
    stiffeners = len(segment.stiffener_masses)
    for number, point in enumerate((*segment.stiffener_masses, *segment.masses)):
        k, h = _element(nodes, point.x)
        dofs = slice(2 * k, 2 * k + 4)
        w = elements[k].deflection(np.array([(point.x - nodes[k]) / h]))
        mass[dofs, dofs] += products(w, np.array([point.mass]))
        if number < stiffeners:
            rotation_load[dofs] += point.mass * point.x * w[:, 0]
            inertia_load[dofs] += point.mass / segment.mass_per_length * w[:, 0]
    free = np.setdiff1d(np.arange(num_dofs), fixed)
    gauss, slope_rows = np.hstack(points), slopes.reshape(-1, num_dofs)[:, free]

    def read(x: float, order: int = 0) -> Array:
        k, h = _element(nodes, x)
        row = np.zeros(num_dofs)
        row[2 * k : 2 * k + 4] = getattr(elements[k], _SHAPES[order])(np.array((x - nodes[k]) / h))
        return np.asarray(row[free])

    block = np.ix_(free, free)
    return Component(
        stiffness=stiffness[block],
        mass=mass[block],
        damping=damping[block],
        load=segment.load * unit_load[free],
        unit_load=unit_load[free],
        at=read,
        rigid_modes=segment.rigid_modes,
        geometric_stiffness=products(slope_rows.T, gauss[1] * segment.compression(gauss[0])),
        rotation_load=rotation_load[free],
        inertia_load=inertia_load[free],
        breaks=nodes,
        slopes=slope_rows,
        points=gauss,
    )


def _twist(segment: Segment, nodes: Array) -> Component:
    """Return the component of twist, with linear elements."""
    lateral = segment.lateral
    assert lateral is not None
    stiffness, mass = (np.zeros((nodes.size, nodes.size)) for _ in range(2))
    twisting_stiffness = segment.material.shear_modulus * lateral.torsion_constant
    for k, h in enumerate(np.diff(nodes)):
        dofs = slice(k, k + 2)
        places = nodes[k] + h * np.array([0.0, 0.5, 1.0])
        # Simpson's rule gives the mean flexibility.
        ratio = 6.0 / (np.array([1.0, 4.0, 1.0]) @ (1.0 / segment.property_ratio(_TORSION, places)))
        inertia_ratio = segment.property_ratio(_POLAR, places)[1]
        unit_stiffness, unit_mass = [[1.0, -1.0], [-1.0, 1.0]], [[2.0, 1.0], [1.0, 2.0]]
        stiffness[dofs, dofs] += ratio * (twisting_stiffness / h) * np.array(unit_stiffness)
        mass[dofs, dofs] += inertia_ratio * (lateral.polar_inertia * h / 6.0) * np.array(unit_mass)
    fixed = [_nearest(nodes, support.x) for support in segment.supports]
    free = np.setdiff1d(np.arange(nodes.size), fixed)

    def twist(x: float, order: int = 0) -> Array:
        k, h = _element(nodes, x)
        row = np.zeros(nodes.size)
        row[k : k + 2] = (nodes[k + 1] - x) / h, (x - nodes[k]) / h
        return np.asarray(row[free])

    block, nothing = np.ix_(free, free), np.zeros((free.size, free.size))
    return Component(
        stiffness=stiffness[block],
        mass=mass[block],
        damping=nothing,
        load=np.zeros(free.size),
        at=twist,
        rigid_modes=segment.rigid_twists,
        geometric_stiffness=nothing,
    )


def _nodes(segment: Segment, element_length: float, breaks: Sequence[float]) -> Array:
    """Return x (num_nodes,) of nodes in m: required x, close ones merged, and x between these."""
    supports = [support.x for support in segment.supports]
    masses = [*(mass.x for mass in segment.all_masses), *segment.compression.places]
    places: list[float] = []
    for required, apart in (
        ((segment.start, segment.end, *supports, *breaks), APART),
        (masses, _MASS_APART),
    ):
        for x in required:
            if segment.holds(x) and all(
                abs(x - place) > apart * segment.length for place in places
            ):
                places.append(x)
    spans = [
        np.linspace(a, b, max(1, int(np.ceil((b - a) / element_length - SAME_PLACE))) + 1)[:-1]
        for a, b in pairwise(sorted(places))
    ]
    return np.concatenate([*spans, [segment.end]])


def _nearest(nodes: Array, x: float) -> int:
    return int(np.argmin(np.abs(nodes - x)))


def _element(nodes: Array, x: float) -> tuple[int, float]:
    """Return the index of the element that contains x in m, and the length of the element in m."""
    k = min(max(int(nodes.searchsorted(x, side="right")) - 1, 0), nodes.size - 2)
    return k, float(nodes[k + 1] - nodes[k])

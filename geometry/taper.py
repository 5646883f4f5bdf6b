# SPDX-License-Identifier: LGPL-3.0-or-later
"""Sections of tapered segments, linear between the two ends."""

from __future__ import annotations

from dataclasses import fields
from typing import Any

from protractile.geometry.section import Section, SectionError


def interpolate_section(tail: Section, head: Section, part: float) -> Section:
    """Return the section at a fraction of the length between the sections at tail and head.

    >>> from protractile.geometry.taper import interpolate_section
    >>> deep = pt.BoxSection(height=0.4, width=0.3, flange=0.01, web=0.006)
    >>> round(interpolate_section(deep, replace(deep, height=0.2), 0.25).height, 6)
    0.35

    Args:
        tail, head: sections of the same kind, see :func:`check_alike`.
        part: fraction from 0 at the tail to 1 at the head.
    """
    shape: Any = tail
    mixed = {
        field.name: _interpolate(getattr(tail, field.name), getattr(head, field.name), part)
        for field in fields(shape)
    }
    between: Section = type(shape)(**mixed)
    return between


def _interpolate(tail: Any, head: Any, part: float) -> Any:
    if tail is None:
        return None
    if isinstance(tail, tuple):
        return tuple(
            _interpolate(start, other, part) for start, other in zip(tail, head, strict=True)
        )
    return head if part == 1.0 else tail + part * (head - tail)


def check_alike(tail: Section, head: Section) -> None:
    """Check that a segment can taper from one section to another.

    Raises:
        SectionError: the sections differ in shape, plates, faces or mirrors.
    """
    for what, at_tail, at_head in (
        ("shapes", type(tail), type(head)),
        ("plates", [plate.name for plate in tail.plates], [plate.name for plate in head.plates]),
        ("faces", *([face[:3] for face in section.faces] for section in (tail, head))),
        ("mirrors", tail.mirrors, head.mirrors),
    ):
        if at_tail != at_head:
            raise SectionError(
                f"has other {what} than the one at the tail; a segment tapers between sections of "
                "one kind"
            )
    for quarter in (1, 2, 3):
        interpolate_section(tail, head, 0.25 * quarter)


def middle_section(section: Section, head: Section | None) -> Section:
    """Return the section at the middle of a segment; ``head`` is None without taper."""
    return section if head is None else interpolate_section(section, head, 0.5)


def areas(tail: Section, head: Section) -> tuple[float, float, float]:
    """Return the areas in m² at tail, midpoint and head; they define a parabola along x."""
    return tail.area, middle_section(tail, head).area, head.area


def mean_area(section: Section, head: Section | None) -> float:
    """Return the mean area in m² along a segment; ``head`` is None without taper."""
    if head is None:
        return section.area
    tail, middle, last = areas(section, head)
    return (tail + 4.0 * middle + last) / 6.0

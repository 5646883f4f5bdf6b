# SPDX-License-Identifier: LGPL-3.0-or-later
"""Points of a sweep: a checked case for each combination of varied values.

Sections are inferred with the play of the case, not with a varied play. A varied play that does not
fit the inferred sections is an error. Varied keys that define sections (section, height_to_width,
mass_per_length, second_moment_of_area, density) are set before sections are inferred. If no model
needs plates, no sections are inferred, and any play is valid.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from copy import deepcopy
from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from protractile.geometry.box import BoxSection
from protractile.geometry.fields import names_of
from protractile.geometry.typography import choices
from protractile.runs.case import reading as case_file
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom, hold_ground
from protractile.runs.case.messages import translated_errors
from protractile.runs.case.schema import Case
from protractile.runs.case.sections import SectionTable
from protractile.runs.pipeline.quantities import Limit, case_limits
from protractile.runs.process.bad_input import BadInput
from protractile.runs.sweep.variation import UNUSED, Tables, Variation, parse, unit_of, with_size

Setting = tuple[Variation, float]

# Inferred plates of each segment; None if the case gives them or needs none.
Plates = list[SectionTable | None]

_BOX_REMARK = " (the boxes are those that the case infers with its own play)"


@dataclass(frozen=True, slots=True)
class Point:
    """A point of a sweep: values of the varied keys, and their case."""

    values: tuple[float, ...]  #: values of the varied keys, in the order of the variations
    label: str  #: label in messages, ``joint.play=0.01 payload.mass=200``
    case: Case  #: checked case of the point


@dataclass(frozen=True, slots=True)
class Plan:
    """A sweep before its runs: the variations, and the points to run."""

    file: str  #: file of the case, as the user gave it
    title: str  #: title of the case
    variations: Sequence[Variation]  #: variations, at least one
    units: Sequence[str]  #: unit of each variation; empty if dimensionless
    bonded: Sequence[str]  #: names of the models without play
    points: Sequence[Point]  #: points of all combinations; the last variation changes fastest
    reference: str | None = None  #: name of the model with which the others are compared
    limits: Sequence[Limit] = ()  #: limits of the case

    @property
    def coordinates(self) -> dict[str, Any]:
        """The coordinates of the dataset of results: values of varied keys, and model names."""
        return {
            variation.key: (variation.key, np.array(variation.values), {"units": unit or "1"})
            for variation, unit in zip(self.variations, self.units, strict=True)
        } | {"model": [model.name for model in self.points[0].case.models]}

    @property
    def shape(self) -> list[int]:
        """The number of values of each variation."""
        return [len(variation.values) for variation in self.variations]


def plan(
    file: str,
    texts: Sequence[str],
    models: Sequence[str] | None,
    mesh_size: float | None,
    reference: str | None = None,
    whole: Case | None = None,
) -> Plan:
    """Return the plan of a sweep with checked points.

    Args:
        file: a case file, or the name of the case in messages.
        texts: options KEY=VALUES, see :mod:`.runs.sweep.variation`.
        models: names of models; all unless given.
        mesh_size: mesh size of all shells in m; the mesh size of the case unless given.
        reference: name of the model with which the others are compared.
        whole: the checked case with all models; read from the file unless given.

    Raises:
        BadInput: the case, a key, a value, a point or the reference is invalid.
    """
    whole = whole or case_file.load(file)
    case_file.select(whole, file, models, mesh_size, 0)
    tables = tables_of(whole)
    variations = parse(texts, tables, file)
    first = set_numbers(file, whole, tables, tuple((v, v.values[0]) for v in variations))
    units = [whole.system.unit(unit_of(variation.places[0], first)) for variation in variations]
    variations = [
        replace(variation, places=tuple(with_size(place, first) for place in variation.places))
        for variation in variations
    ]
    combinations = (
        tuple(zip(variations, values, strict=True))
        for values in product(*(variation.values for variation in variations))
    )
    points = list(make_points(whole, file, models, mesh_size, combinations))
    _check_influence(file, variations, points)
    run = points[0].case.models
    names = [model.name for model in run]
    if reference is not None and reference not in names:
        what = f"{reference!r} is not a model that is run; give {choices(names)}"
        raise BadInput(file, "--against", what)
    if names == [reference]:
        what = f"no model is compared with {reference!r}; run another model"
        raise BadInput(file, "--against", what)
    bonded = [model.name for model in run if model.bonded]
    # A share of a length that varies is no one limit.
    limits = [
        limit
        for limit in case_limits(whole, build_boom(whole))
        if not limit.share
        or all(limit in case_limits(whole, build_boom(point.case)) for point in points)
    ]
    return Plan(file, whole.title, variations, units, bonded, points, reference, limits)


def chosen_beam(case: Case, models: Sequence[str] | None) -> list[str]:
    """Return the names ``models``; by default the name of the last beam, if possible with play."""
    if models is not None:
        return list(models)
    beams = [model for model in case.models if not model.needs_shell]
    with_play = [model for model in beams if not model.bonded]
    return [model.name for model in with_play or beams][-1:]


def tables_of(case: Case) -> Tables:
    """Return a case as nested dictionaries, without tables that do not affect sweeps."""
    unused = {names_of(Case)[key] for key in UNUSED}
    own = case.without_client_keys()
    return own.model_dump(mode="json", by_alias=True, exclude_none=True, exclude=unused)


def make_points(
    whole: Case,
    file: str,
    models: Sequence[str] | None,
    mesh_size: float | None,
    combinations: Iterable[Sequence[Setting]],
    plates: dict[Sequence[Setting], Plates] | None = None,
) -> Iterator[Point]:
    """Yield a checked point for each combination of values of the varied keys.

    ``plates`` caches inferred plates, by the values that determine sections.

    Raises:
        BadInput: a combination is invalid.
    """
    tables = tables_of(whole)

    def case_of(settings: Sequence[Setting]) -> Case:
        return case_file.select(set_numbers(file, whole, tables, settings), file, models)

    plates = {} if plates is None else plates
    for settings in combinations:
        section_settings = tuple(setting for setting in settings if setting[0].shapes_sections)
        label = _label(settings)
        checked = None
        if section_settings not in plates:
            checked = _check_point(file, label, case_of(section_settings))
            plates[section_settings] = infer_plates(checked)
        case = hold_plates(case_of(settings), plates[section_settings])
        if case != checked:
            _check_point(file, label, case, any(plates[section_settings]))
        values = tuple(value for _, value in settings)
        yield Point(values, label, case_file.select(case, file, None, mesh_size))


def set_numbers(file: str, whole: Case, tables: Tables, settings: Sequence[Setting]) -> Case:
    """Return a case with other numbers in its tables, not checked beyond the schema.

    Raises:
        BadInput: a number exceeds the limits of its key.
    """
    changed = deepcopy(tables)
    try:
        for variation, value in settings:
            for place in variation.places:
                place.put(changed, value)
        with translated_errors(file):
            return hold_ground(Case.model_validate(changed), whole)
    except OverflowError:
        what = "a value is too large for SI units; give smaller ones"
        raise BadInput(file, f"--vary {_label(settings)}", what) from None
    except BadInput as fault:
        for variation, _ in settings:
            if any(f"{place.name}.".startswith(f"{fault.key}.") for place in variation.places):
                raise BadInput(file, f"--vary {variation.key}", fault.what) from None
        what = f"{fault.key}: {fault.what}"
        raise BadInput(file, f"--vary {_label(settings)}", what) from None


def _check_point(file: str, label: str, case: Case, inferred: bool = False) -> Case:
    try:
        case_file.check(case, file)
    except BadInput as fault:
        remark = _BOX_REMARK if fault.key.endswith("play") and inferred else ""
        raise BadInput(file, f"--vary {label}", f"{fault.key}: {fault.what}{remark}") from None
    return case


def infer_plates(case: Case) -> Plates:
    """Return the inferred plates of each segment of a checked case; None if none are inferred."""
    sections = [segment.section for segment in build_boom(case).segments]
    return [
        SectionTable(
            height=section.height, width=section.width, flange=section.flange, web=section.web
        )
        if table.section is None and isinstance(section, BoxSection)
        else None
        for table, section in zip(case.segments, sections, strict=True)
    ]


def hold_plates(case: Case, plates: Plates) -> Case:
    """Return the case with inferred plates written as tables of sections."""
    needed = case.spatial or any(model.needs_plates for model in case.models)
    segments = tuple(
        segment
        if plate is None
        else segment.model_copy(
            update={"height_to_width": None, "section": plate if needed else None}
        )
        for segment, plate in zip(case.segments, plates, strict=True)
    )
    return case.model_copy(update={"segments": segments})


def _check_influence(file: str, variations: Sequence[Variation], points: Sequence[Point]) -> None:
    """Check that each varied key affects the runs."""
    digests = [toml.digest(point.case) for point in points]
    stride = len(points)
    for variation in variations:
        stride //= len(variation.values)
        if digests[0] == digests[stride]:
            raise BadInput(
                file,
                f"--vary {variation.key}",
                "no model of the sweep depends on it; leave it out, or run a model that does",
            )


def _label(settings: Sequence[Setting]) -> str:
    return " ".join(f"{variation.key}={value:g}" for variation, value in settings)

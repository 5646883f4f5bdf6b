# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fatigue damage of weld details under sequences of load cases.

A detail moves with its segment. Its nominal stress in each load case is the stress of the outer
fibres at its cross-section. Stress ranges are counted around the closed sequence of load cases.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from protractile.analysis.fatigue import HAS_RAINFLOW, MEGA, count_stress_ranges, endurance
from protractile.analysis.stresses import Fibres
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import combine
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.largest_loads import BeamStates
from protractile.runs.pipeline.statics import boom_with_play

# Number of cross-sections of a segment at which the worst weld is sought.
_SECTIONS = 41

# Stresses are taken at this distance in m on both sides of a detail, where forces may jump.
_BESIDE = 1.0e-6


class Detail(NamedTuple):
    """A weld detail: name, index of its segment, x in m at t = 0, and category."""

    name: str
    segment: int
    x: float
    category: float


class Damage(NamedTuple):
    """Miner's sum of all spectra, and the spectrum with the largest share."""

    sum: float
    spectrum: str


def details(case: Case, boom: Boom) -> Iterator[Detail]:
    """Yield the weld details: at collars, diaphragms and stations, and along each segment."""
    for number, segment in enumerate(boom.segments):
        name = segment.name
        for collar in segment.collars:
            if collar.detail_category is not None:
                for x in collar.span:
                    yield Detail(f"collar, {name}", number, x, collar.detail_category)
        for plate in segment.diaphragms:
            if plate.detail_category is not None:
                yield Detail(f"diaphragm, {name}", number, plate.x, plate.detail_category)
        if case.life.detail_category is not None:
            for x in np.linspace(segment.start, segment.end, _SECTIONS):
                yield Detail(f"worst weld, {name}", number, float(x), case.life.detail_category)
    for joint in boom.joints:
        if joint.detail_category is not None:
            for x in joint.stations:
                for number in (joint.outer, joint.inner):
                    name = f"station, {boom.segments[number].name}"
                    yield Detail(name, number, x, joint.detail_category)


def detail_damages(case: Case) -> list[tuple[Detail, Damage]]:
    """Return, for each name of details, the one with the largest damage by all spectra.

    The result is empty without spectra or without the package ``rainflow``.

    Raises:
        NumericsError: a load case has no equilibrium.
    """
    if not (case.spectra and HAS_RAINFLOW):
        return []
    damages: dict[str, tuple[Detail, Damage]] = {}
    tables = {one.name: one for one in case.load_cases}
    named = {(name, one.motion) for one in case.spectra for name in one.load_cases}
    beams: dict[tuple[str, bool], BeamStates] = {}
    for name, moving in named:
        plain = combine(case, tables[name])
        if moving:
            beams[name, moving] = BeamStates.in_motion(plain)
        else:
            beams[name, moving] = BeamStates.of(plain, boom_with_play(plain, build_boom(plain)))
    boom = build_boom(case)
    for detail in details(case, boom):
        if boom.segments[detail.segment].section is None:
            continue
        inside = detail.x - boom.segments[detail.segment].start
        stress = {key: _stress(beam, detail.segment, inside) for key, beam in beams.items()}
        damage = _damage(case, detail.category, stress)
        if detail.name not in damages or damage.sum > damages[detail.name][1].sum:
            damages[detail.name] = detail, damage
    return [*damages.values()]


def _stress(beam: BeamStates, number: int, inside: float) -> Array:
    """Return the stress (2 num_fibres, num_times) in Pa on both sides of a cross-section."""
    segment, line = beam.boom.segments[number], beam.model.lines[number]
    fibres = Fibres.of(segment, line)
    assert fibres is not None
    curves = beam.model.section_forces(number, beam.positions, beam.time)
    x = np.clip(segment.start + inside + np.array([-_BESIDE, _BESIDE]), *segment.ends)
    return np.array(
        [
            [np.interp(at, line.x, row) for row in fibres.stress(fibre, curves)]
            for fibre in range(len(fibres.z))
            for at in x
        ]
    )


def _damage(case: Case, category: float, stress: Mapping[tuple[str, bool], Array]) -> Damage:
    """Return the damage of the worst fibre of a detail from its stresses in all load cases."""
    shares = []
    for spectrum in case.spectra:
        # The sequence of the states of all load cases, which repeats.
        parts = [stress[name, spectrum.motion] for name in spectrum.load_cases]
        sequence = np.concatenate(parts, axis=1)
        of_fibres = []
        for one in sequence:
            sizes, counts = count_stress_ranges(one)
            raised = case.life.partial_factor * sizes
            of_fibres.append(float((counts / endurance(raised, MEGA * category)).sum()))
        shares.append(spectrum.repeats * np.array(of_fibres))
    worst = int(np.sum(shares, axis=0).argmax())
    damages = [float(share[worst]) for share in shares]
    return Damage(sum(damages), case.spectra[int(np.argmax(damages))].name)

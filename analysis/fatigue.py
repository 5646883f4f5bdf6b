# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fatigue damage of stress histories, in motion and of weld details in sequences of load cases.

Cycles of the repeated history are counted by the rainflow method (Matsuishi and Endo 1968; ASTM
E1049). Miner's sum uses the S-N curve of the detail category (EN 1993-1-9, 7.1): N = 2e6 (C/Δσ)³
up to 5e6 cycles, slope 5 from there on, and no damage below the cut-off limit at 1e8 cycles.

A detail moves with its segment. Its nominal stress in each load case is the stress of the outer
fibres at its cross-section.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from protractile.analysis.measure import Measured
from protractile.analysis.rows import BEAM, MOTION, SPECTRUM, Row
from protractile.analysis.states import States
from protractile.analysis.stresses import Fibres
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom

# Numbers of cycles at the detail category, the constant-amplitude limit and the cut-off limit.
CATEGORY_CYCLES, LIMIT, CUT_OFF = 2.0e6, 5.0e6, 1.0e8
STEEP, FLAT = 3.0, 5.0

# Debian has no package rainflow. Without it the fatigue assessment is left out.
HAS_RAINFLOW = find_spec("rainflow") is not None

# Fraction of the largest stress range, the usual tolerance of the time step, up to which ranges are
# numerical errors. A million of them do 0.1 % of the damage of the largest range.
NOISE = 1.0e-3

# Unit of detail categories in Pa.
MEGA = 1.0e6

# Number of cross-sections of a segment at which the worst weld is sought.
_SECTIONS = 41

# Stresses are taken at this distance in m on both sides of a detail, where forces may jump.
_BESIDE = 1.0e-6


class Detail(NamedTuple):
    """A weld detail."""

    name: str  #: kind and segment
    segment: int  #: index of its segment
    x: float  #: x in m at t = 0
    category: float  #: detail category in MPa


class Spectrum(NamedTuple):
    """A sequence of load cases that repeats."""

    name: str  #: name of the spectrum
    load_cases: Sequence[Hashable]  #: keys of the load cases in their order
    repeats: int  #: number of repetitions in the service life


def count_stress_ranges(stress: Array) -> tuple[Array, Array]:
    """Return the stress ranges (num_ranges,) of a repeated stress history in Pa, and their counts.

    Each repetition returns from the last stress to the first one. The history is counted from its
    largest |stress| around to it, so that no half cycles remain (ASTM E1049-85, 5.4.5). Ranges that
    are small as errors of the motion do not count.
    """
    import rainflow

    start = int(np.abs(stress).argmax())
    cycles = [*rainflow.count_cycles([*np.roll(stress, -start), stress[start]])]
    sizes, counts = np.array(cycles, dtype=float).reshape(-1, 2).T
    counted = sizes > NOISE * np.ptp(stress)
    return sizes[counted], counts[counted]


def endurance(sizes: Array, category: float) -> Array:
    """Return the cycles to failure (num_ranges,), which are infinite below the cut-off limit.

    Stress ranges and detail category are in Pa.
    """
    limit = category * (CATEGORY_CYCLES / LIMIT) ** (1.0 / STEEP)
    cut_off = limit * (LIMIT / CUT_OFF) ** (1.0 / FLAT)
    relative = np.maximum(sizes, cut_off) / limit
    cycles = LIMIT * np.where(relative >= 1.0, relative**-STEEP, relative**-FLAT)
    return np.asarray(np.where(sizes >= cut_off, cycles, np.inf))


class Life(NamedTuple):
    """Data of fatigue damage and of wear."""

    category: float | None = None  #: detail category in MPa; None for cycles without damage
    partial_factor: float = 1.0  #: factor of stress ranges
    repeats: float = 1.0  #: number of runs in the service life
    wear: float | None = None  #: coefficient of wear of the pads in mm³/(N m); None without wear
    tip: float | None = None  #: limit of the tip deflection at rest with worn pads in m; None: none


def life_rows(stresses: Sequence[Measured], model: str, play: bool, life: Life) -> Iterator[Row]:
    """Yield cycles, stress ranges and damages of a segment where its stress varies most.

    Args:
        stresses: stresses of the outer fibres of a segment in motion.
        model: name of the model.
        play: False for the boom without play.
        life: detail category, factor and repeats.
    """
    if not stresses:
        return
    widest = max(stresses, key=lambda stress: float(np.ptp(stress.values, axis=0).max()))
    column = int(np.ptp(widest.values, axis=0).argmax())
    x, y, z = (None if at is None else float(at[column]) for at in widest.places)
    sizes, counts = count_stress_ranges(widest.values[:, column])
    # A cycle of the equivalent range does the damage of all cycles at slope 3.
    numbers = {
        "cycles": float(counts.sum()),
        "stress_range": float(sizes.max(initial=0.0)),
        "equivalent_range": float((counts @ sizes**STEEP) ** (1.0 / STEEP)),
    }
    if life.category is not None:
        raised = life.partial_factor * sizes
        damage = float((counts / endurance(raised, MEGA * life.category)).sum())
        numbers |= {"run_damage": damage, "damage": life.repeats * damage}
    for name, value in numbers.items():
        limit = 1.0 if name == "damage" else None
        yield Row(model, MOTION, play, name, widest.part, "", value, x, y, z, limit=limit)


def details(boom: Boom, category: float | None) -> Iterator[Detail]:
    """Yield the weld details: at collars, diaphragms and stations, and along each segment.

    Segments without a known section have none. ``category`` in MPa is that of details along each
    segment; None without them.
    """
    for number, segment in enumerate(boom.segments):
        if segment.section is None:
            continue
        name = segment.name
        for collar in segment.collars:
            if collar.detail_category is not None:
                for x in collar.span:
                    yield Detail(f"collar, {name}", number, x, collar.detail_category)
        for plate in segment.diaphragms:
            if plate.detail_category is not None:
                yield Detail(f"diaphragm, {name}", number, plate.x, plate.detail_category)
        if category is not None:
            for x in np.linspace(segment.start, segment.end, _SECTIONS):
                yield Detail(f"worst weld, {name}", number, float(x), category)
    for joint in boom.joints:
        if joint.detail_category is not None:
            for x in joint.stations:
                for number in (joint.outer, joint.inner):
                    if boom.segments[number].section is not None:
                        name = f"station, {boom.segments[number].name}"
                        yield Detail(name, number, x, joint.detail_category)


def fatigue_proofs(
    boom: Boom,
    details: Iterable[Detail],
    states: Mapping[Hashable, States],
    spectra: Sequence[Spectrum],
    partial_factor: float,
) -> Iterator[Row]:
    """Yield, for each name of details, the proof of the one with the largest damage.

    Its state is the spectrum with the largest share of the damage.

    Args:
        boom: boom at t = 0.
        details: details of the boom.
        states: states in each load case, by its key.
        spectra: all spectra of the service life.
        partial_factor: factor of stress ranges.
    """
    worst: dict[str, Row] = {}
    for detail in details:
        inside = detail.x - boom.segments[detail.segment].start
        stress = {key: _stress(state, detail.segment, inside) for key, state in states.items()}
        shares = np.array(
            [
                spectrum.repeats * _damages(spectrum, detail.category, stress, partial_factor)
                for spectrum in spectra
            ]
        )
        fibre = int(shares.sum(axis=0).argmax())
        name = SPECTRUM + spectra[int(shares[:, fibre].argmax())].name
        damage = float(shares[:, fibre].sum())
        row = Row(BEAM, name, True, "fatigue", detail.name, "", damage, detail.x, limit=1.0)
        if damage > worst.setdefault(detail.name, row).value:
            worst[detail.name] = row
    yield from worst.values()


def _stress(states: States, number: int, inside: float) -> Array:
    """Return the stress (2 num_fibres, num_states) in Pa on both sides of a cross-section."""
    segment, line = states.boom.segments[number], states.model.lines[number]
    fibres = Fibres.of(segment, line)
    assert fibres is not None
    curves = states.section_forces(number)
    x = np.clip(segment.start + inside + np.array([-_BESIDE, _BESIDE]), *segment.ends)
    return np.array(
        [
            [np.interp(at, line.x, row) for row in fibres.stress(fibre, curves)]
            for fibre in range(len(fibres.z))
            for at in x
        ]
    )


def _damages(
    spectrum: Spectrum, category: float, stress: Mapping[Hashable, Array], partial_factor: float
) -> Array:
    """Return the damage (2 num_fibres,) of one repetition, from stresses in all load cases."""
    damages = []
    for sequence in np.concatenate([stress[key] for key in spectrum.load_cases], axis=1):
        sizes, counts = count_stress_ranges(sequence)
        cycles = endurance(partial_factor * sizes, MEGA * category)
        damages.append(float((counts / cycles).sum()))
    return np.array(damages)

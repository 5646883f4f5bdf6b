# SPDX-License-Identifier: LGPL-3.0-or-later
"""Proofs of strength, stability, deflection and fatigue for all combinations of a case.

The stresses are outer-fibre stresses from section forces of second order. Only the governing proof
of each part of the boom is kept.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from textwrap import fill
from typing import NamedTuple

import numpy as np

from protractile.analysis.plate_buckling import (
    nominal_wall_stresses,
    reduced_stress,
    reduction_factors,
    relative_slenderness,
)
from protractile.beam_model.statics import estimate_critical_factor
from protractile.dynamics.failure import NumericsError
from protractile.geometry.cylinder import force_name
from protractile.geometry.units import System
from protractile.runs.case.load_tables import CombinationTable
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.combinations import CombinationState
from protractile.runs.pipeline.fatigue import detail_damages
from protractile.runs.pipeline.largest_loads import BeamStates
from protractile.runs.report.formatting import amount
from protractile.runs.report.tables import Column, Table
from protractile.shell_model.stress.history import BAND

# Definition of a proof, for the notes of tables.
DEFINITION = (
    "A proof compares the design effect, left of ≤ in the formulas below, with the limit design "
    "value, right of ≤ (EN 13001-3-1)."
)
# Note if no shell proves the local plate stress.
_NO_SHELL = (
    "Local plate stress is not proved: these proofs use a beam, which has none. `protractile prove "
    "CASE.toml --shell NAME` proves it by a shell of the case."
)


class Kind(NamedTuple):
    """Kind of proof."""

    name: str  #: name in tables, notes and sentences
    formula: str  #: formula and source
    remedy: str  #: remedy if a proof fails
    effect: str = ""  #: name of the design effect in brackets; empty where the unit suffices


# Kinds of proofs by their keys in results.
KINDS: Mapping[str, Kind] = {
    "yield": Kind(
        "static strength",
        "√(σ² + 3 τ²) ≤ f_y(t)/γ; σ of outer fibres, τ mean of the wall of thickness t "
        "(EN 1993-1-1, 6.2.1)",
        "thicker walls there, a larger section or stronger steel",
    ),
    "patch": Kind(
        "local plate stress",
        "σ_v ≤ f_y/γ; mean von Mises stress of the shell over half the width of a wall, at "
        f"most {BAND:g} m along x from a station, support, lug or load",
        "a collar or thicker walls there, longer pads, or pads nearer the webs",
    ),
    "plate": Kind(
        "plate buckling",
        "√((σ/ρ)² + 3 (τ/χ)²) ≤ f_y(t)/γ; ρ, χ: reduction factors at the slenderness "
        "√(α_ult,k/α_cr), α_cr by panel formulas (EN 1993-1-5, 10)",
        "a thicker, narrower or stiffened wall there",
        " (stress / reduction factor)",
    ),
    "buckling": Kind(
        "plate buckling (shell)",
        "σ_v ≤ ρ f_y/γ; ρ: lower reduction factor of compression and shear at the slenderness "
        "√(f_y/(σ_v α_cr)), α_cr: lowest factor of the shell (EN 1993-1-5, 10)",
        "a thicker, narrower or stiffened wall there, or a collar at the pads",
    ),
    "column": Kind(
        "column buckling",
        "N ≤ N_cr/γ with closed contacts; other proofs include second-order effects of N",
        "larger sections, a smaller extension or less force along the boom",
    ),
    "pad": Kind(
        "pad pressure",
        "F/(length · width) ≤ allowable pressure/γ; F: force of one pad of a pair",
        "longer or wider pads, or a longer overlap",
    ),
    "cylinder": Kind(
        "cylinder force",
        "F ≤ capacity/γ",
        "a larger cylinder, or a longer lever arm to the foot pin",
    ),
    "pin": Kind(
        "pin shear",
        "F ≤ 0.6 n A f_up/γ; n: number of shear planes (EN 1993-1-8, table 3.10)",
        "a thicker pin, or more shear planes",
    ),
    "deflection": Kind(
        "static tip deflection",
        "deflection under the loads of the combination ≤ limits.tip_at_rest",
        "larger sections, less play or a longer overlap",
    ),
    "fatigue": Kind(
        "fatigue strength",
        "Σ n/N ≤ 1, nominal ranges, rainflow and Miner (EN 1993-1-9, 7.1 and A.5)",
        "a better detail, its place at less stress, or fewer repeats",
    ),
}


class Proof(NamedTuple):
    """Design effect on a part of the boom, and its limit design value.

    Args:
        kind: kind of the proof, a key of :data:`KINDS`.
        part: the part of the boom.
        place: name of the part and of its governing wall or detail.
        x: position of the governing cross-section in m; None for other parts.
        demand, resistance: design effect and limit design value, in ``unit``.
        unit: SI unit.
        combination: governing combination and load case, or governing spectrum.
    """

    kind: str
    part: str
    place: str
    x: float | None
    demand: float
    resistance: float
    unit: str
    combination: str = ""

    @property
    def utilisation(self) -> float:
        """The design effect over the limit design value."""
        return self.demand / self.resistance

    @property
    def remedy(self) -> str:
        """The remedy if the proof fails."""
        return KINDS[self.kind].remedy

    @property
    def holds(self) -> bool:
        """True if the design effect does not exceed the limit design value."""
        return self.demand <= self.resistance

    def numbers(self) -> list[str]:
        """Return design effect and limit design value as text."""
        both = (amount(one, self.unit) for one in (self.demand, self.resistance))
        return [one.removesuffix(" 1") for one in both]

    def text(self, system: System) -> str:
        """Return a sentence with place, numbers and combination, in units of a system."""
        demand, resistance = self.numbers()
        relation = "≤" if self.holds else "exceeds"
        name, cause = KINDS[self.kind].name, "spectrum" if self.kind == "fatigue" else "combination"
        place = "" if self.place in name.split() else f", {self.place}"
        place += "" if self.x is None else f" at x = {system.text(self.x, 'm')}"
        of = f", {cause} {self.combination!r}" if self.combination else ""
        return (
            f"{name}{place}: {demand}{KINDS[self.kind].effect} {relation} {resistance} "
            f"({100.0 * self.utilisation:.3g} %){of}"
        )


class Proofs(NamedTuple):
    """Proofs of a case, the governing one first, and notes on missing proofs."""

    proofs: list[Proof]
    notes: list[str]
    of: str = " of the combinations"  #: what is proved, in the sentence on the number of proofs

    def governing(self, system: System) -> str:
        """Return a sentence on the governing proof and the number of proofs that fail."""
        if not self.proofs:
            return "The case has no numbers for a proof."
        governs = self.proofs[0]
        change = "" if governs.holds else f". Remedy: {governs.remedy}"
        return f"{self.tally}. Governing: {governs.text(system)}{change}."

    @property
    def tally(self) -> str:
        """The number of proofs that fail, in words, without a full stop."""
        failed = sum(not one.holds for one in self.proofs)
        what = f"{len(self.proofs)} proofs{self.of}"
        text = f"{failed} of {what} fail" if failed else f"All {what} are satisfied"
        return text + ("; local plate stress is not proved" if _NO_SHELL in self.notes else "")


def prove(case: Case, states: Sequence[CombinationState]) -> Proofs:
    """Return the governing proof of each part of the boom over all combinations.

    Raises:
        NumericsError: a combination has no equilibrium.
    """
    governing: dict[tuple[str, str], Proof] = {}
    for state in states:
        for one in _proofs(state, case):
            other = governing.setdefault((one.kind, one.part), one)
            if one.utilisation > other.utilisation:
                governing[one.kind, one.part] = one
    for (name, _, x, _), damage in detail_damages(case):
        fatigue = Proof("fatigue", name, name, x, damage.sum, 1.0, "1", damage.spectrum)
        governing["fatigue", name] = fatigue
    proofs = sorted(governing.values(), key=lambda one: -one.utilisation)
    of = " of the load cases" if case.load_cases else ""
    notes = [*_missing_data_notes(case, states), *_curve_note(case, states)]
    return Proofs(proofs, notes, " of the combinations" if case.combinations else of)


def _proofs(state: CombinationState, case: Case) -> Iterator[Proof]:
    beam, table = state.beam, state.combined.combination
    name = state.combined.name if case.combinations or case.load_cases else ""
    if beam is None:
        raise NumericsError(
            f"{state.combined.name}: no static equilibrium; the boom is unrestrained or buckles"
        )
    for rule in (_wall_proofs, _deflection_proofs, _station_proofs, _foot_proofs):
        for one in rule(beam, table, case):
            if one.kind in table.proofs:
                yield one._replace(combination=name)
    if "column" in table.proofs:
        for one in _column_proofs(beam, state.critical_factor, table):
            yield one._replace(combination=name)
    for one in _shell_proofs(state, case):
        if _OF_SHELLS[one.kind] in table.proofs:
            yield one._replace(combination=name)


def _wall_proofs(beam: BeamStates, table: CombinationTable, case: Case) -> Iterator[Proof]:
    for wall in nominal_wall_stresses(beam.boom.segments, beam.rests):
        strength = wall.segment.material.strength(wall.plate.thickness)
        if strength is None:
            continue
        equivalent = np.sqrt(np.abs(wall.fibres).max(axis=0) ** 2 + 3.0 * wall.shear**2)
        reduced = reduced_stress(wall, strength, case.buckling.curve if case.buckling else ())
        for kind, stress, factor in (
            ("yield", equivalent, table.resistance.material),
            ("plate", reduced, table.resistance.stability),
        ):
            most = int(stress.argmax())
            name = wall.segment.name
            place, x = f"{name}, {_wall_text(wall.plate.name)}", float(wall.x[most])
            yield Proof(kind, name, place, x, float(stress[most]), strength / factor, "Pa")


def _wall_text(name: str) -> str:
    """Return the name of a wall as text; walls of one side are numbered upwards."""
    side, _, number = name.partition("-")
    return f"{side} side, wall {number} from below" if number else f"{side} wall"


def _shell_proofs(state: CombinationState, case: Case) -> Iterator[Proof]:
    """Yield the proofs that use wall stresses and buckling factors of a shell."""
    beam, factors = state.beam, state.combined.combination.resistance
    assert beam is not None
    segments = {segment.name: segment for segment in beam.boom.segments}
    for wall in state.walls:
        strength = segments[wall.segment].yield_strength
        if strength is not None:
            at = wall.segment, wall.segment, wall.x
            yield Proof("patch", *at, wall.patch, strength / factors.material, "Pa")
    curve = case.buckling.curve if case.buckling else ()
    for one in state.buckling:
        strength = segments[one.segment].yield_strength
        walls = [
            wall
            for wall in nominal_wall_stresses(beam.boom.segments, beam.rests)
            if wall.segment.name == one.segment
        ]
        if strength is None or not one.factors or not walls:
            continue
        stress = max(
            float(np.hypot(np.abs(wall.edges).max(axis=0), np.sqrt(3.0) * wall.shear).max())
            for wall in walls
        )
        slenderness = float(np.sqrt(strength / (stress * one.factors[0])))
        reduction = float(min(reduction_factors(slenderness, 1.0, curve)))
        place = f"{one.segment}, {_wall_text(one.walls[0])}"
        resistance = reduction * strength / factors.stability
        yield Proof("buckling", one.segment, place, one.x[0], stress, resistance, "Pa")


# Kinds of proofs by a shell, and the name by which a combination requests each.
_OF_SHELLS = {"patch": "yield", "buckling": "plate"}


def _column_proofs(
    beam: BeamStates, factor: float | None, table: CombinationTable
) -> Iterator[Proof]:
    """Yield the proof of column buckling, by the factor of a shell or else of beams."""
    if not beam.boom.compressed:
        return
    factor = estimate_critical_factor(beam.boom) if factor is None else factor
    normal = min(min(one.normal) for rest in beam.rests for one in rest.diagrams)
    if factor is not None and np.isfinite(factor) and normal < 0.0:
        resistance = -normal * factor / table.resistance.stability
        yield Proof("column", "boom", "boom", None, -normal, resistance, "N")


def _deflection_proofs(beam: BeamStates, table: CombinationTable, case: Case) -> Iterator[Proof]:
    permitted = case.limits.tip_at_rest if case.limits else None
    if permitted is not None:
        tip = float(np.abs(beam.observed("tip")).max())
        yield Proof("deflection", "tip", "tip", None, tip, permitted, "m")


def _station_proofs(beam: BeamStates, table: CombinationTable, case: Case) -> Iterator[Proof]:
    for one in beam.extremes(case.system):
        used = one.utilisation
        if used is not None and used.part == "pad" and used.value:
            resistance = used.load / used.value / table.resistance.pad
            lateral = ", lateral" if one.part.endswith(", lateral") else ""
            place = f"{used.segment}{lateral}"
            yield Proof("pad", one.part, place, used.x, used.load, resistance, "Pa")
    for number, cylinder in enumerate(beam.boom.cylinders, start=1):
        name = "cylinder" if len(beam.boom.cylinders) == 1 else f"cylinder {number}"
        force = float(np.abs(beam.observed(force_name(number))).max())
        if cylinder.capacity is not None:
            resistance = cylinder.capacity / table.resistance.cylinder
            yield Proof("cylinder", name, name, None, force, resistance, "N")
        if cylinder.pin is not None:
            resistance = cylinder.pin.resistance / table.resistance.pin
            yield Proof("pin", name, f"lug of {name}", cylinder.x, force, resistance, "N")


def _foot_proofs(beam: BeamStates, table: CombinationTable, case: Case) -> Iterator[Proof]:
    forces = {one.part: abs(one.largest) for one in beam.foot_extremes(case.system)}
    for segment in beam.boom.segments:
        force = forces.get(segment.name)
        if segment.foot is not None and segment.foot.pin is not None and force is not None:
            name = f"foot, {segment.name}"
            resistance = segment.foot.pin.resistance / table.resistance.pin
            yield Proof("pin", name, name, segment.foot.x, force, resistance, "N")


def _curve_note(case: Case, states: Sequence[CombinationState]) -> Iterator[str]:
    """Yield a note if a wall is more slender than the buckling curve of the case."""
    if case.buckling is None or not case.buckling.curve:
        return
    walls = [
        wall
        for state in states
        if state.beam is not None and "plate" in state.combined.combination.proofs
        for wall in nominal_wall_stresses(state.beam.boom.segments, state.beam.rests)
    ]
    slender = [
        (float(relative_slenderness(wall, strength).max()), wall)
        for wall in walls
        if (strength := wall.segment.material.strength(wall.plate.thickness)) is not None
    ]
    most, wall = max(slender, key=lambda one: one[0], default=(0.0, None))
    end = case.buckling.curve[-1][0]
    if wall is not None and most > end:
        yield (
            f"`buckling.curve` ends at a slenderness of {end:g}, and the "
            f"{_wall_text(wall.plate.name)} of {wall.segment.name} has {most:.3g}: beyond its end "
            "the factor falls with the square of the slenderness. Give further pairs."
        )


def _missing_data_notes(case: Case, states: Sequence[CombinationState]) -> Iterator[str]:
    """Yield a note on each kind of proof for which the case has no numbers."""
    beam = states[0].beam
    assert beam is not None
    boom = beam.boom
    requested_proofs = {name for state in states for name in state.combined.combination.proofs}
    steels = [one.name for one in boom.segments if one.yield_strength is None]
    if steels and requested_proofs & {"yield", "plate"}:
        names = ", ".join(steels)
        yield f"Static strength and plate buckling of {names} are not proved: no yield strength."
    if "yield" in requested_proofs and not any(state.walls for state in states):
        yield _NO_SHELL
    pressures = any(one.utilisation is not None for one in beam.rests[0].stations)
    if "pad" in requested_proofs and boom.joints and not pressures:
        yield "Pad pressure is not proved: no pad has an `allowable_pressure`."
    if "cylinder" in requested_proofs and any(one.capacity is None for one in boom.cylinders):
        yield "Cylinder force is not proved: a cylinder has no `capacity`."
    pins = [one.foot.pin for one in boom.segments if one.foot is not None]
    pins += [one.pin for one in boom.cylinders]
    if "pin" in requested_proofs and not any(pins):
        yield "Pin shear is not proved: the case has no table `pin`."
    if not case.spectra:
        yield "Fatigue strength is not proved: the case has no `[[spectrum]]`."
    if "deflection" not in requested_proofs:
        which = "no combination" if case.combinations else "the case has no combination that"
        yield f"Static tip deflection is not proved: {which} lists `deflection`."
    elif case.limits is None or case.limits.tip_at_rest is None:
        yield "Static tip deflection is not proved: the case has no `limits.tip_at_rest`."


def proof_table(result: Proofs, case: Case) -> Table:
    """Return the table of proofs, the governing one first."""
    proofs, system = result.proofs, case.system
    numbers = [one.numbers() for one in proofs]
    # Narrow columns keep the table within 80 characters.
    at = ["" if one.x is None else f"\n{system.text(one.x, 'm')}" for one in proofs]
    used = [f"{100.0 * one.utilisation:.3g} % {'✓' if one.holds else '✗'}" for one in proofs]
    columns = [
        Column("proof of", [fill(KINDS[one.kind].name, 12) for one in proofs]),
        Column("place, x", [fill(one.place, 20) + x for one, x in zip(proofs, at, strict=True)]),
        Column("design\neffect", [demand for demand, _ in numbers]),
        Column("limit\nvalue", [resistance for _, resistance in numbers]),
        Column("utilis-\nation", used),
        Column("combination,\nspectrum", [one.combination.replace(", ", ",\n") for one in proofs]),
    ]
    kinds = dict.fromkeys(one.kind for one in proofs)
    formulas = [f"{KINDS[kind].name.capitalize()}: {KINDS[kind].formula}." for kind in kinds]
    notes = [DEFINITION, *formulas, *result.notes]
    return Table("Proofs", columns, notes, "proofs", [one for one in used if "✗" in one])

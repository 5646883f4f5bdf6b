# SPDX-License-Identifier: LGPL-3.0-or-later
"""Proofs of strength, stability, deflection and fatigue for all combinations of a case.

Only the governing proof of each part of the boom is kept.
"""

from __future__ import annotations

from collections.abc import Collection, Hashable, Iterable, Iterator, Sequence
from typing import NamedTuple

from protractile.analysis.fatigue import HAS_RAINFLOW, Spectrum, details, fatigue_proofs
from protractile.analysis.proofs import Resistance, governing, most_slender_plate, proofs
from protractile.analysis.quantities import PROVED
from protractile.analysis.rows import COMBINATION, Row, Rows
from protractile.analysis.states import States
from protractile.beam_model.static_model import estimate_critical_factor
from protractile.dynamics.failure import NumericsError
from protractile.geometry.boom import Boom
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import combine
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.beam_states import moving_states, static_states
from protractile.runs.pipeline.combinations import CombinationState
from protractile.runs.pipeline.quantities import tip_limit
from protractile.runs.pipeline.statics import boom_with_play
from protractile.runs.pipeline.tipping import tipping_proofs

# Note if no shell proves the local plate stress.
NO_SHELL = (
    "Local plate stress is not proved: these proofs use a beam, which has none. `protractile prove "
    "CASE.toml --shell NAME` proves it by a shell of the case."
)


class Proofs(NamedTuple):
    """Proofs of a case, and notes on missing proofs."""

    rows: Rows  #: the proofs, the governing one first
    notes: Sequence[str]  #: notes on missing proofs
    of: str  #: what is proved: ``combinations``, ``load cases``, or empty for the case itself

    @classmethod
    def among(cls, rows: Iterable[Row], notes: Sequence[str], case: Case) -> Proofs:
        """Return the proofs of a case among rows."""
        proved = (row for row in rows if row.quantity in PROVED)
        ordered = sorted(proved, key=lambda row: -(row.utilisation or 0.0))
        of = "load cases" if case.load_cases else ""
        return cls(Rows(ordered), notes, "combinations" if case.combinations else of)


def prove(case: Case, states: Sequence[CombinationState]) -> Proofs:
    """Return the governing proof of each part of the boom over all combinations.

    Raises:
        NumericsError: a combination has no equilibrium.
    """
    proved = governing(row for state in states for row in proofs_of(state, case))
    notes = [*_missing_data_notes(case, states), *_curve_note(case, states)]
    return Proofs.among([*proved, *_fatigue(case)], notes, case)


def proofs_of(
    state: CombinationState, case: Case, kinds: Collection[str] | None = None
) -> Iterator[Row]:
    """Yield the proofs of a combination: those of ``kinds``, or those that its case demands.

    Raises:
        NumericsError: the combination has no equilibrium.
    """
    table, factor = state.combined.combination, state.critical_factor
    requested = table.proofs if kinds is None else kinds
    if state.states is None:
        raise NumericsError(
            f"{state.combined.name}: no static equilibrium; the boom is unrestrained or buckles"
        )
    if factor is None and "column" in requested:
        factor = estimate_critical_factor(state.states.boom)
    if "tipping" in requested:
        yield from tipping_proofs(state.combined, state.states)
    proved = proofs(
        state.states,
        lambda: state.rows,
        requested,
        Resistance(**table.resistance.model_dump()),
        case.buckling.curve if case.buckling else (),
        tip_limit(case, state.states.boom),
        factor,
        state.buckling,
    )
    name = COMBINATION + state.combined.name
    yield from (row._replace(model=state.model, state=name) for row in proved)


def _fatigue(case: Case) -> Iterator[Row]:
    """Yield the proofs of fatigue; none without spectra or without the package ``rainflow``.

    Raises:
        NumericsError: a load case has no equilibrium.
    """
    if not (case.spectra and HAS_RAINFLOW):
        return
    tables = {load_case.name: load_case for load_case in case.load_cases}
    states: dict[Hashable, States] = {}
    for name, moving in {
        (name, spectrum.motion) for spectrum in case.spectra for name in spectrum.load_cases
    }:
        plain = combine(case, tables[name])
        states[name, moving] = (
            moving_states(plain)
            if moving
            else static_states(plain, boom_with_play(plain, build_boom(plain)))
        )
    boom = build_boom(case)
    spectra = [
        Spectrum(
            spectrum.name,
            [(name, spectrum.motion) for name in spectrum.load_cases],
            spectrum.repeats,
        )
        for spectrum in case.spectra
    ]
    welds = details(boom, case.life.detail_category)
    yield from fatigue_proofs(boom, welds, states, spectra, case.life.partial_factor)


def wall_name(name: str) -> str:
    """Return the name of a wall as text; walls of one side are numbered upwards."""
    side, _, number = name.partition("-")
    return f"{side} side, wall {number} from below" if number else f"{side} wall"


def _curve_note(case: Case, states: Sequence[CombinationState]) -> Iterator[str]:
    """Yield a note if a wall is more slender than the buckling curve of the case."""
    if case.buckling is None or not case.buckling.curve:
        return
    most = most_slender_plate(
        state.states
        for state in states
        if state.states is not None and "plate" in state.combined.combination.proofs
    )
    end = case.buckling.curve[-1][0]
    if most is not None and most[0] > end:
        slenderness, segment, plate = most
        yield (
            f"`buckling.curve` ends at a slenderness of {end:g}, and the "
            f"{wall_name(plate)} of {segment} has {slenderness:.3g}: beyond "
            "its end the factor falls with the square of the slenderness. Give further pairs."
        )


def cylinder_notes(boom: Boom) -> Iterator[str]:
    """Yield a note on each cylinder whose force is not proved, or not in each respect."""
    for number, cylinder in enumerate(boom.cylinders, start=1):
        name = "cylinder" if len(boom.cylinders) == 1 else f"cylinder {number}"
        missing = [key for key in ("pressure", "bore") if getattr(cylinder, key) is None]
        if cylinder.resistance() is None:
            yield f"Force of the {name} is not proved: it has no `capacity`."
        elif cylinder.capacity is None and missing:
            yield (
                f"Oil pressure of the {name} is not proved: it has no `{missing[0]}`. If it "
                "pushes, only the buckling of its rod is proved; if it pulls, nothing is."
            )
        elif cylinder.resistance(pulls=True) is None:
            yield (
                f"Buckling of the rod of the {name} is not proved, and if it pulls, nothing is: it "
                "has no `rod`."
            )


def _missing_data_notes(case: Case, states: Sequence[CombinationState]) -> Iterator[str]:
    """Yield a note on each kind of proof for which the case has no numbers."""
    first = states[0].states
    assert first is not None
    boom = first.boom
    requested_proofs = {name for state in states for name in state.combined.combination.proofs}
    steels = [segment.name for segment in boom.segments if segment.yield_strength is None]
    if steels and requested_proofs & {"yield", "plate"}:
        names = ", ".join(steels)
        yield f"Static strength and plate buckling of {names} are not proved: no yield strength."
    if "yield" in requested_proofs and not any(state.walls for state in states):
        yield NO_SHELL
    if "column" in requested_proofs and boom.cylinders and not boom.compressed:
        yield "Column buckling is not proved: along the boom only cylinders press."
    pads = states[0].rows.where(quantity="pad_pressure")
    if "pad" in requested_proofs and boom.joints and all(row.limit is None for row in pads):
        yield "Pad pressure is not proved: no pad has an `allowable_pressure`."
    if "cylinder" in requested_proofs:
        yield from cylinder_notes(boom)
    pins = [segment.foot.pin for segment in boom.segments if segment.foot is not None]
    pins += [cylinder.pin for cylinder in boom.cylinders]
    if "pin" in requested_proofs and not any(pins):
        yield "Pin shear is not proved: the case has no table `pin`."
    if case.chassis is not None and "tipping" not in requested_proofs:
        yield "Tipping is not proved: no combination lists `tipping`."
    if not case.spectra:
        yield "Fatigue strength is not proved: the case has no `[[spectrum]]`."
    elif not [*details(boom, case.life.detail_category)]:
        yield "Fatigue strength is not proved: no part of the case has a `detail_category`."
    if "deflection" not in requested_proofs:
        which = "no combination" if case.combinations else "the case has no combination that"
        yield f"Static tip deflection is not proved: {which} lists `deflection`."
    elif case.limits is None or case.limits.tip_at_rest is None:
        yield "Static tip deflection is not proved: the case has no `limits.tip_at_rest`."

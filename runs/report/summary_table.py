# SPDX-License-Identifier: LGPL-3.0-or-later
"""Summary at the top of a report: effect of play, governing results, model quality, limits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from protractile.analysis.low_pass import mean_period
from protractile.analysis.rows import EXTENDED, INITIAL, MOTION, REST, Row, Rows
from protractile.geometry.typography import (
    NONE,
    TO_MEGA,
    TO_MILLI,
    TO_PERCENT,
    fixed,
    join_words,
    number,
    percent,
    signed_percent,
    with_minus_signs,
)
from protractile.runs.pipeline.design_results import ModelDesignResults
from protractile.runs.pipeline.model_quality import static_deviation
from protractile.runs.pipeline.pad_walls import rigid_wall_note
from protractile.runs.pipeline.quantities import decay_time
from protractile.runs.pipeline.results import Results
from protractile.runs.report.labels import (
    amount_of,
    farthest,
    place,
    times,
    tip_directions,
    title,
    used,
)
from protractile.runs.report.load_table import release_note
from protractile.runs.report.result_tables import PlayPair, peaks, play_pairs, weakest_panels
from protractile.runs.report.tables import Column, Table
from protractile.shell_model.stress.history import BAND

if TYPE_CHECKING:
    import xarray as xr

# Higher utilisations are highlighted.
NEAR = 0.9


def utilisations(rows: Rows) -> dict[str, Row]:
    """Return the row with the largest utilisation of each quantity with a limit, by quantity.

    ``rows`` are those of a model. Without a motion they are static. Of rows without a limit, the
    one with the largest magnitude counts.
    """
    loaded = rows.where(play=True, state=MOTION) or rows.where(play=True, state=REST)
    names = dict.fromkeys(row.quantity for row in loaded if row.of.short)
    governing = {name: loaded.where(quantity=name).governing for name in names}
    return {name: row for name, row in governing.items() if row is not None}


def summary_table(results: Results) -> Table | None:
    """Return the table of governing results of the main models, starting with the reference."""
    names, design = results.main_models, results.summary.design.models
    if not design:
        return None
    of_models = [results.rows.where(model=name, play=True) for name in names]
    at_start, at_most, extended = (
        [_value(rows, state, "tip") for rows in of_models] for state in (INITIAL, REST, EXTENDED)
    )
    if len({curve.time for curve in results.curves.where(state=REST)}) == 1:
        # Loads that do not vary have no maximum.
        at_most = []
    hertz = [_first_frequency(rows) for rows in of_models]
    # Decay by modal damping alone.
    decay_times = [decay_time(results.case.damping.modal, f) for f in hertz]
    most = [utilisations(rows) for rows in of_models]
    walls, fibres, pads, damages = (
        [of_model.get(name) for of_model in most]
        for name in ("wall_stress", "stress", "pad_pressure", "damage")
    )
    pad_cells = [
        None if pad is None else _pad(pad, rows) for pad, rows in zip(pads, of_models, strict=True)
    ]
    travel, periods = _travel_and_periods(results.trajectories, names)

    def largest(quantity: str, at: bool = False) -> list[str | None]:
        return [_largest(peaks(rows).where(quantity=quantity), rows, at) for rows in of_models]

    sideways = [_value(rows, REST, "tip_lateral") or None for rows in of_models]
    bending, plates = ([row and _stress(row) for row in several] for several in (fibres, walls))
    z, lateral = ", vertical (z)" if results.boom.spatial else "", "Static lateral tip deflection"
    rows_of_models = (
        Column("Static tip deflection (t = 0)", at_start, ".1f", "mm"),
        Column("Static tip deflection (maximum load)", at_most, ".1f", "mm"),
        Column("Static tip deflection (end of telescoping)", extended, ".1f", "mm"),
        Column(
            "Maximum dynamic tip deflection (factor φ)",
            [_dynamic_tip(rows) for rows in of_models],
            unit="mm",
        ),
        # A motion that starts undeformed is not in static equilibrium at t = 0.
        Column(f"Tip travel from t = 0{z}", travel, ".1f", "mm"),
        Column(
            "Residual vibration of the tip",
            [_vibration(design[name]) for name in names],
            unit="mm",
        ),
        Column(f"{lateral} (maximum load)", sideways, ".1f", "mm"),
        Column("Lateral tip deflection, maximum", largest("tip_lateral"), unit="mm"),
        Column("First natural frequency", hertz, ".3g", "Hz"),
        Column("Period of the motion (time history)", periods, ".3g", "s"),
        Column("Decay time to 10 %", decay_times, ".2g", "s"),
        Column("Governing pad: force, pressure, utilisation", pad_cells),
        Column(
            "Contact force, maximum",
            [] if any(pads) else largest("contact_force", at=True),
            unit="kN",
        ),
        Column("Cylinder force, maximum", largest("cylinder_force"), unit="kN"),
        Column("Foot reaction, maximum", largest("foot_reaction"), unit="kN"),
        Column("Bending stress, maximum (utilisation)", bending, unit="MPa"),
        Column("Local plate stress, maximum (utilisation)", plates, unit="MPa"),
        Column(
            "Plate buckling factor, lowest (segment)", [_buckling(results, name) for name in names]
        ),
        Column("Fatigue damage (Miner)", [damage and damage.value for damage in damages], ".3g"),
    )
    rows = {column.heading.replace("\n", ", "): column.text for column in rows_of_models}
    rows = {what: cells for what, cells in rows.items() if any(cell != NONE for cell in cells)}
    columns = [Column("", list(rows))]
    columns += [Column(name, [cells[i] for cells in rows.values()]) for i, name in enumerate(names)]
    loaded = [*walls, *fibres, *pads, *damages]
    texts = [*plates, *bending, *pad_cells, *(row and number(row.value) for row in damages)]
    strong = [
        text
        for row, text in zip(loaded, texts, strict=True)
        if row and text and (row.utilisation or 0.0) >= NEAR
    ]
    return Table("Design results", columns, [*_notes(results, rows)], "summary", strong)


def deviation_note(results: Results) -> str:
    """Return a sentence on deviations of other models with play from the reference, or ``""``."""
    design, reference = results.summary.design.models, results.reference
    if not design or reference is None:
        return ""
    loose = [
        model.name
        for model in results.completed_models
        if not model.bonded and model.name != reference
    ]
    offs = {name: static_deviation(results.rows, reference, name) for name in loose}
    deviations = [f"{name} {signed_percent(off)}" for name, off in offs.items() if off is not None]
    if not deviations:
        return ""
    behind = [name for name in results.summary.models if name not in results.main_models]
    shown = [model for model in results.completed_models if model.name in behind]
    others = [f"{model.name!r} ({model.kind}, {model.describe()})" for model in shown]
    more = f" Some tables and figures also show {join_words(others)}." if others else ""
    return (
        f"Deviation of the static tip deflection (maximum load) from {reference}: "
        f"{', '.join(deviations)}.{more}"
    )


def play_effect(results: Results) -> str:
    """Return a sentence on the effect of play in the reference model; empty without play."""
    pairs = play_pairs(results)
    kinds: dict[str, list[PlayPair]] = {}
    for pair in pairs:
        if pair.with_play.quantity in ("tip", "stress"):
            kinds.setdefault(f"the {title(pair.with_play)}", []).append(pair)
    most = {
        what: max(several, key=lambda pair: abs(pair.with_play.value))
        for what, several in kinds.items()
    }
    changed = {what: pair for what, pair in most.items() if not pair.is_negligible}
    more = [f"{_change(pair)} to {what}" for what, pair in changed.items() if pair.increase > 0.0]
    less = [f"{what} by {_change(pair)}" for what, pair in changed.items() if pair.increase <= 0.0]
    same = [what for what in most if what not in changed]
    parts = [(more, "adds"), (less, "reduces"), (same, "hardly changes")]
    sentences = [f"Play {verb} {join_words(several)}." for several, verb in parts if several]
    frequency = next((pair for pair in pairs if pair.with_play.quantity == "frequency"), None)
    if frequency is not None and not frequency.is_negligible:
        # Play itself, which opens contacts, has no part in this frequency.
        closed, bonded = (amount_of(row.of, row.value) for row in frequency)
        sentences.append(
            f"First natural frequency: {closed} with joints in contact, {bonded} with bonded "
            "joints."
        )
    return " ".join(sentences)


def _change(pair: PlayPair) -> str:
    share = (
        "" if pair.share is None else f" ({with_minus_signs(f'{TO_PERCENT * pair.share:+.0f}')} %)"
    )
    return f"{amount_of(pair.with_play.of, abs(pair.increase))}{share}"


def utilisation_verdict(results: Results, model: str | None = None) -> str:
    """Return a text on the utilisations of a model, by default the first main model.

    The governing utilisation comes first. Without strengths, allowable pressures and detail
    categories the text is empty.
    """
    rows = results.rows.where(model=model or results.main_models[0], play=True)
    governing = [row for row in utilisations(rows).values() if row.utilisation is not None]
    if not governing:
        return ""
    governing.sort(key=lambda row: row.utilisation or 0.0, reverse=True)
    steels = [segment.name for segment in results.boom.segments if segment.yield_strength is None]
    loaded = (pad for pad in rows.where(quantity="pad_pressure") if pad.value)
    pads = dict.fromkeys(pad.part for pad in loaded if pad.limit is None)
    missing = {"yield strength is given of": steels, "allowable pressure is given of pads of": pads}
    more = "".join(f" No {what} {join_words([*of])}." for what, of in missing.items() if of)
    several = "; ".join(map(used, governing))
    return f"In this run, without safety factors, the utilisation is {several}.{more}"


def _value(rows: Rows, state: str, quantity: str) -> float | None:
    """Return the value of largest magnitude of a quantity in SI units, with its sign."""
    row = rows.where(state=state, quantity=quantity).largest
    return None if row is None else row.value


def _first_frequency(rows: Rows) -> float | None:
    """Return the first natural frequency of a model in Hz."""
    return next((row.value for row in rows.where(state=INITIAL, quantity="frequency")), None)


def _travel_and_periods(
    data: xr.Dataset, names: Sequence[str]
) -> tuple[Sequence[float | None], Sequence[float | None]]:
    """Return the travel of the tip in m and the period of its motion in s, for each model."""
    # Static results alone have no motion of the tip.
    if "tip" not in data:
        return [], []
    tips = [data["tip"].sel(model=name).values for name in names]
    time = np.asarray(data["time"].values, dtype=float)
    # Direction in which the tip moves most.
    main = data[tip_directions(data)[0]]
    means = (mean_period(time, main.sel(model=name).values) for name in names)
    travel = [farthest(x - x[0]) if x[0] else None for x in tips]
    return travel, [period if np.isfinite(period) else None for period in means]


def _dynamic_tip(rows: Rows) -> str | None:
    row = rows.where(state=MOTION, quantity="tip").largest
    return None if row is None else f"{_milli(row.value)}{times(rows, row)}"


def _largest(several: Rows, rows: Rows, at: bool) -> str | None:
    """Return the largest of several rows of a model in the displayed unit, as text."""
    if (row := several.largest) is None:
        return None
    largest = number(row.of.factor * abs(row.value), 4)
    return f"{largest}{times(rows, row)}" + (f"\nat {place(row)}" if at else "")


def _pad(pad: Row, rows: Rows) -> str:
    """Return force, pressure and place of a pad as text."""
    forces = rows.where(state=pad.state, quantity="pad_force", part=pad.part, place=pad.place)
    force, pressure = (amount_of(row.of, row.value) for row in (*forces, pad))
    return f"{force}\n{pressure}{_used(pad, 'allowable')}\n{place(pad)}"


def _stress(most: Row) -> str:
    stress = number(TO_MEGA * abs(most.value))
    return f"{stress}{_used(most, 'yield')}\n{most.part}, x = {most.x:.1f} m"


def _buckling(results: Results, model: str) -> str | None:
    """Return a text on the lowest buckling factor of walls, by the shell or by panel formulas."""
    design = results.summary.design.models[model]
    shells = [
        (buckling.factors[0], buckling.segment) for buckling in design.buckling if buckling.factors
    ]
    panels = [
        (row.value, f"{row.part}, panel formulas")
        for row in weakest_panels(results.rows.where(model=model)).values()
    ]
    lowest = min(shells or panels, default=None)
    return lowest and f"{number(lowest[0])} ({lowest[1]})"


def _used(row: Row, limit: str) -> str:
    """Return a utilisation as text."""
    if (part := row.utilisation) is None:
        return ""
    return f", {percent(part)}" + (f"\nbeyond {limit}" if part > 1.0 else "")


def _notes(results: Results, rows: Mapping[str, Sequence[str]]) -> Iterator[str]:
    """Yield notes that explain the table's numbers."""
    models = sorted(
        (model for model in results.completed_models if model.name in results.main_models),
        key=lambda model: results.main_models.index(model.name),
    )
    described = (
        f"{model.name}: "
        + ", ".join(part for part in (model.kind, model.describe()) if part != model.name)
        + (", without play" if model.bonded else "")
        for model in models
    )
    yield f"{'; '.join(described)}."
    yield "Tip: deflection perpendicular to the axis of the unloaded boom."
    yield "Maximum load: the largest result of the static states at all extremes of the loads."
    if not all(joint.bonded for joint in results.boom.joints):
        yield (
            "Station: place x where two segments may touch. A pad at the end of the overlap has "
            "its centre half a pad length inside the overlap."
        )
    yield from filter(None, [release_note(results.case), rigid_wall_note(models, results.boom)])
    if any(what.startswith("Tip travel") for what in rows):
        yield "Tip travel: largest displacement of the tip from its position at t = 0."
    if any("×" in cell for cells in rows.values() for cell in cells):
        extended = ", at any extension" if results.case.driven_segments else ""
        yield f"φ (×): maximum in motion over the static value under the maximum load{extended}."
        if any(joint.friction for joint in results.case.joints):
            yield "Static values leave friction out: friction may keep φ below 1."
    if "Residual vibration of the tip, mm" in rows:
        yield (
            "Residual vibration: amplitude about the static deflection; with drives at rest: in "
            "their initial and final positions."
        )
    if "Contact force, maximum, kN" in rows:
        yield (
            "Contact force: maximum of the means over an output step; use it to size pads and "
            "walls. The peaks of impacts in the table of models last microseconds."
        )
    if "Period of the motion (time history), s" in rows:
        yield "Period: mean time between the main peaks of the tip, with the effect of play."
    if "Decay time to 10 %, s" in rows:
        ratio = percent(results.case.damping.modal)
        yield f"Decay time: until 10 % of the amplitude is left, with a damping ratio of {ratio}."
    if "Governing pad: force, pressure, utilisation" in rows:
        pads = [pad for joint in results.case.joints for pad in (joint.pad, *joint.pads) if pad]
        bears = _span(pad.allowable_pressure for pad in pads)
        yield (
            "Pad: largest force on one pad of a pair during the motion, and its mean pressure"
            f"{bears and f'; %: of the allowable {bears}'}."
        )
    strengths = _span(segment.yield_strength for segment in results.boom.segments)
    if strengths:
        yield f"Stresses: % of the yield strength, {strengths}."
    if "Local plate stress, maximum (utilisation), MPa" in rows:
        yield (
            "Local plate stress: von Mises stress with plate bending, averaged over half the width "
            f"of a wall. Places: within {BAND:g} m along x of stations, supports, lugs and loads."
        )
    shells = {name: model.stress for name, model in results.summary.models.items() if model.stress}
    if shells:
        most = [
            f"{number(TO_MEGA * shell.von_mises)} MPa in {name}" for name, shell in shells.items()
        ]
        yield (
            f"Stresses of single elements are larger ({join_words(most)}), but they grow with mesh "
            "refinement and are no design values."
        )


def _span(values: Iterable[float | None]) -> str:
    """Return the minimum and maximum in MPa as text; empty without values."""
    millions = sorted({TO_MEGA * value for value in values if value is not None})
    return (
        f"{' to '.join(map(number, dict.fromkeys((millions[0], millions[-1]))))} MPa"
        if millions
        else ""
    )


def _vibration(results: ModelDesignResults) -> str | None:
    """Return the residual vibration, and the vibration with drives at rest, as text."""
    if (vibration := results.residual_vibration) is None:
        return None
    static = f"{_milli(vibration.initial)}, {_milli(vibration.final)}"
    return f"{_milli(vibration.tip)}\n(with drives at rest\n{static})"


def _milli(deflection: float | None) -> str:
    return fixed(deflection, 1, TO_MILLI)


def limit_table(results: Results) -> Table | None:
    """Return the table of the limits of a case, with the values of the main models."""
    checks = list(results.check_limits())
    if not checks:
        return None
    columns = [
        Column("limit", [fill(str(check.limit), 28) for check in checks]),
        Column("satisfied", ["✓" if check.holds else "✗" for check in checks]),
    ]
    columns += [
        Column(name, [check.limit.format(check.values.get(name)) for check in checks])
        for name in results.main_models
    ]
    first = results.main_models[0]
    notes = [f"The tick refers to {first}; if {first} has no value, to the first model with one."]
    if any(check.combined for check in checks):
        combined = [check.combined and check.combined[1] for check in checks]
        cells = [check.limit.format(most) for check, most in zip(checks, combined, strict=True)]
        columns.append(Column("combinations", cells))
        notes.append("It refers also to the combinations that demand the proof of deflection.")
    return Table("Limits of the case", columns, notes, "limits", ["✗"])


def limit_faults(results: Results) -> Iterator[str]:
    """Yield a line with key, value and model for each limit that is exceeded."""
    for check in results.check_limits():
        if check.holds:
            continue
        what = "no model has such a result"
        if check.decisive is not None:
            name, value, limit = check.decisive
            what = f"{limit.format(value)} in {name}; the case demands {limit}"
        yield f"limits.{check.limit.quantity.name}: {what}"

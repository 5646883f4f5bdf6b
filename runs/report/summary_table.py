# SPDX-License-Identifier: LGPL-3.0-or-later
"""Summary at the top of a report: effect of play, governing results, model quality, limits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from textwrap import fill

import numpy as np

from protractile.analysis.low_pass import mean_period
from protractile.analysis.motion_results import Peak
from protractile.analysis.pads import PadLoad
from protractile.analysis.stresses import Utilisation
from protractile.geometry.typography import (
    TO_MEGA,
    TO_MILLI,
    TO_PERCENT,
    join_words,
    with_minus_signs,
)
from protractile.runs.pipeline.design_results import ModelDesignResults, PlayDifference
from protractile.runs.pipeline.load_table import release_note
from protractile.runs.pipeline.model_quality import static_deviation
from protractile.runs.pipeline.pad_walls import rigid_wall_note
from protractile.runs.pipeline.quantities import decay_time
from protractile.runs.pipeline.results import Results
from protractile.runs.report.figure_context import farthest, tip_directions
from protractile.runs.report.formatting import (
    NONE,
    amount,
    fixed,
    in_shown_unit,
    number,
    percent,
    signed_percent,
)
from protractile.runs.report.result_tables import is_negligible, times
from protractile.runs.report.tables import Column, Table
from protractile.shell_model.stress.history import BAND

# Higher utilisations are highlighted.
NEAR = 0.9


def summary_table(results: Results) -> Table | None:
    """Return the table of governing results of the main models, starting with the reference."""
    names, design = results.main_models, results.summary.design.models
    if not design:
        return None
    designs = [design[name] for name in names]
    hertz = [one.modes[0].frequency if one.modes else None for one in designs]
    # Decay by modal damping alone.
    decay_times = [decay_time(results.case.damping.modal, f) for f in hertz]
    used = [results.summary.utilisations(name) for name in names]
    walls, fibres = ([one.get(part) for one in used] for part in ("plate", "outer fibre"))
    hardest = governing_pads(results)
    pads = {name: pad_text(pad) for name, pad in hardest.items()}
    stations = [
        None if hardest else _largest(one, "contact force", at="\nat {} m") for one in designs
    ]
    data, tips, periods = results.trajectories, [], []
    # Static results alone have no motion of the tip.
    if "tip" in data:
        tips = [data["tip"].sel(model=name).values for name in names]
        time = np.asarray(data["time"].values, dtype=float)
        # Direction in which the tip moves most.
        main = data[tip_directions(data)[0]]
        means = (mean_period(time, main.sel(model=name).values) for name in names)
        periods = [period if np.isfinite(period) else None for period in means]
    damages = [one["detail"].load if "detail" in one else None for one in used]
    at_start, at_most, extended = (
        [max((rest.tip for rest in rests), key=abs, default=None) for rests in several]
        for several in (
            [one.static[:1] for one in designs],
            [one.static if len(one.static) > 1 else [] for one in designs],
            [one.static_extended for one in designs],
        )
    )
    aside = [
        max((s.tip_lateral or 0.0 for s in one.static), key=abs, default=0.0) for one in designs
    ]
    tip_peaks = [largest_peak(one, "deflection") for one in designs]
    dynamic = [
        _milli(farthest(tip)) + (times(peak) if peak else "")
        for tip, peak in zip(tips, tip_peaks, strict=False)
    ]
    travel = [farthest(x - x[0]) if x[0] else None for x in tips]
    bending, plates = ([one and _stress(one) for one in several] for several in (fibres, walls))
    z, lateral = ", vertical (z)" if results.boom.spatial else "", "Static lateral tip deflection"
    rows_of_models = (
        Column("Static tip deflection (t = 0)", at_start, ".1f", "mm"),
        Column("Static tip deflection (maximum load)", at_most, ".1f", "mm"),
        Column("Static tip deflection (end of telescoping)", extended, ".1f", "mm"),
        Column("Maximum dynamic tip deflection (factor φ)", dynamic, unit="mm"),
        # A motion that starts undeformed is not in static equilibrium at t = 0.
        Column(f"Tip travel from t = 0{z}", travel, ".1f", "mm"),
        Column("Residual vibration of the tip", [_vibration(one) for one in designs], unit="mm"),
        Column(f"{lateral} (maximum load)", [one or None for one in aside], ".1f", "mm"),
        Column("Lateral tip deflection, maximum", _each(designs, "lateral deflection"), unit="mm"),
        Column("First natural frequency", hertz, ".3g", "Hz"),
        Column("Period of the motion (time history)", periods, ".3g", "s"),
        Column("Decay time to 10 %", decay_times, ".2g", "s"),
        Column("Governing pad: force, pressure, utilisation", [pads.get(name) for name in names]),
        Column("Contact force, maximum", stations, unit="kN"),
        Column("Cylinder force, maximum", _each(designs, "cylinder force"), unit="kN"),
        Column("Foot reaction, maximum", _each(designs, "reaction, across and along"), unit="kN"),
        Column("Bending stress, maximum (utilisation)", bending, unit="MPa"),
        Column("Local plate stress, maximum (utilisation)", plates, unit="MPa"),
        Column("Plate buckling factor, lowest (segment)", [_buckling(one) for one in designs]),
        Column("Fatigue damage (Miner)", damages, ".3g"),
    )
    rows = {column.heading.replace("\n", ", "): column.text for column in rows_of_models}
    rows = {title: cells for title, cells in rows.items() if any(cell != NONE for cell in cells)}
    columns = [Column("", list(rows))]
    columns += [Column(name, [cells[i] for cells in rows.values()]) for i, name in enumerate(names)]
    strong = [_stress(one) for one in (*walls, *fibres) if one and (one.value or 0.0) >= NEAR]
    strong += [pads[name] for name, pad in hardest.items() if (pad.utilisation or 0.0) >= NEAR]
    strong += [number(damage) for damage in damages if (damage or 0.0) >= NEAR]
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
    offs = {name: static_deviation(design[reference], design[name]) for name in loose}
    deviations = [f"{name} {signed_percent(off)}" for name, off in offs.items() if off is not None]
    if not deviations:
        return ""
    behind = [name for name in results.summary.models if name not in results.main_models]
    shown = [one for one in results.completed_models if one.name in behind]
    others = [f"{one.name!r} ({one.kind}, {one.describe()})" for one in shown]
    more = f" Some tables and figures also show {join_words(others)}." if others else ""
    return (
        f"Deviation of the static tip deflection (maximum load) from {reference}: "
        f"{', '.join(deviations)}.{more}"
    )


def play_effect(results: Results) -> str:
    """Return a sentence on the effect of play in the reference model; empty without play."""
    effect = results.play
    if effect is None:
        return ""
    by_kind: dict[str, list[PlayDifference]] = {}
    for each in effect.numbers:
        by_kind.setdefault(each.what, []).append(each)
    first = {what: max(several, key=lambda one: one.with_play) for what, several in by_kind.items()}
    kinds = [(_PHRASES[what], one) for what, one in first.items() if what in _PHRASES]
    changed = [(what, one) for what, one in kinds if not is_negligible(one)]
    more = [f"{_change(one)} to {what}" for what, one in changed if one.increase > 0.0]
    less = [f"{what} by {_change(one)}" for what, one in changed if one.increase <= 0.0]
    same = [what for what, one in kinds if is_negligible(one)]
    parts = [(more, "adds"), (less, "reduces"), (same, "hardly changes")]
    sentences = [f"Play {verb} {join_words(several)}." for several, verb in parts if several]
    frequency = first.get("first frequency")
    if frequency is not None and frequency.bonded and not is_negligible(frequency):
        # Play itself, which opens contacts, has no part in this frequency.
        sentences.append(
            f"First natural frequency: {amount(frequency.with_play, 'Hz')} with joints in contact, "
            f"{amount(frequency.bonded, 'Hz')} with bonded joints."
        )
    return " ".join(sentences)


def utilisation_verdict(results: Results, model: str | None = None) -> str:
    """Return a text on the utilisations of a model, by default the first main model.

    The governing utilisation comes first. Without strengths, allowable pressures and detail
    categories the text is empty.
    """
    model = model or results.main_models[0]
    governing = [
        one for one in results.summary.utilisations(model).values() if one.value is not None
    ]
    if not governing:
        return ""
    governing.sort(key=lambda one: one.value or 0.0, reverse=True)
    used = "; ".join(map(str, governing))
    steels = [one.name for one in results.boom.segments if one.yield_strength is None]
    loaded = (pad for pad in results.summary.pads if pad.model == model and pad.force > 0.0)
    pads = {pad.inner: None for pad in loaded if pad.utilisation is None}
    missing = {"yield strength is given of": steels, "allowable pressure is given of pads of": pads}
    more = "".join(f" No {what} {join_words([*of])}." for what, of in missing.items() if of)
    return f"In this run, without safety factors, the utilisation is {used}.{more}"


_PHRASES = {
    "deflection at rest": "the static tip deflection (maximum load)",
    "deflection": "the maximum dynamic tip deflection",
    "stress": "the maximum bending stress",
}


def _change(one: PlayDifference) -> str:
    share = (
        "" if one.share is None else f" ({with_minus_signs(f'{TO_PERCENT * one.share:+.0f}')} %)"
    )
    return f"{amount(abs(one.increase), one.unit)}{share}"


def governing_pads(results: Results) -> dict[str, PadLoad]:
    """Return, for each model, the pad with the highest utilisation, or pressure if unknown."""
    pads = results.summary.pads[::-1]
    pads = sorted(pads, key=lambda pad: (pad.utilisation or 0.0, pad.pressure))
    return {pad.model: pad for pad in pads}


def pad_text(pad: PadLoad) -> str:
    """Return force, pressure and position of a pad as text."""
    used = _used(pad.utilisation, "allowable")
    force, pressure = amount(pad.force, "N"), amount(pad.pressure, "Pa")
    return f"{force}\n{pressure}{used}\n{pad.inner} {_FACES[pad.side]}, x = {pad.x:g} m"


_FACES = {"above": "top", "below": "bottom", "left": "left", "right": "right"}


def _stress(most: Utilisation) -> str:
    stress = number(TO_MEGA * most.load)
    return f"{stress}{_used(most.value, 'yield')}\n{most.segment}, x = {most.x:.1f} m"


def _buckling(results: ModelDesignResults) -> str | None:
    """Return a text on the lowest buckling factor of walls, by the shell or by panel formulas."""
    shells = [(one.factors[0], one.segment) for one in results.buckling if one.factors]
    panels = [(one.factor, f"{one.segment}, panel formulas") for one in results.panels]
    lowest = min(shells or panels, default=None)
    return lowest and f"{number(lowest[0])} ({lowest[1]})"


def _used(part: float | None, limit: str) -> str:
    """Return a utilisation as text."""
    if part is None:
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
    if any(title.startswith("Tip travel") for title in rows):
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
    strengths = _span(one.yield_strength for one in results.boom.segments)
    if strengths:
        yield f"Stresses: % of the yield strength, {strengths}."
    if "Local plate stress, maximum (utilisation), MPa" in rows:
        yield (
            "Local plate stress: von Mises stress with plate bending, averaged over half the width "
            f"of a wall. Places: within {BAND:g} m along x of stations, supports, lugs and loads."
        )
    shells = {name: one.stress for name, one in results.summary.models.items() if one.stress}
    if shells:
        most = [f"{amount(one.von_mises, 'Pa')} in {name}" for name, one in shells.items()]
        yield (
            f"Stresses of single elements are larger ({join_words(most)}), but they grow with mesh "
            "refinement and are no design values. A note below the table of section forces of "
            "walls gives their places."
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


def _each(results: Sequence[ModelDesignResults], what: str) -> list[str | None]:
    return [_largest(one, what) for one in results]


def _largest(results: ModelDesignResults, what: str, at: str = "") -> str | None:
    """Return the largest peak of a quantity in kN or mm, with its position, as text."""
    if (peak := largest_peak(results, what)) is None:
        return None
    largest = number(in_shown_unit(peak.largest, peak.unit), 4)
    return f"{largest}{times(peak)}{at.format(peak.where)}"


def largest_peak(results: ModelDesignResults, what: str) -> Peak | None:
    peaks = [peak for peak in results.motion.peaks if peak.what == what] if results.motion else []
    return max(peaks, key=lambda one: one.largest, default=None)


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
    notes = [
        f"The tick refers to {first}; if {first} has no value, to the first model with one. "
        "`protractile prove` checks the combinations against these limits."
    ]
    return Table("Limits of the case", columns, notes, "limits", ["✗"])


def limit_faults(results: Results) -> Iterator[str]:
    """Yield a line with key, value and model for each limit that is exceeded."""
    for check in results.check_limits():
        if check.holds:
            continue
        what = "no model has such a result"
        if check.decisive is not None:
            model, value = check.decisive
            what = f"{check.limit.format(value)} in {model}; the case demands {check.limit}"
        yield f"limits.{check.limit.quantity.name}: {what}"

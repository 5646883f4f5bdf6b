# SPDX-License-Identifier: LGPL-3.0-or-later
"""The statements of the paper, each judged by a rule on trajectories.

The frictionless system is chaotic: a relative change of the load of 1e-9 grows to about 1 % of
the tip's range within a second. So one trajectory decides what happens up to the first peak;
beyond it a difference is a sample, and a rule asks how many members of an ensemble show it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from itertools import combinations, pairwise
from typing import Any, Literal

import numpy as np
import numpy.typing as npt
import xarray as xr

from runs.parting import apart_at_the_end, peaks_apart
from runs.questions import Lacking, Run, options, tied
from runs.schema import Case, KantorovichTable, Model

Array = npt.NDArray[np.float64]
Judgement = Literal["reproduced", "contradicted", "undecided"]

STATEMENTS = {
    "S1": "Four and five terms of the series coincide until the first collision.",
    "S2": "At the end of the interval they are more than 20 % apart.",
    "S3": "At the tip all models with play conform for six seconds, then stratify.",
    "S4": "The deflection grows with the complication of the model: four terms, five terms, "
    "beam elements, shell.",
    "S5": "Play changes the motion fundamentally.",
    "S6": "At the head relative differences are greater than at the tip, absolute ones of the "
    "same level.",
    "S7": "With friction the models conform for six seconds, then stratify somewhat; the "
    "play-free one deviates considerably.",
    "S8": "With friction the finite element solution is stable for 7 s only, at 4375 steps.",
    "S9": "The collision model has no clear influence on the deflection.",
    "S10": "The series needs at most 2000 integration steps, beam elements more than 4000.",
    "S11": "The description extends to more than two segments, with two more equations per segment "
    "and plane.",
}

# S1. The integration of both series differs by round-off alone: about 1e-14 of the range.
COINCIDENCE = 1.0e-6
# S2. In the statement.
DIVERGENCE = 0.20
# S3. In the statement, in s.
CONFORMITY = 6.0
# S2, S3. The paper shows one run: what it shows is typical if most members show it.
MOST = 0.5
# S2, S10. The paper's shortest interval in s: its friction example ended there for want of
# stability, and its frictionless curves part visibly after six seconds.
INTERVAL = 7.0
# S4. A relative load change of 1e-4, or another step, moves a first tip peak by up to 0.5 %.
PEAK_SCATTER = 0.005
# S5. From here on play adds more than the whole deflection that there is without it.
FUNDAMENTAL = 2.0
# S6. Equal relative differences would make the absolute ones differ like the ranges, whose ratio
# is about 10 for this boom; up to half of that they are taken as of one level. Chaos moves the
# largest differences up to the first peak by about a tenth.
SAME_LEVEL = 5.0
LEVEL_SCATTER = 0.1
# S9. Less than what the models of S4 are apart, which the paper calls minor.
CLEAR_INFLUENCE = 0.05
# S10. In the statement.
SERIES_STEPS = 2000
# S11. More than two.
SEGMENTS = 3


@dataclass(frozen=True, slots=True)
class Verdict:
    """One statement, judged.

    Args:
        id: S1 … S11.
        statement: what the paper says.
        measured: the number that the rule looks at, None where there is none.
        threshold: what it is held against.
        unit: of both; empty where there is none.
        verdict: what the rule says.
        why: what was compared, and what the number can and cannot decide.
    """

    id: str
    statement: str
    measured: float | None
    threshold: float | None
    unit: str
    verdict: Judgement
    why: str


@dataclass(frozen=True, slots=True)
class Finding:
    """What a rule leaves; the fields are those of :class:`Verdict`."""

    verdict: Judgement
    why: str
    measured: float | None = None
    threshold: float | None = None
    unit: str = ""


def judge(
    trajectories: xr.Dataset,
    summary: Mapping[str, Any],
    case: Case,
    ensembles: xr.Dataset | None = None,
) -> list[Verdict]:
    """Judge S1 … S11 on one run.

    Args:
        trajectories: dims ``model``, ``time``, ``station``; ``tip`` and ``head`` in m.
        summary: per model ``first_peak``, ``first_contact``, ``steps``, ``contact_changes``.
        case: which model is which.
        ensembles: dims ``model``, ``member``, ``time``; ``tip`` in m.
    """
    run = Run(trajectories, summary, case, ensembles)
    return [
        Verdict(id=key, statement=statement, **asdict(_find(RULES[key], run)))
        for key, statement in STATEMENTS.items()
    ]


def _s1(run: Run) -> Finding:
    """Measure: largest difference of both tips before the earlier first contact, as a part of
    the five-term tip's range. Threshold: 1e-6. Both have the same outer functions and a rigid
    inner motion until then, so only round-off may part them; nothing has grown chaotic yet.
    """
    four, five = run.four_terms(), run.five_terms()
    first = min(run.number(model, "first_contact") for model in (four, five))
    before = run.time <= first
    curve = run.curve(five)
    measured = float(np.abs(run.curve(four) - curve)[before].max() / _range(curve))
    return Finding(
        "reproduced" if measured <= COINCIDENCE else "contradicted",
        f"Largest difference of the tips before the first contact at {first:.4f} s.",
        measured,
        COINCIDENCE,
        "of the range",
    )


def _s2(run: Run) -> Finding:
    """Measure: share of the members whose tips differ, at some time of the last second, by more
    than 0.20 of the larger range, the statement's number. Threshold: half of them, so that the
    run that the paper shows is a typical one. The run must be as long as the paper's interval.
    """
    run.last_until(INTERVAL)
    four, five = run.members(run.four_terms(), run.five_terms())
    apart = apart_at_the_end(four, five, run.time >= run.time[-1] - 1.0)
    share, doubt = _share(apart > DIVERGENCE)
    return Finding(
        _above(share, MOST, doubt),
        f"Members of {apart.size} whose tips are more than {100.0 * DIVERGENCE:g} % of the range "
        f"apart in the last second: from {100.0 * apart.min():.0f} to {100.0 * apart.max():.0f} %, "
        f"{100.0 * np.median(apart):.0f} % in the middle.",
        share,
        MOST,
        "of the members",
    )


def _s3(run: Run) -> Finding:
    """Measure: share of the members that conform for six seconds and, of the same, the share that
    stratify after them. Threshold: half of them each. Conformity is of the slow motion: every
    peak of all models with play within 0.20 of one another, the part that the paper itself calls
    a divergence (S2), in time as a part of the period and in height. One peak further apart
    after six seconds is a stratification. Pointwise nothing could be asked: the run that the
    paper shows is beyond its horizon long before.
    """
    run.last_until(CONFORMITY)
    models = run.with_play()
    curves = run.members(*models).swapaxes(0, 1)
    cutoff = run.summary["ensemble"]["slow_below"]
    if cutoff is None:
        raise Lacking("The run is too coarsely reported for a slow motion.")
    found = [peaks_apart(member, run.time, cutoff) for member in curves]
    if not all((time <= CONFORMITY).any() for time, _ in found):
        raise Lacking(f"Not all members have a peak within {CONFORMITY:g} s.")
    if not all((time > CONFORMITY).any() for time, _ in found):
        raise Lacking(f"Not all members have a peak after {CONFORMITY:g} s.")
    early = np.array([apart[time <= CONFORMITY].max() for time, apart in found])
    late = np.array([apart[time > CONFORMITY].max() for time, apart in found])
    conform, doubt = _share(early <= DIVERGENCE)
    stratify, _ = _share(late > DIVERGENCE)
    parting = [float(time[apart > DIVERGENCE].min(initial=np.inf)) for time, apart in found]
    middle = sorted(parting)[len(parting) // 2]
    return Finding(
        _all_of(_above(conform, MOST, doubt), _above(stratify, MOST, doubt)),
        f"Members of {len(found)} whose slow peaks conform for {CONFORMITY:g} s, within "
        f"{100.0 * DIVERGENCE:g} % in all models; {100.0 * stratify:.0f} % have peaks further "
        f"apart later. {_half_part(middle)} {_horizons(run, models)}",
        conform,
        MOST,
        "of the members",
    )


def _s4(run: Run) -> Finding:
    """Measure: smallest rise of the first tip peak from one model to the next, in percent.
    Threshold: 0.5 %, by which a small change of load or step moves one such peak. A larger
    rise each time reproduces, a fall of more than that contradicts, anything between is chance.
    """
    models = [run.four_terms(), run.five_terms(), run.beam_elements(), run.shell()]
    peaks = [run.first_peak(model) for model in models]
    rises = [after / before - 1.0 for before, after in pairwise(peaks)]
    smallest = min(rises)
    least = int(np.argmin(rises))
    listed = ", ".join(f"{1e3 * peak:.1f}" for peak in peaks)
    return Finding(
        _above(smallest, 0.0, PEAK_SCATTER),
        f"First tip peaks {listed} mm. The smallest rise is from {models[least].name!r} to "
        f"{models[least + 1].name!r}; a small change of load or step moves a first peak by up to "
        f"{100.0 * PEAK_SCATTER:g} %.",
        100.0 * smallest,
        100.0 * PEAK_SCATTER,
        "%",
    )


def _s5(run: Run) -> Finding:
    """Measure: smallest ratio of a first tip peak with play to the one without. Threshold: 2,
    where play adds as much again as the whole play-free deflection; the models with play are
    within a tenth of one another. First peaks scatter by 0.5 % only.
    """
    without = run.first_peak(run.play_free())
    models = [model for model in run.case.models if not tied(model)]
    if not models:
        raise Lacking("The case has no model with play.")
    ratio, name = min((run.first_peak(model) / without, model.name) for model in models)
    return Finding(
        _above(ratio, FUNDAMENTAL, FUNDAMENTAL * PEAK_SCATTER),
        f"First tip peak with play over the {1e3 * without:.1f} mm without; the smallest is that "
        f"of {name!r}.",
        ratio,
        FUNDAMENTAL,
        "times",
    )


def _s6(run: Run) -> Finding:
    """Measure: largest pointwise difference of any two models at the tip over that at the head,
    up to the first tip peak. Beyond it chaos and the phase of the slow motion, not the models,
    set the differences. Threshold: 5, half of the ratio of the ranges, at which relative
    differences would be equal. Reproduced if the ratio is within it either way and the
    difference relative to the place's own range is greater at the head.
    """
    models = run.with_play()
    end = min(run.number(model, "first_peak", "tip", 0) for model in models)
    until = run.time <= end
    apart, relative = {}, {}
    for place in ("tip", "head"):
        curves = np.array([run.curve(model, place)[until] for model in models])
        apart[place] = float(np.ptp(curves, axis=0).max())
        relative[place] = apart[place] / max(map(_range, curves))
    if min(apart.values()) == 0.0:
        raise Lacking("The models do not differ up to the first peak.")
    ratio = apart["tip"] / apart["head"]
    level = _above(SAME_LEVEL, max(ratio, 1.0 / ratio), LEVEL_SCATTER * SAME_LEVEL)
    greater = _above(relative["head"], relative["tip"], LEVEL_SCATTER * relative["tip"])
    shares = {place: f"{100.0 * part:.0f} %" for place, part in relative.items()}
    return Finding(
        _all_of(level, greater),
        f"Largest difference up to the first peak at {end:.2f} s: {1e3 * apart['tip']:.1f} mm at "
        f"the tip, {1e3 * apart['head']:.1f} mm at the head, which is {shares['tip']} and "
        f"{shares['head']} of the ranges there.",
        ratio,
        SAME_LEVEL,
        "times",
    )


def _with_friction(run: Run) -> Finding:
    """S7 and S8 are about the example with friction, which is a case of its own."""
    raise Lacking("This case has no friction; it takes the case with friction.")


def _s9(run: Run) -> Finding:
    """Measure: largest relative difference of first tip peaks between models that differ in
    their contact law alone, with another exponent n. Threshold: 5 %, less than what the models
    of S4 are apart. The stiffness may differ too, since its unit depends on n.
    """
    untied = [model for model in run.case.models if not tied(model)]
    differences = [
        (abs(run.first_peak(a) / run.first_peak(b) - 1.0), a.name, b.name)
        for a, b in combinations(untied, 2)
        if options(a, "contact", "step") == options(b, "contact", "step")
        and _exponents(run.case, a) != _exponents(run.case, b)
    ]
    if not differences:
        raise Lacking("No two models of the case differ in the contact law alone.")
    measured, a, b = max(differences)
    return Finding(
        _above(CLEAR_INFLUENCE, measured, PEAK_SCATTER),
        f"Difference of the first tip peaks of {a!r} and {b!r}, whose exponents differ.",
        100.0 * measured,
        100.0 * CLEAR_INFLUENCE,
        "%",
    )


def _s10(run: Run) -> Finding:
    """Measure: steps of this run, the larger of both series. Threshold: 2000. Fewer here show
    that so few are enough. More do not show that they are needed: the paper's solver adapted
    its steps to the curve, and the splitting to the energy of each contact. But each opening or
    closing of a contact takes a step of its own, whatever the solver; more than 2000 of them in
    the seven seconds that the paper's interval has at least would contradict.
    """
    series = [run.four_terms(), run.five_terms()]
    steps = max(run.number(model, "steps") for model in series)
    interval = min(INTERVAL, run.time[-1])
    changes = max(run.number(model, "contact_changes") for model in series)
    changes *= interval / run.time[-1]
    why = (
        f"Contacts open or close about {changes:.0f} times in {interval:g} s, and each time takes "
        f"a step of any solver, which leaves {SERIES_STEPS}"
    )
    if steps <= SERIES_STEPS:
        return Finding("reproduced", "This run needed no more.", steps, SERIES_STEPS, "steps")
    if changes > SERIES_STEPS:
        return Finding("contradicted", f"{why} too few.", steps, SERIES_STEPS, "steps")
    why = (
        "The step here resolves every contact with its energy, the paper's was adapted to the "
        f"curve: not to be compared. {why} possible."
    )
    return Finding("undecided", why, steps, SERIES_STEPS, "steps")


def _s11(run: Run) -> Finding:
    """Measure: segments of the boom. Threshold: 3. Reproduced where series of a boom of that
    many segments ran to the end, which they do with their energy in bound or not at all.
    """
    count = len(run.case.segments)
    if count < SEGMENTS:
        raise Lacking(f"This case has {count} segments; it takes the case of three segments.")
    model = run.one("kantorovich", lambda model: isinstance(model, KantorovichTable))
    run.curve(model)
    return Finding(
        "reproduced",
        f"{model.name!r} ran to the end, with an energy residual of "
        f"{run.number(model, 'energy_residual'):.1e}.",
        count,
        SEGMENTS,
        "segments",
    )


RULES: Mapping[str, Callable[[Run], Finding]] = {
    "S1": _s1,
    "S2": _s2,
    "S3": _s3,
    "S4": _s4,
    "S5": _s5,
    "S6": _s6,
    "S7": _with_friction,
    "S8": _with_friction,
    "S9": _s9,
    "S10": _s10,
    "S11": _s11,
}


def _find(rule: Callable[[Run], Finding], run: Run) -> Finding:
    try:
        return rule(run)
    except Lacking as lacking:
        return Finding("undecided", str(lacking))


def _above(value: float, threshold: float, doubt: float) -> Judgement:
    """Whether a value is above a threshold, where both are known to within ``doubt``."""
    if abs(value - threshold) <= doubt:
        return "undecided"
    return "reproduced" if value > threshold else "contradicted"


def _share(shows: npt.NDArray[np.bool_]) -> tuple[float, float]:
    """Share of members that show something, and twice its standard error at one half."""
    return float(shows.mean()), 1.0 / float(np.sqrt(shows.size))


def _half_part(middle: float) -> str:
    """When the models of the middle member part, infinite if they do not."""
    if not np.isfinite(middle):
        return "In most members no peaks are further apart."
    return f"In half of them the first such peak is at {middle:.1f} s or before."


def _horizons(run: Run, models: list[Model]) -> str:
    """From when on a single run of each model is a sample."""
    known = [
        run.summary["models"][model.name]["ensemble"]["horizons"][f"{DIVERGENCE:g}"]
        for model in models
    ]
    times = [time for time in known if time is not None]
    if not times:
        return "The members of each model stay together."
    return (
        f"Members of one model part by {100.0 * DIVERGENCE:g} % of the range from "
        f"{min(times):.1f} s on."
    )


def _all_of(*parts: Judgement) -> Judgement:
    """One part contradicted contradicts the whole; it takes all to reproduce."""
    if "contradicted" in parts:
        return "contradicted"
    return "undecided" if "undecided" in parts else "reproduced"


def _range(curve: Array) -> float:
    span = float(np.ptp(curve))
    if span == 0.0:
        raise Lacking("Nothing moves.")
    return span


def _exponents(case: Case, model: Model) -> tuple[float, ...]:
    """n of each joint, as the model sees it."""
    return tuple((model.contact or joint).exponent for joint in case.joints)

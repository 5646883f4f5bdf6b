# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rules that judge each statement of the paper on trajectories.

The frictionless system is chaotic: a relative change of the load of 1e-9 grows to about 1 % of
the range of the tip within a second. So single trajectories are compared only up to the first peak.
For later times a rule counts the members of an ensemble that show a difference.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import combinations, pairwise

import numpy as np
from scipy.special import stdtrit

from geometry.arrays import Array, Mask
from runs.case.kinds.kantorovich import Kantorovich
from runs.case.kinds.model import select_kind
from runs.case.schema import Model
from runs.paper.run_query import MissingData, RunQuery, apart_at_the_end, options, peaks_apart
from runs.paper.statements import STATEMENTS
from runs.paper.verdicts import Judgement, Verdict
from runs.pipeline.results import Results

# S1. Both series differ by round-off only: about 1e-14 of the range.
COINCIDENCE = 1.0e-6
# S2. The number in the statement.
DIVERGENCE = 0.20
# S3. The time in the statement, in s.
CONFORMITY = 6.0
# S3. The run in the paper is typical if most members agree with it.
MOST = 0.5
# S2. Confidence of the mean of an ensemble, whose members are samples of a chaotic motion.
CONFIDENCE = 0.95
# S2, S7, S8. The paper's shortest interval in s: its friction example became unstable there, and
# its frictionless curves diverge visibly after six seconds.
INTERVAL = 7.0
# S4. A relative load change of 1e-4, or another step, moves a first tip peak by up to 0.5 %.
PEAK_SCATTER = 0.005
# S5. From here on play adds more than the whole deflection without play.
FUNDAMENTAL = 2.0
# S6. With equal relative differences, the absolute ones would differ like the ranges, whose ratio
# is about 10 for this boom. Up to half of this ratio, the absolute differences count as equal.
# Chaos changes the largest differences up to the first peak by about a tenth.
SAME_LEVEL = 5.0
LEVEL_SCATTER = 0.1
# S9. The paper calls the differences between the models of S4 minor; they are larger than this.
CLEAR_INFLUENCE = 0.05
# S10. The number in the statement.
SERIES_STEPS = 2000
ELEMENT_STEPS = 4000
# S11. More than two.
SEGMENTS = 3


@dataclass(frozen=True, slots=True)
class Finding:
    """Result of a rule, with fields of :class:`runs.paper.verdicts.Verdict`."""

    verdict: Judgement
    why: str
    measured: float | None = None
    threshold: float | None = None
    unit: str = ""


def judge(results: Results) -> list[Verdict]:
    """Return the verdicts that the case of a run requests or demands."""
    case = results.case
    run = RunQuery(results)
    return [
        Verdict(
            id=key,
            statement=statement,
            **asdict(_find(RULES[key], run)),
            demanded=key in case.demand,
        )
        for key, statement in STATEMENTS.items()
        if key in case.statements + case.demand
    ]


def _s1(run: RunQuery) -> Finding:
    """Measure: largest difference of both tips before the earlier first contact, as a part of
    the five-term tip's range. Threshold: 1e-6. Until then both have the same outer functions and a
    rigid inner motion. So they differ only by round-off, which chaos has not amplified yet.
    """
    run.without_friction()
    four, five = run.four_terms(), run.five_terms()
    first = min(run.first_contact(model) for model in (four, five))
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


def _s2(run: RunQuery) -> Finding:
    """Measure: largest difference of the tips in the last second, as a fraction of the larger
    range, averaged over the members. Threshold: 0.20, the statement's number. The mean has a 95 %
    confidence interval over the members; the run in the paper is one sample of their chaotic
    motions. The run must be as long as the paper's interval.
    """
    run.without_friction()
    run.last_until(INTERVAL)
    four, five = run.members(run.four_terms(), run.five_terms())
    apart = apart_at_the_end(four, five, run.time >= run.time[-1] - 1.0)
    mean, margin = _mean(apart)
    return Finding(
        _above(mean, DIVERGENCE, margin),
        f"Largest difference of the tips in the last second, in the mean of {apart.size} members, "
        f"which is known to within {margin:.2f}; from {apart.min():.2f} to {apart.max():.2f} in "
        f"single ones, above {DIVERGENCE:g} in {100.0 * (apart > DIVERGENCE).mean():.0f} %.",
        mean,
        DIVERGENCE,
        "of the range",
    )


def _s3(run: RunQuery) -> Finding:
    """Measure: share of the members that conform for six seconds, and share of the members that
    stratify later. Threshold: one half for both shares, so that the paper's figure is typical.

    Slow motions conform if every peak of all models with play is within 0.20 of the others, in
    height and, as a fraction of the period, in time. The paper itself calls 0.20 a divergence (S2).
    A peak that only some models have has an infinite distance. One peak beyond 0.20 after six
    seconds is a stratification. A member without peaks before or after six seconds is not counted
    there. A pointwise comparison is impossible: six seconds are far beyond the horizon of a single
    run.
    """
    run.without_friction()
    run.last_until(CONFORMITY)
    models = run.with_play()
    curves = run.members(*models).swapaxes(0, 1)
    cutoff = run.slow_below()
    distances = [peaks_apart(member, run.time, cutoff) for member in curves]
    early = [
        apart[time <= CONFORMITY].max()
        for time, apart in distances
        if time.min(initial=np.inf) <= CONFORMITY
    ]
    late = [
        apart[time > CONFORMITY].max()
        for time, apart in distances
        if time.max(initial=0.0) > CONFORMITY
    ]
    if not early:
        raise MissingData(f"No member has a peak within {CONFORMITY:g} s.")
    if not late:
        raise MissingData(f"No member has a peak after {CONFORMITY:g} s.")
    conform, conform_margin = _share(np.array(early) <= DIVERGENCE)
    stratify, stratify_margin = _share(np.array(late) > DIVERGENCE)
    divergence = [float(time[apart > DIVERGENCE].min(initial=np.inf)) for time, apart in distances]
    middle = sorted(divergence)[len(divergence) // 2]
    return Finding(
        _all_of(_above(conform, MOST, conform_margin), _above(stratify, MOST, stratify_margin)),
        f"Members of {len(early)} whose slow peaks conform for {CONFORMITY:g} s, within "
        f"{100.0 * DIVERGENCE:g} % in all models; {100.0 * stratify:.0f} % of {len(late)} have "
        f"peaks further apart later. {_half_part(middle)} {_horizons(run, models)}",
        conform,
        MOST,
        "of the members",
    )


def _s4(run: RunQuery) -> Finding:
    """Measure: smallest rise of the first tip peak from one model to the next, in percent.
    Threshold: 0.5 %, by which a small change of load or step moves one such peak. The statement is
    reproduced if every rise is larger, and contradicted by a fall of more than 0.5 %; results
    between are chance.
    """
    run.without_friction()
    models = [run.four_terms(), run.five_terms(), run.beam_elements(), run.shell()]
    peaks = [run.peak_height(model) for model in models]
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


def _s5(run: RunQuery) -> Finding:
    """Measure: smallest ratio of a first tip peak with play to the one without. Threshold: 2, where
    play adds as much as the whole deflection without play. The models with play differ from one
    another by less than a tenth; first peaks scatter by 0.5 % only.
    """
    run.without_friction()
    without = run.peak_height(run.bonded())
    models = [model for model in run.case.models if not model.bonded]
    if not models:
        raise MissingData("The case has no model with play.")
    ratio, name = min((run.peak_height(model) / without, model.name) for model in models)
    return Finding(
        _above(ratio, FUNDAMENTAL, FUNDAMENTAL * PEAK_SCATTER),
        f"First tip peak with play over the {1e3 * without:.1f} mm without; the smallest is in "
        f"{name!r}.",
        ratio,
        FUNDAMENTAL,
        "times",
    )


def _s6(run: RunQuery) -> Finding:
    """Measure: largest pointwise difference of any two models at the tip over that at the head,
    up to the first tip peak. Beyond it, chaos and the phase of the slow motion determine the
    differences, not the models. Threshold: 5, half of the ratio of the ranges, at which relative
    differences would be equal. The statement is reproduced if the ratio is between 1/5 and 5, and
    the difference relative to the local range is larger at the head.
    """
    run.without_friction()
    models = run.with_play()
    end = min(run.peak_time(model) for model in models)
    until = run.time <= end
    apart, relative = {}, {}
    for place in ("tip", "head"):
        curves = np.array([run.curve(model, place)[until] for model in models])
        apart[place] = float(np.ptp(curves, axis=0).max())
        relative[place] = apart[place] / max(map(_range, curves))
    if min(apart.values()) == 0.0:
        raise MissingData("The models do not differ up to the first peak.")
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


def _s7(run: RunQuery) -> Finding:
    """Measure: largest pointwise difference of any two models with play at the tip within six
    seconds, as a fraction of the largest range. Threshold: 0.20, which the paper itself calls a
    divergence (S2). The statement is reproduced if the models conform within six seconds and differ
    more afterwards, if the model without play differs more from each of them, and if the difference
    relative to the local range is larger at the head. With friction the motion is regular, so that
    one trajectory of each model decides, over its whole length.
    """
    run.with_friction()
    run.last_until(INTERVAL)
    models = run.with_play()
    early = run.time <= CONFORMITY
    apart = {place: _largest_differences(run, models, place) for place in ("tip", "head")}
    conform = float(apart["tip"][early].max())
    later = float(apart["tip"][~early].max())
    without = run.bonded()
    bonded = min(
        float(_largest_differences(run, [model, without], "tip").max()) for model in models
    )
    head = float(apart["head"].max())
    return Finding(
        _all_of(
            _above(DIVERGENCE, conform, 0.0),
            _above(later, conform, 0.0),
            _above(bonded, DIVERGENCE, 0.0),
            _above(head, max(conform, later), 0.0),
        ),
        f"Largest difference of the tips of {len(models)} models with play up to {CONFORMITY:g} s; "
        f"{later:.2f} later, {bonded:.2f} at least between one of them and the play-free one, "
        f"and {head:.2f} of the range at the head.",
        conform,
        DIVERGENCE,
        "of the range",
    )


def _s8(run: RunQuery) -> Finding:
    """Measure: time in s for which the beam elements with friction move with a bounded energy
    residual. Threshold: 7 s, beyond which the paper's solution was unstable. A longer stable run
    contradicts that the system itself is unstable. A shorter run decides nothing, since runs with
    unbounded energy are no results here.
    """
    run.with_friction()
    model = run.beam_elements()
    run.curve(model)
    run.last_until(INTERVAL)
    summary = run.summary_of(model)
    lasted = float(run.time[-1])
    return Finding(
        _above(INTERVAL, lasted, 1.0e-9 * INTERVAL),
        f"{model.name!r} moves for {lasted:g} s in {summary.steps} steps with an energy residual "
        f"of {summary.energy_residual:.1e}: what ended the paper's run after 4375 steps "
        "was its integration.",
        lasted,
        INTERVAL,
        "s",
    )


def _s9(run: RunQuery) -> Finding:
    """Measure: largest relative difference of first tip peaks between models that differ in
    their contact law alone, with another exponent n. Threshold: 5 %, less than the differences
    between the models of S4. The stiffness may differ, too, since its unit depends on n.
    """
    with_play = [model for model in run.case.models if not model.bonded]
    differences = [
        (abs(run.peak_height(a) / run.peak_height(b) - 1.0), a.name, b.name)
        for a, b in combinations(with_play, 2)
        if options(a, "contact", "step") == options(b, "contact", "step")
        and _exponents(run, a) != _exponents(run, b)
    ]
    if not differences:
        raise MissingData("No two models of the case differ in the contact law alone.")
    measured, a, b = max(differences)
    return Finding(
        _above(CLEAR_INFLUENCE, measured, PEAK_SCATTER),
        f"Difference of the first tip peaks of {a!r} and {b!r}, whose exponents differ.",
        100.0 * measured,
        100.0 * CLEAR_INFLUENCE,
        "%",
    )


def _s10(run: RunQuery) -> Finding:
    """Measure: steps that the series needs for its first three slow peaks, the larger number of
    both series: the smallest number in the trials that keeps the peaks within 1 % beyond the
    ensemble's spread. Threshold: 2000; beam elements must take more than 4000. The paper's 2000
    steps cover its whole interval, so that fewer steps for a part of it do not prove the statement.
    """
    run.without_friction()
    series = [run.four_terms(), run.five_terms()]
    needed = {model.name: run.fewest_steps(model) for model in (*series, run.beam_elements())}
    *of_series, of_elements = needed.values()
    steps = max(of_series)
    listed = ", ".join(f"{name!r} {number:.0f}" for name, number in needed.items())
    return Finding(
        _all_of(
            "reproduced" if steps <= SERIES_STEPS else "contradicted",
            "reproduced" if of_elements > ELEMENT_STEPS else "contradicted",
        ),
        f"Fewest steps that keep the first three peaks of the slow motion: {listed}.",
        steps,
        SERIES_STEPS,
        "steps",
    )


def _s11(run: RunQuery) -> Finding:
    """Measure: distance between the first tip peaks of the longest series and of beam elements, on
    a boom of three segments or more. Threshold: 20 %, the part that the paper itself calls a
    divergence (S2): the description extends to more segments if it is as near to beam elements as
    with two.
    """
    count = len(run.case.segments)
    if count < SEGMENTS:
        raise MissingData(f"This case has {count} segments; it takes the case of three segments.")
    series = max(
        select_kind(Kantorovich, run.case.models),
        key=lambda model: sum(model.terms),
        default=None,
    )
    if series is None:
        raise MissingData("The case has no series.")
    elements = run.beam_elements()
    apart = abs(run.peak_height(series) / run.peak_height(elements) - 1.0)
    return Finding(
        _above(DIVERGENCE, apart, PEAK_SCATTER),
        f"First tip peaks of {series.name!r} and {elements.name!r} on {count} segments, which take "
        f"{run.summary_of(series).modes} and {run.summary_of(elements).modes} equations.",
        100.0 * apart,
        100.0 * DIVERGENCE,
        "%",
    )


RULES: Mapping[str, Callable[[RunQuery], Finding]] = dict(
    zip(STATEMENTS, (_s1, _s2, _s3, _s4, _s5, _s6, _s7, _s8, _s9, _s10, _s11), strict=True)
)


def _find(rule: Callable[[RunQuery], Finding], run: RunQuery) -> Finding:
    try:
        return rule(run)
    except MissingData as missing:
        return Finding("undecided", str(missing))


def _above(value: float, threshold: float, margin: float) -> Judgement:
    """Return the verdict that a value is above a threshold, undecided within a margin."""
    if abs(value - threshold) <= margin:
        return "undecided"
    return "reproduced" if value > threshold else "contradicted"


def _mean(values: Array) -> tuple[float, float]:
    """Return the mean over the members, and half the width of its Student confidence interval."""
    quantile = stdtrit(values.size - 1, 0.5 + 0.5 * CONFIDENCE)
    return float(values.mean()), float(quantile * values.std(ddof=1) / np.sqrt(values.size))


def _share(shows: Mask) -> tuple[float, float]:
    """Return the fraction of true entries, and twice the standard error of a fraction of ½."""
    return float(shows.mean()), 1.0 / float(np.sqrt(shows.size))


def _largest_differences(run: RunQuery, models: Sequence[Model], place: str) -> Array:
    """Return the largest difference (num_times,) of any two models over the largest range."""
    curves = np.array([run.curve(model, place) for model in models])
    return np.asarray(np.ptp(curves, axis=0) / max(map(_range, curves)))


def _half_part(middle: float) -> str:
    """Return a sentence on the median time of divergence; it is infinite without divergence."""
    if not np.isfinite(middle):
        return "In most members no peaks are further apart."
    return f"In half of them the first such peak is at {middle:.1f} s or before."


def _horizons(run: RunQuery, models: list[Model]) -> str:
    """Return a sentence on the horizons of the models."""
    horizons = [run.horizon(model, DIVERGENCE) for model in models]
    times = [time for time in horizons if time is not None]
    if not times:
        return "The members of each model stay together."
    return (
        f"Members of one model part by {100.0 * DIVERGENCE:g} % of the range from "
        f"{min(times):.1f} s on."
    )


def _all_of(*parts: Judgement) -> Judgement:
    """Return the common verdict: contradicted if one part is, reproduced if all parts are."""
    if "contradicted" in parts:
        return "contradicted"
    return "undecided" if "undecided" in parts else "reproduced"


def _range(curve: Array) -> float:
    span = float(np.ptp(curve))
    if span == 0.0:
        raise MissingData("Nothing moves.")
    return span


def _exponents(run: RunQuery, model: Model) -> list[set[float]]:
    """Return the contact exponents n of the joints of a model."""
    joints = model.model_boom(run.results.boom).boom.joints
    return [{term.exponent for term in joint.contact.terms} for joint in joints]

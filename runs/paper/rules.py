# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rules that judge the statements of the paper on trajectories.

Without friction the system is chaotic: a relative change of the load of 1e-9 changes the tip by
about 1 % of its range within a second. Single trajectories are therefore compared only up to the
first peak. For later times rules count the members of an ensemble that show a difference.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from itertools import combinations, pairwise

import numpy as np

from protractile.geometry.arrays import Array, Mask
from protractile.runs.case.kinds.kantorovich import Kantorovich
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.schema import Model
from protractile.runs.paper.decision import DECISIVE, Excess, Finding, finding, mean_of
from protractile.runs.paper.keys import Keys
from protractile.runs.paper.run_query import (
    MissingData,
    RunQuery,
    final_differences,
    options,
    peak_distances,
)
from protractile.runs.paper.statements import STATEMENTS
from protractile.runs.paper.verdicts import Verdict
from protractile.runs.pipeline.results import Results

# S1. The two series differ by round-off only: about 1e-14 of the range.
COINCIDENCE = 1.0e-6
# S2. The number in the statement.
DIVERGENCE = 0.20
# S3. The time in the statement, in s.
CONFORMITY = 6.0
# S3. Share of the members above which the run in the paper is typical.
MOST = 0.5
# S2, S7, S8. The paper's shortest interval in s: its run with friction became unstable then, and
# its curves without friction diverge visibly after six seconds.
INTERVAL = 7.0
# S4. A relative load change of 1e-4, or another step, moves a first tip peak by up to 0.5 %, which
# counts as three standard errors.
PEAK_SCATTER = 0.005
PEAK_ERROR = PEAK_SCATTER / DECISIVE
# S5. Above this ratio, play adds more than the whole deflection without play.
FUNDAMENTAL = 2.0
# S6. With equal relative differences, the absolute differences would have the ratio of the ranges,
# about 10 for this boom. Absolute differences count as equal up to half of this ratio. Chaos
# changes the largest differences up to the first peak by about a tenth.
SAME_LEVEL = 5.0
LEVEL_ERROR = 0.1 / DECISIVE
# S9. Less than the differences between the models of S4, which the paper calls minor.
CLEAR_INFLUENCE = 0.05
# S10. The number in the statement.
SERIES_STEPS = 2000
ELEMENT_STEPS = 4000
# S10. Trials double the step. Another sample of the motion changes the fewest steps by up to half a
# doubling (study `verdicts`).
DOUBLINGS_ERROR = 0.5
# S11. The least number of segments above two.
SEGMENTS = 3


def judge(results: Results) -> list[Verdict]:
    """Return the verdicts on all statements that the case of a run names."""
    case = results.case
    assert isinstance(case, Keys)
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
    """Compare the tips of the two series before the earlier one of their first contacts.

    Measure: their largest difference over the range with five terms. Threshold: 1e-6. Until then
    the inner segment moves rigidly, and the series differ only by round-off.
    """
    run.check_friction(present=False)
    four, five = run.four_terms(), run.five_terms()
    first = min(run.first_contact(model) for model in (four, five))
    before = run.time <= first
    curve = run.curve(five)
    measured = float(np.abs(run.curve(four) - curve)[before].max() / _range(curve))
    return finding(
        [Excess(COINCIDENCE, measured)],
        f"Largest difference of the tips before the first contact at {first:.4f} s.",
        measured,
        COINCIDENCE,
        "of the range",
    )


def _s2(run: RunQuery) -> Finding:
    """Compare the tips of the two series in the last second.

    Measure: their largest difference over the larger range, in the mean of the members. Threshold:
    0.20, as in the statement. The run in the paper is one sample of these chaotic motions. The run
    must be as long as the paper's interval.
    """
    run.check_friction(present=False)
    run.last_until(INTERVAL)
    four, five = run.members(run.four_terms(), run.five_terms())
    spans = final_differences(four, five, run.time >= run.time[-1] - 1.0)
    mean, error = mean_of(spans)
    return finding(
        [Excess(mean, DIVERGENCE, error)],
        f"Largest difference of the tips in the last second, in the mean of {spans.size} members, "
        f"with a standard error of {error:.3f}; from {spans.min():.2f} to {spans.max():.2f} in "
        f"single ones, above {DIVERGENCE:g} in {100.0 * (spans > DIVERGENCE).mean():.0f} %.",
        mean,
        DIVERGENCE,
        "of the range",
    )


def _s3(run: RunQuery) -> Finding:
    """Count the members in which the models conform for six seconds, and those that stratify later.

    Measure: the shares of these members. Threshold: one half for both, so that the paper's figure
    is typical. The models conform if all corresponding peaks of the slow motion differ by at most
    0.20 in height and, as a fraction of the period, in time; the paper calls 0.20 a divergence
    (S2). They stratify if one later peak differs by more. A peak that only some models have differs
    infinitely. A member without peaks in one of the two intervals does not count there. Values at
    equal times cannot be compared, since six seconds are far beyond the horizon of a single run.
    """
    run.check_friction(present=False)
    run.last_until(CONFORMITY)
    models = run.with_play()
    curves = run.members(*models).swapaxes(0, 1)
    cutoff = run.slow_below()
    distances = [peak_distances(member, run.time, cutoff) for member in curves]
    early = [
        diffs[time <= CONFORMITY].max()
        for time, diffs in distances
        if time.min(initial=np.inf) <= CONFORMITY
    ]
    late = [
        diffs[time > CONFORMITY].max()
        for time, diffs in distances
        if time.max(initial=0.0) > CONFORMITY
    ]
    if not early:
        raise MissingData(f"No member has a peak within {CONFORMITY:g} s.")
    if not late:
        raise MissingData(f"No member has a peak after {CONFORMITY:g} s.")
    conform, stratify = np.array(early) <= DIVERGENCE, np.array(late) > DIVERGENCE
    divergence = [float(time[diffs > DIVERGENCE].min(initial=np.inf)) for time, diffs in distances]
    median = sorted(divergence)[len(divergence) // 2]
    return finding(
        [_majority(conform), _majority(stratify)],
        f"Members of {len(early)} whose slow peaks conform for {CONFORMITY:g} s, within "
        f"{100.0 * DIVERGENCE:g} % in all models; {100.0 * stratify.mean():.0f} % of {len(late)} "
        "have peaks further apart later. "
        f"{_median_sentence(median)} {_horizon_sentence(run, models)}",
        float(conform.mean()),
        MOST,
        "of the members",
    )


def _s4(run: RunQuery) -> Finding:
    """Compare the first tip peaks of the four models in the order of the statement.

    Measure: the smallest rise from one model to the next, in percent. Threshold: 0.5 %, by which a
    small change of load or step changes a peak. The statement is reproduced if every rise is
    larger, contradicted if one is below -0.5 %, and otherwise undecided.
    """
    run.check_friction(present=False)
    models = [run.four_terms(), run.five_terms(), run.beam_elements(), run.shell()]
    peaks = [run.peak_height(model) for model in models]
    rises = [after / before - 1.0 for before, after in pairwise(peaks)]
    smallest = min(rises)
    least = int(np.argmin(rises))
    listed = ", ".join(f"{1e3 * peak:.1f}" for peak in peaks)
    return finding(
        [Excess(smallest, 0.0, PEAK_ERROR)],
        f"First tip peaks {listed} mm. The smallest rise is from {models[least].name!r} to "
        f"{models[least + 1].name!r}; a small change of load or step moves a first peak by up to "
        f"{100.0 * PEAK_SCATTER:g} %.",
        100.0 * smallest,
        100.0 * PEAK_SCATTER,
        "%",
    )


def _s5(run: RunQuery) -> Finding:
    """Compare the first tip peaks with play to the first tip peak without play.

    Measure: the smallest ratio. Threshold: 2, at which play adds as much as the whole deflection
    without play. Models with play differ by less than a tenth, and first peaks scatter by 0.5 %.
    """
    run.check_friction(present=False)
    bonded = run.peak_height(run.bonded())
    models = [model for model in run.case.models if not model.bonded]
    if not models:
        raise MissingData("The case has no model with play.")
    ratio, name = min((run.peak_height(model) / bonded, model.name) for model in models)
    return finding(
        [Excess(ratio, FUNDAMENTAL, FUNDAMENTAL * PEAK_ERROR)],
        f"First tip peak with play over the {1e3 * bonded:.1f} mm without; the smallest is in "
        f"{name!r}.",
        ratio,
        FUNDAMENTAL,
        "times",
    )


def _s6(run: RunQuery) -> Finding:
    """Compare the differences of the models at the tip and at the head, up to the first tip peak.

    Measure: the ratio of the largest differences of any two models at the tip and at the head.
    Later, chaos and the phase of the slow motion determine them. Threshold: 5, half of the ratio of
    the ranges. The statement is reproduced if the ratio is between 1/5 and 5, and the difference
    over the local range is larger at the head.
    """
    run.check_friction(present=False)
    models = run.with_play()
    end = min(run.peak_time(model) for model in models)
    until = run.time <= end
    spans, relative = {}, {}
    for place in ("tip", "head"):
        curves = np.array([run.curve(model, place)[until] for model in models])
        spans[place] = float(np.ptp(curves, axis=0).max())
        relative[place] = spans[place] / max(map(_range, curves))
    if min(spans.values()) == 0.0:
        raise MissingData("The models do not differ up to the first peak.")
    ratio = spans["tip"] / spans["head"]
    level = Excess(SAME_LEVEL, max(ratio, 1.0 / ratio), LEVEL_ERROR * SAME_LEVEL)
    greater = Excess(relative["head"], relative["tip"], LEVEL_ERROR * relative["tip"])
    shares = {place: f"{100.0 * part:.0f} %" for place, part in relative.items()}
    return finding(
        [level, greater],
        f"Largest difference up to the first peak at {end:.2f} s: {1e3 * spans['tip']:.1f} mm at "
        f"the tip, {1e3 * spans['head']:.1f} mm at the head, which is {shares['tip']} and "
        f"{shares['head']} of the ranges there.",
        ratio,
        SAME_LEVEL,
        "times",
    )


def _s7(run: RunQuery) -> Finding:
    """Compare the models with friction within six seconds, later, without play and at the head.

    Measure: the largest difference of the tips of any two models with play within six seconds, over
    the largest range. Threshold: 0.20, which the paper calls a divergence (S2). The statement is
    reproduced if this difference is below 0.20 and increases later, each model differs by more than
    0.20 from the model without play, and the difference is larger at the head than at the tip. With
    friction, runs do not diverge, and one trajectory of each model is enough.
    """
    run.check_friction(present=True)
    run.last_until(INTERVAL)
    models = run.with_play()
    within_interval = run.time <= CONFORMITY
    differences = {place: _largest_differences(run, models, place) for place in ("tip", "head")}
    conform = float(differences["tip"][within_interval].max())
    later = float(differences["tip"][~within_interval].max())
    without = run.bonded()
    bonded = min(
        float(_largest_differences(run, [model, without], "tip").max()) for model in models
    )
    head = float(differences["head"].max())
    return finding(
        [
            Excess(DIVERGENCE, conform),
            Excess(later, conform),
            Excess(bonded, DIVERGENCE),
            Excess(head, max(conform, later)),
        ],
        f"Largest difference of the tips of {len(models)} models with play up to {CONFORMITY:g} s; "
        f"{later:.2f} later, {bonded:.2f} at least between one of them and the play-free one, "
        f"and {head:.2f} of the range at the head.",
        conform,
        DIVERGENCE,
        "of the range",
    )


def _s8(run: RunQuery) -> Finding:
    """Check how long the beam elements with friction move with a bounded energy residual.

    Measure: this time in s. Threshold: 7 s, at which the paper's solution became unstable. A longer
    stable run shows that the system itself is stable. A shorter run decides nothing, since a run
    with unbounded energy has no results here.
    """
    run.check_friction(present=True)
    model = run.beam_elements()
    run.curve(model)
    run.last_until(INTERVAL)
    summary = run.summary_of(model)
    duration = float(run.time[-1])
    return finding(
        [Excess(INTERVAL, duration)],
        f"{model.name!r} moves for {duration:g} s in {summary.steps} steps with an energy residual "
        f"of {summary.energy_residual:.1e}: what ended the paper's run after 4375 steps "
        "was its integration.",
        duration,
        INTERVAL,
        "s",
    )


def _s9(run: RunQuery) -> Finding:
    """Compare the first tip peaks of models that differ only in the exponent n of contact.

    Measure: their largest relative difference. Threshold: 5 %, less than the differences between
    the models of S4. The stiffness may differ, too, since its unit depends on n.
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
    return finding(
        [Excess(CLEAR_INFLUENCE, measured, PEAK_ERROR)],
        f"Difference of the first tip peaks of {a!r} and {b!r}, whose exponents differ.",
        100.0 * measured,
        100.0 * CLEAR_INFLUENCE,
        "%",
    )


def _s10(run: RunQuery) -> Finding:
    """Count the integration steps that the models need for their first three slow peaks.

    Measure: the fewest steps of the trials that keep the peaks within 1 % beyond the spread of the
    ensemble, the larger number of the two series. Threshold: 2000; beam elements must need more
    than 4000. The paper's 2000 steps cover its whole interval, a longer one than the three peaks.
    """
    run.check_friction(present=False)
    series = [run.four_terms(), run.five_terms()]
    needed = {model.name: run.fewest_steps(model) for model in (*series, run.beam_elements())}
    *of_series, of_elements = needed.values()
    steps = max(of_series)
    listed = ", ".join(f"{name!r} {number:.0f}" for name, number in needed.items())
    return finding(
        [
            Excess(np.log2(SERIES_STEPS), np.log2(steps), DOUBLINGS_ERROR),
            Excess(np.log2(of_elements), np.log2(ELEMENT_STEPS), DOUBLINGS_ERROR),
        ],
        f"Fewest steps that keep the first three peaks of the slow motion: {listed}.",
        steps,
        SERIES_STEPS,
        "steps",
    )


def _s11(run: RunQuery) -> Finding:
    """Compare the first tip peaks of a series and beam elements on three segments or more.

    Measure: the relative difference of the series with most terms. Threshold: 20 %, the same as for
    two segments, where the paper calls this difference a divergence (S2).
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
    difference = abs(run.peak_height(series) / run.peak_height(elements) - 1.0)
    return finding(
        [Excess(DIVERGENCE, difference, PEAK_ERROR)],
        f"First tip peaks of {series.name!r} and {elements.name!r} on {count} segments, which take "
        f"{run.summary_of(series).modes} and {run.summary_of(elements).modes} equations.",
        100.0 * difference,
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


def _majority(members: Mask) -> Excess:
    """Return the excess of a share of members over one half, where it has its standard error."""
    return Excess(float(members.mean()), MOST, 0.5 / float(np.sqrt(members.size)))


def _largest_differences(run: RunQuery, models: Sequence[Model], place: str) -> Array:
    """Return the largest differences (num_times,) of any two models, over the largest range."""
    curves = np.array([run.curve(model, place) for model in models])
    return np.asarray(np.ptp(curves, axis=0) / max(map(_range, curves)))


def _median_sentence(median: float) -> str:
    """Return a sentence on the median time in s of the first peak that differs, or infinity."""
    if not np.isfinite(median):
        return "In most members no peaks are further apart."
    return f"In half of them the first such peak is at {median:.1f} s or before."


def _horizon_sentence(run: RunQuery, models: list[Model]) -> str:
    """Return a sentence on the horizons of predictability of the models."""
    horizons = [run.horizon(model, DIVERGENCE) for model in models]
    times = [time for time in horizons if time is not None]
    if not times:
        return "The members of each model stay together."
    return (
        f"Members of one model part by {100.0 * DIVERGENCE:g} % of the range from "
        f"{min(times):.1f} s on."
    )


def _range(curve: Array) -> float:
    span = float(np.ptp(curve))
    if span == 0.0:
        raise MissingData("Nothing moves.")
    return span


def _exponents(run: RunQuery, model: Model) -> list[set[float]]:
    """Return the contact exponents n of each joint under the laws of a model."""
    joints = model.model_boom(run.results.boom).boom.joints
    return [{term.exponent for term in joint.law("z").terms} for joint in joints]

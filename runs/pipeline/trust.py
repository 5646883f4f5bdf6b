# SPDX-License-Identifier: LGPL-3.0-or-later
"""How far the numbers of a run can be trusted, one line for each kind of doubt."""

from __future__ import annotations

from collections.abc import Iterator

from geometry.typography import TO_PERCENT, listed
from runs.pipeline.answers import Answers, Known, ModelAnswers
from runs.pipeline.summary import Summary

# The part of the tip's range apart at which members of an ensemble count as parted.
_PARTED = 0.2


def known(summary: Summary, answers: Answers, duration: float) -> list[Known]:
    """What can be said of a run.

    Args:
        summary: of its models.
        answers: of its models.
        duration: of the motion in s.
    """
    kinds = {
        "agreement": _agreement(answers),
        "horizon": _horizon(summary, duration),
        "step": _step(summary),
        "reduction": _reduction(summary),
        "mesh": _mesh(summary),
        "energy": _energy(summary),
    }
    return [Known(what, line) for what, lines in kinds.items() for line in lines]


def percent(part: float) -> str:
    """With two digits, or one that is not 0."""
    return f"{TO_PERCENT * part:.2g} %"


def _agreement(answers: Answers) -> Iterator[str]:
    """Of the models with play with the one that they are held against."""
    if answers.modes is None:
        return
    reference = answers.modes.reference
    own = answers.models[reference]
    for name in answers.modes.matches:
        parts = [f"{part} {what}" for what, part in _distances(answers, own, name)]
        if parts:
            yield f"{name} is off {reference} by {listed(parts)}."


def _distances(answers: Answers, own: ModelAnswers, name: str) -> Iterator[tuple[str, str]]:
    other = answers.models[name]
    if (off := off_at_rest(own, other)) is not None:
        yield "in the tip at rest", percent(abs(off))
    assert answers.modes is not None
    first = answers.modes.matches[name][0]
    if first is not None:
        yield "in the first frequency", percent(abs(first.off))
    if own.moved is not None and other.moved is not None and own.moved.peaks[0].largest:
        ratio = other.moved.peaks[0].largest / own.moved.peaks[0].largest
        yield "in the largest deflection of the tip", percent(abs(ratio - 1.0))


def off_at_rest(own: ModelAnswers, other: ModelAnswers) -> float | None:
    """By what part of one's the other's tip at rest under the largest loads is off; else None."""
    tips = [max((rest.tip for rest in one.rests), key=abs, default=None) for one in (own, other)]
    if tips[1] is None or not tips[0]:
        return None
    return tips[1] / tips[0] - 1.0


def _horizon(summary: Summary, duration: float) -> Iterator[str]:
    """Of what ensembles have told."""
    times = {
        name: model.ensemble.horizon(_PARTED)
        for name, model in summary.models.items()
        if model.ensemble is not None
    }
    parted = {name: time for name, time in times.items() if time is not None}
    if parted:
        which = listed([f"{name} {time:.2f} s" for name, time in parted.items()])
        yield (
            "The motion is chaotic: runs whose data differ by less than can be known are "
            f"{percent(_PARTED)} of the tip's range apart from here on: {which}. Later curves are "
            "samples; the heights and times of slow peaks hold longer."
        )
    regular = [name for name, time in times.items() if time is None]
    if regular:
        yield f"The motion of {listed(regular)} can be predicted over all {duration:g} s."


def _step(summary: Summary) -> Iterator[str]:
    errors = [model.step_error for model in summary.models.values() if model.step_error]
    if errors:
        yield f"The time step changes the tip by {percent(max(errors))} of its range at most."


def _reduction(summary: Summary) -> Iterator[str]:
    for name, model in summary.models.items():
        error = model.reduction_errors.get("contact_compliance")
        if error is not None:
            yield (
                f"{name}: its {model.modes} coordinates answer contacts as the full shell does, "
                f"within {error:.1g} of what gives way there."
            )


def _mesh(summary: Summary) -> Iterator[str]:
    for name, model in summary.models.items():
        if model.mesh_error is not None:
            yield (
                f"{name}: where something presses, its walls give way by "
                f"{percent(model.mesh_error)} more or less than on an infinitely fine mesh."
            )


def _energy(summary: Summary) -> Iterator[str]:
    name, model = max(summary.models.items(), key=lambda entry: entry[1].energy_residual)
    yield (
        f"Energy is accounted for within {model.energy_residual:.1g} of the work done in every "
        f"model; the least well in {name}."
    )

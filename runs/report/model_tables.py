# SPDX-License-Identifier: LGPL-3.0-or-later
"""The models of a run as tables: what each found, its steps, its contact laws."""

from __future__ import annotations

from dataclasses import dataclass

from dynamics.predictability.horizon import SHARES
from runs.case.build import contact_laws
from runs.pipeline.comparisons import reference_of, rubs
from runs.pipeline.results import Results
from runs.pipeline.summary import ModelSummary, Peak
from runs.report.tables import TextTable
from runs.report.theme import NONE, fixed, number

MICRO = 1.0e6
MILLI = 1.0e3
KILO = 1.0e3
PERCENT = 100.0


@dataclass(frozen=True, slots=True)
class ModelRow:
    """One model's numbers as text; ``NONE`` where it has no such number.

    ``horizons`` are those of ``SHARES``, empty where no model has any; ``seconds`` is the wall
    time of all stages.
    """

    name: str
    kind: str
    degrees_of_freedom: str
    modes: str
    step: str
    first_contact: str
    tip_peak_time: str
    tip_peak: str
    horizons: tuple[str, ...]
    peak_force: str
    energy_residual: str
    seconds: str


def model_rows(results: Results) -> list[ModelRow]:
    """A row for each model that ran, in the case's order, and for each one that failed."""
    models = results.summary.models
    duration = results.case.time.duration
    shares = SHARES if any(model.ensemble for model in models.values()) else ()
    rows = []
    for name, model in models.items():
        peak_time, peak = _first_peak(model.first_peak["tip"], duration)
        rows.append(
            ModelRow(
                name=name,
                kind=model.kind,
                degrees_of_freedom=str(model.degrees_of_freedom),
                modes=str(model.modes),
                step=number(MICRO * model.step),
                first_contact=fixed(model.first_contact, 4),
                tip_peak_time=peak_time,
                tip_peak=peak,
                horizons=tuple(horizon(model, share, duration) for share in shares),
                peak_force=_in_kilo(model.peak_contact_force),
                energy_residual=number(model.energy_residual, 1),
                seconds=fixed(sum(model.seconds.values()), 1),
            )
        )
    missing = ("failed", *(NONE,) * 5, tuple(NONE for _ in shares), *(NONE,) * 3)
    kinds = {model.name: model.kind for model in results.case.models}
    failed = results.summary.failures
    return rows + [ModelRow(name, kinds[name], *missing) for name in failed]


def horizon(model: ModelSummary, share: float, duration: float) -> str:
    """When the members of a model's ensemble are a share of the tip's range apart, in s.

    ``> 10`` where they are not within 10 s, ``NONE`` where the model has no ensemble.
    """
    if model.ensemble is None:
        return NONE
    time = model.ensemble.horizon(share)
    return f"> {duration:g}" if time is None else fixed(time, 2)


def model_table(results: Results) -> TextTable:
    """What each model found."""
    rows = model_rows(results)
    shares = SHARES[: len(rows[0].horizons)]
    headings = (
        "model", "kind", "degrees of freedom", "modes", "step\nµs", "first contact\ns",
        "first tip peak\ns", "\nmm", *(f"horizon {PERCENT * share:g} %\ns" for share in shares),
        "peak contact force\nkN", "energy residual\nof the work", "wall time\ns",
    )  # fmt: skip
    cells = [
        (
            row.name, row.kind, row.degrees_of_freedom, row.modes, row.step, row.first_contact,
            row.tip_peak_time, row.tip_peak, *row.horizons, row.peak_force, row.energy_residual,
            row.seconds,
        )
        for row in rows
    ]  # fmt: skip
    meaning = (
        "Horizon: when the members of a model's ensemble are that part of the tip's range around "
        "one another; beyond it a single run is a sample."
    )
    notes = (meaning,) if shares else ()
    return TextTable("What each model found", headings, cells, notes, name="models")


def step_table(results: Results) -> TextTable:
    """How many steps each model took, and how many its motion needs."""
    models = results.summary.models
    headings = ["model", "step\nµs", "steps", "openings and closings"]
    columns = [
        list(models),
        [number(MICRO * model.step) for model in models.values()],
        [_thousands(model.steps) for model in models.values()],
        [_thousands(model.contact_changes) for model in models.values()],
    ]
    notes = ["Each opening or closing of a contact takes a step of its own, whatever the solver."]
    tried = [model.steps_for_peaks for model in models.values()]
    if any(tried):
        headings.append("enough for slow peaks\nsteps")
        columns.append([_thousands(found.fewest if found else None) for found in tried])
        within = next(found for found in tried if found)
        notes.append(
            f"Enough for slow peaks: the fewest steps tried that keep the first {within.peaks} "
            f"of them within {PERCENT * within.within:g} %, beyond the ensemble's spread."
        )
    if any(model.step_halving is not None for model in models.values()):
        headings.append("change by half the step\n% of the tip's range")
        columns.append([_in_percent(model.step_halving) for model in models.values()])
    if results.case.statements:
        notes.append(
            "The paper names at most 2000 steps for the series and more than 4000 for beam "
            "elements, and 4375 for these with friction."
        )
    statements = ("S8", "S10") if rubs(results.case) else ("S10",)
    rows = list(zip(*columns, strict=True))
    return TextTable("Steps", headings, rows, notes, "steps", statements)


def law_table(results: Results) -> TextTable | None:
    """The contact law of each joint in each model with play, and the first peak it leads to."""
    models = [model for model in results.ran if not model.play_free]
    rows = []
    for model in models:
        peak = results.summary.models[model.name].first_peak["tip"].height
        laws = contact_laws(results.case, model)
        for joint, law in zip(results.case.joints, laws, strict=True):
            if not joint.tied:
                where = f"{joint.inner} in {joint.outer}"
                clearance = fixed(0.5 * MILLI * joint.play, 1)
                rows.append((model.name, where, clearance, str(law), fixed(peak, 1, MILLI)))
    headings = "model", "joint", "clearance\nmm", "law\nk in N/mⁿ", "first tip peak\nmm"
    notes = ("Force = k · penetrationⁿ, beyond the clearance each way.",)
    if not rows:
        return None
    return TextTable("Contact laws", headings, rows, notes, name="laws", statements=("S9",))


def space_table(results: Results) -> TextTable | None:
    """First peaks along both directions against the reference; None for a flat boom."""
    models = results.summary.models
    reference = reference_of(results.ran)
    if reference is None or "tip_lateral" not in models[reference].first_peak:
        return None
    rows = []
    for name, model in models.items():
        cells = [name]
        for place in ("tip", "tip_lateral"):
            peak = model.first_peak[place]
            cells += _first_peak(peak, results.case.time.duration)
            cells.append(_off(peak.height, models[reference].first_peak[place].height))
        rows.append(tuple(cells))
    headings = (
        "model",
        *("up\ns", "\nmm", f"off {reference}\n%"),
        *("sideways\ns", "\nmm", f"off {reference}\n%"),
    )
    return TextTable("First peaks of the tip in space", headings, rows, name="space")


def _first_peak(peak: Peak, duration: float) -> tuple[str, str]:
    """Time and height; where there is no peak the two say so together."""
    time, height = peak
    if height is None:
        return "no peak", f"within {duration:g} s"
    return fixed(time, 3), fixed(height, 1, MILLI)


def _off(height: float | None, other: float | None) -> str:
    return NONE if height is None or other is None else _in_percent(height / other - 1.0)


def _thousands(count: int | None) -> str:
    """``11 194 798``."""
    return NONE if count is None else f"{count:,}".replace(",", "\N{NO-BREAK SPACE}")


def _in_percent(part: float | None) -> str:
    return NONE if part is None else number(PERCENT * part, 2)


def _in_kilo(force: float | None) -> str:
    return NONE if force is None else number(force / KILO)

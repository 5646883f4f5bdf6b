# SPDX-License-Identifier: LGPL-3.0-or-later
"""The models of a run as tables: what each found, its steps, its contact laws."""

from __future__ import annotations

from dynamics.predictability.horizon import SHARES
from geometry.typography import TO_KILO, TO_MICRO, TO_MILLI, TO_PERCENT
from runs.case.build import contact_laws
from runs.pipeline.results import Results
from runs.pipeline.summary import FirstPeak, ModelSummary
from runs.report.numerals import number
from runs.report.tables import Cell, Column, Table


def model_tables(results: Results) -> list[Table]:
    """What each model found, and how, where there is such a thing."""
    found = (
        model_table(results),
        step_table(results),
        space_table(results),
        buckling_table(results),
        law_table(results),
    )
    return [table for table in found if table is not None]


def model_table(results: Results) -> Table:
    """What each model found, in the case's order, and at the end those that failed."""
    summary, duration = results.summary, results.case.time.duration
    models = list(summary.models.values())
    failed = [model for model in results.case.models if model.name in summary.failures]
    peaks = [_first_peak(model.first_peak["tip"], duration) for model in models]
    contacts = [model.first_contact for model in models]
    touching = 0.0 in contacts and not any(contacts)
    shares = SHARES if any(model.ensemble for model in models) else ()
    columns = (
        Column("model", [*summary.models, *(model.name for model in failed)]),
        Column("kind", [*(model.kind for model in models), *(model.kind for model in failed)]),
        Column(
            "degrees of freedom",
            [*(str(model.degrees_of_freedom) for model in models), *("failed" for _ in failed)],
        ),
        Column("modes", [str(model.modes) for model in models]),
        Column("shortest step\nµs", [model.step for model in models], ".3g", TO_MICRO),
        *([Column("first contact\ns", contacts, ".4f")] if not touching else []),
        Column("first tip peak\ns", [time for time, _ in peaks], ".3f"),
        Column("\nmm", [height for _, height in peaks], ".1f", TO_MILLI),
        *(horizon_column(models, share, duration) for share in shares),
        Column("peak contact force\nkN", [_peak_force(model) for model in models], ".3g", TO_KILO),
        Column("energy residual\nof the work", [model.energy_residual for model in models], ".1g"),
        Column("wall time\ns", [model.wall_time for model in models], ".1f"),
    )
    notes = []
    if shares:
        notes.append(
            "Horizon: when the members of a model's ensemble are that part of the tip's range "
            "around one another; beyond it a single run is a sample."
        )
    if resolving := [model.resolving_step for model in models if model.resolving_step]:
        notes.append(
            "≥: the blow is shorter than six steps, and the force is the largest mean of a step; "
            f"time.step = {min(resolving):.1e} would resolve it."
        )
    return Table("What each model found", columns, notes, "models")


def _peak_force(model: ModelSummary) -> Cell:
    """Return the peak contact force, marked where the step does not resolve the blow."""
    if model.resolving_step is None or model.peak_contact_force is None:
        return model.peak_contact_force
    return f"≥ {number(TO_KILO * model.peak_contact_force)}"


def horizon_column(models: list[ModelSummary], share: float, duration: float) -> Column:
    """When the members of each ensemble are a share of the tip's range apart.

    ``> 10`` where they are not within 10 s.
    """

    def horizon(model: ModelSummary) -> Cell:
        if model.ensemble is None:
            return None
        time = model.ensemble.horizon(share)
        return f"> {duration:g}" if time is None else time

    return Column(
        f"horizon {TO_PERCENT * share:g} %\ns", [horizon(model) for model in models], ".2f"
    )


def step_table(results: Results) -> Table:
    """How many steps each model took, and how many its motion needs."""
    models = results.summary.models.values()
    columns = [
        Column("model", list(results.summary.models)),
        Column("shortest step\nµs", [model.step for model in models], ".3g", TO_MICRO),
        Column("steps", [model.steps for model in models]),
        Column("openings and closings", [model.contact_changes for model in models]),
    ]
    notes = [
        "The step error adds up, over windows of the motion, the difference that twice the step "
        "makes to the deflections. In chaotic motion no step keeps a tolerance."
    ]
    tried = [model.steps_for_peaks for model in models]
    within = next((found for found in tried if found), None)
    if within is not None:
        fewest = [found.fewest if found else None for found in tried]
        columns.append(Column("enough for slow peaks\nsteps", fewest))
        notes.append(
            f"Enough for slow peaks: the fewest steps tried that keep the first {within.peaks} "
            f"of them within {TO_PERCENT * within.within:g} %, beyond the ensemble's spread."
        )
    errors = [model.step_error for model in models]
    if any(error is not None for error in errors):
        columns.append(Column("step error\n% of the tip's range", errors, ".2g", TO_PERCENT))
    return Table("Steps", columns, notes, "steps")


def law_table(results: Results) -> Table | None:
    """The contact law of each joint in each model with play, and the first peak it leads to."""
    found = [
        (model.name, joint, law)
        for model in results.ran
        if not model.play_free
        for joint, law in zip(results.case.joints, contact_laws(results.case, model), strict=True)
        if not joint.tied
    ]
    if not found:
        return None
    models = results.summary.models
    peaks = [models[name].first_peak["tip"].height for name, _, _ in found]
    columns = (
        Column("model", [name for name, _, _ in found]),
        Column("joint", [f"{joint.inner} in {joint.outer}" for _, joint, _ in found]),
        Column("play\nmm", [joint.play for _, joint, _ in found], ".1f", TO_MILLI),
        Column("law\nk in N/mⁿ", [str(law) for _, _, law in found]),
        Column("first tip peak\nmm", peaks, ".1f", TO_MILLI),
    )
    notes = ["Force = k · penetrationⁿ, beyond the part of the play that is on its side."]
    if not all(joint.pad or joint.pads for _, joint, _ in found):
        notes.append(
            "Without slide pads the segments press in the corners of their boxes. Pads beside "
            "them, on walls that give way, can move the first peak by a quarter and more: give the "
            "pads their place (joint.pad)."
        )
    return Table("Contact laws", columns, notes, "laws")


def space_table(results: Results) -> Table | None:
    """First peaks along both directions against the reference; None for a flat boom."""
    models, duration = results.summary.models, results.case.time.duration
    reference = results.reference
    if reference is None or "tip_lateral" not in models[reference].first_peak:
        return None
    columns = [Column("model", list(models))]
    for place, way in (("tip", "up"), ("tip_lateral", "sideways")):
        peaks = [model.first_peak[place] for model in models.values()]
        shown = [_first_peak(peak, duration) for peak in peaks]
        other = models[reference].first_peak[place].height
        columns += [
            Column(f"{way}\ns", [time for time, _ in shown], ".3f"),
            Column(f"{way}\nmm", [height for _, height in shown], ".1f", TO_MILLI),
            Column(
                f"{way}, off {reference}\n%",
                [_off(p.height, other) for p in peaks],
                ".2g",
                TO_PERCENT,
            ),
        ]
    return Table("First peaks of the tip in space", columns, name="space")


def buckling_table(results: Results) -> Table | None:
    """How near axial forces are to those under which the boom buckles; None without any."""
    models = results.summary.models
    factors = [model.critical_factor for model in models.values()]
    if not any(factors):
        return None
    columns = (
        Column("model", list(models)),
        Column("buckling factor", factors, ".4g"),
        Column("of the critical\n%", [f and 1.0 / f for f in factors], ".3g", TO_PERCENT),
        Column(
            "tip at rest, constant loads\nmm",
            [model.static_tip for model in models.values()],
            ".4g",
            TO_MILLI,
        ),
    )
    notes = (
        "Buckling factor: by what the axial forces would have to grow for the boom to buckle, its "
        "joints pressed. Tip: the second order is in it.",
    )
    return Table("Axial forces", columns, notes, "buckling")


def _first_peak(peak: FirstPeak, duration: float) -> tuple[Cell, Cell]:
    """Time and height; where there is no peak the two say so together."""
    return peak if peak.height is not None else ("no peak", f"within {duration:g} s")


def _off(height: float | None, other: float | None) -> float | None:
    return None if height is None or other is None else height / other - 1.0

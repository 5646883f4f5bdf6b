# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of the models of a run: results, steps, contact laws, calibrations."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import groupby

from protractile.analysis.quantities import declared_quantities
from protractile.dynamics.predictability import SHARES
from protractile.geometry.typography import TO_KILO, TO_PERCENT, number, percent
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.summary import CalibrationCard, ModelSummary
from protractile.runs.report.tables import Cell, Column, Table


def model_tables(results: Results) -> list[Table]:
    """Return the tables of a run on its models and their numerics."""
    tables = (
        model_table(results),
        step_table(results),
        buckling_table(results),
        law_table(results),
        *calibration_tables(results),
    )
    return [table for table in tables if table is not None and table.rows]


def model_table(results: Results) -> Table:
    """Return the table of the models, in the order of the case; failed models are last."""
    summary, duration = results.summary, results.case.time.duration
    models = list(summary.models.values())
    failed = [model for model in results.case.models if model.name in summary.failures]
    freedom = [str(model.degrees_of_freedom) for model in models]
    peaks = [model.first_peak["tip"] for model in models]
    contacts = [model.first_contact for model in models]
    touching = 0.0 in contacts and not any(contacts)
    shares = SHARES if any(model.ensemble for model in models) else ()
    columns = (
        Column("model", [*summary.models, *(model.name for model in failed)]),
        Column("kind", [*(model.kind for model in models), *(model.kind for model in failed)]),
        Column("degrees of freedom", [*freedom, *("failed" for _ in failed)]),
        Column("coordinates", [str(model.modes) for model in models]),
        Column("shortest step", [model.step for model in models], ".3g", "µs"),
        *([Column("first contact", contacts, ".4f", "s")] if not touching else []),
        Column("first tip peak", [time for time, _ in peaks], ".3f", "s"),
        Column("first tip peak", [height for _, height in peaks], ".1f", "mm"),
        *(horizon_column(models, share, duration) for share in shares),
        Column("peak contact force", [_peak_force(model) for model in models], ".3g", "kN"),
        *metric_columns(ModelSummary, models),
    )
    notes = [
        "Energy residual: error of the energy balance, divided by the largest work of the loads "
        "during the run or, if larger, the initial energy.",
        "Computing time: without compilation.",
    ]
    if any(time is None for time, _ in peaks):
        notes.append(f"First tip peak –: none within {duration:g} s.")
    if shares:
        notes.append(
            "Horizon: time at which the members of a model's ensemble differ by this fraction of "
            "the tip's range; beyond it a single run is a sample."
        )
    if resolving := [model.resolving_step for model in models if _is_unresolved(model)]:
        notes.append(
            "≥: this impact lasts less than six of its time steps, so that its peak is larger; "
            "the force is the largest mean over a step. A constant step, time.step = "
            f"{min(filter(None, resolving)):.1e}, is short enough for this impact."
        )
    if any(model.peak_contact_force and model.contact_changes for model in models):
        notes.append(
            "Peak contact force: maximum of a single impact, which lasts microseconds. Size pads "
            "and walls by the contact forces of the design results, the means over output steps."
        )
    return Table("Models: results and numerics", columns, notes, "models")


def metric_columns(kind: type, rows: Sequence[object]) -> list[Column]:
    """Return the columns with values of a kind of record, with a row for each record."""
    columns = [
        Column(
            quantity.heading,
            [getattr(row, name) for row in rows],
            quantity.form,
            quantity.unit_of_heading,
        )
        for name, quantity in declared_quantities(kind).items()
        if quantity.heading
    ]
    return [column for column in columns if any(cell is not None for cell in column.cells)]


def _is_unresolved(model: ModelSummary) -> bool:
    """Return True if the step does not resolve the impacts of a motion."""
    return bool(model.resolving_step and model.contact_changes)


def _peak_force(model: ModelSummary) -> Cell:
    """Return the peak contact force, with a mark if the step does not resolve the impact."""
    if model.peak_contact_force is None or not _is_unresolved(model):
        return model.peak_contact_force
    return f"≥ {number(TO_KILO * model.peak_contact_force)}"


def horizon_column(models: list[ModelSummary], share: float, duration: float) -> Column:
    """Return the column of the times at which members differ by a share of the range of the tip.

    A cell is ``> 10`` if the difference stays smaller during a run of 10 s.
    """
    times = [None if model.ensemble is None else model.ensemble.horizon(share) for model in models]
    cells: list[Cell] = [
        f"> {duration:g}" if model.ensemble and time is None else time
        for model, time in zip(models, times, strict=True)
    ]
    return Column(f"horizon {TO_PERCENT * share:g} %", cells, ".2f", "s")


def step_table(results: Results) -> Table:
    """Return the table of steps: those of the run, and the fewest that preserve slow peaks."""
    models = results.summary.models.values()
    columns = [
        Column("model", list(results.summary.models)),
        Column("shortest step", [model.step for model in models], ".3g", "µs"),
        Column("steps", [model.steps for model in models]),
        Column("contact changes", [model.contact_changes for model in models]),
    ]
    notes = [
        "Step error: the estimated largest error of a deflection by the time step, from whole "
        "motions with the steps of the run and with half of each, as a fraction of the range of "
        "this deflection. In chaotic motion no step size converges.",
        "Contact changes: openings and closings.",
    ]
    tried = [model.steps_for_peaks for model in models]
    within = next((steps for steps in tried if steps), None)
    if within is not None:
        fewest = [steps.fewest if steps else None for steps in tried]
        columns.append(Column("enough for slow peaks", fewest, unit="steps"))
        notes.append(
            f"Enough for slow peaks: the fewest steps in trials that preserve the first "
            f"{within.peaks} "
            f"of them within {percent(within.within)}, beyond the ensemble's spread."
        )
    errors = [model.step_error for model in models]
    if any(error is not None for error in errors):
        columns.append(Column("step error", errors, ".2g", "% of the range"))
    return Table("Steps", columns, notes, "steps")


def law_table(results: Results) -> Table:
    """Return the table of the contact laws of joints in each model, with the first peak."""
    laws = [
        (model.name, joint, joint_of_model.contact)
        for model in results.completed_models
        if not model.bonded
        for joint, joint_of_model in zip(
            results.case.joints, model.model_boom(results.boom).boom.joints, strict=True
        )
        if not joint.bonded
    ]
    models = results.summary.models
    peaks = [models[name].first_peak["tip"].height for name, _, _ in laws]
    columns = (
        Column("model", [name for name, _, _ in laws]),
        Column("joint", [f"{joint.inner} in {joint.outer}" for _, joint, _ in laws]),
        Column("play", [joint.play for _, joint, _ in laws], ".1f", "mm"),
        Column("law", [str(law) for _, _, law in laws], unit="k in N/mⁿ"),
        Column("first tip peak", peaks, ".1f", "mm"),
    )
    notes = [
        "k δⁿ is the force of all pads on one side of a station; δ is the displacement beyond the "
        "clearance."
    ]
    if not all(joint.pad or joint.pads for _, joint, _ in laws):
        notes.append(
            "Without slide pads, contact is at the corners of the boxes. Pads beside the "
            "corners, where walls are compliant, can change the first peak by a quarter and "
            "more: specify them (joint.pad)."
        )
    return Table("Contact laws", columns, notes, "laws")


def buckling_table(results: Results) -> Table | None:
    """Return the table of buckling factors of axial forces; None without axial forces."""
    models = results.summary.models
    factors = [model.critical_factor for model in models.values()]
    tips = [model.static_tip for model in models.values()]
    if not any(factors):
        return None
    columns = (
        Column("model", list(models)),
        Column("buckling factor", factors, ".4g"),
        Column("axial force over\ncritical force", [f and 1.0 / f for f in factors], ".3g", "%"),
        Column("static tip deflection,\nt = 0", tips, ".4g", "mm"),
    )
    notes = [
        "Buckling factor: multiple of the axial forces at which the boom with closed joints "
        "buckles. The static tip deflection includes second-order effects.",
    ]
    if "shell" in {model.kind for model in models.values()}:
        notes.append(
            "Joints of beams count as bonded. Closed contacts of a shell have their stiffness at "
            "rest: at t = 0 and, if axial forces change, under their extremes. The factor of a "
            "shell that telescopes is at most that of a beam."
        )
    return Table("Axial forces", columns, notes, "axial")


def calibration_tables(results: Results) -> list[Table]:
    """Return the tables of stiffness and springs of calibrated beams, a pair for each shell."""
    cards = {
        name: model.calibration
        for name, model in results.summary.models.items()
        if model.calibration is not None
    }
    tables: list[Table] = []
    for count, (card, models) in enumerate(groupby(cards.items(), lambda item: item[1]), start=1):
        names = ", ".join(name for name, _ in models)
        tables += [_segments(card, names, count), _springs(card, names, count)]
    return tables


def _segments(card: CalibrationCard, names: str, count: int) -> Table:
    rows = [
        (beam.segment, *plane, beam.torsion)
        for beam in card.segments
        for plane in zip(
            "zy", beam.bending, beam.bending_part, beam.shear, beam.shear_part, strict=False
        )
    ]
    columns = (
        "segment",
        "bends along",
        ("bending stiffness\nE I", ".4g", "MN m²"),
        ("of the section", ".2f", "%"),
        ("shear stiffness\nG A", ".4g", "MN"),
        ("of the shear flow", ".1f", "%"),
        ("torsional stiffness\nG I_T", ".4g", "MN m²"),
    )
    notes = ("Stiffnesses of a Timoshenko beam with the compliance of the shell away from pads.",)
    title = f"Equivalent beam stiffnesses of the segments, for {names}"
    return Table.of_rows(f"calibrated-segments-{count}", title, columns, rows, notes, sparse=True)


def _springs(card: CalibrationCard, names: str, count: int) -> Table:
    columns = (
        Column("station", [f"{spring.x:g}" for spring in card.springs], unit="m"),
        Column("pressed wall of the outer segment", [spring.side for spring in card.springs]),
        Column("spring", [spring.stiffness for spring in card.springs], ".4g", "MN/m"),
    )
    notes = (
        "In other programs, put each spring in series with the gap of its station. It represents "
        "the local compliance of both walls, which the beams above do not have.",
    )
    title = f"Local springs of the stations, for {names}"
    return Table(title, columns, notes, f"calibrated-springs-{count}")

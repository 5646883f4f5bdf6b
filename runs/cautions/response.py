# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rules on the response of a boom, at rest and in motion, and on the accuracy of its models."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from math import inf

import numpy as np

from protractile.analysis.beams import beam_of
from protractile.analysis.plate_buckling import weakest_plates
from protractile.analysis.rows import COMBINATION, REST, Rows
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.geometry.axial import moving_force
from protractile.geometry.typography import TO_MILLI, TO_PERCENT, amount, milli, number, percent
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context, Sentence
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.combinations import limit_in_combinations
from protractile.runs.pipeline.hoisting_error import straight_path_error
from protractile.runs.pipeline.pad_walls import largest_tip, remedies, rigid_wall_note
from protractile.runs.pipeline.turning import fastest_turn, motion_laws, pendulum_frequency

# Share of the tip deflection below which walls do not matter, share above which remedies are
# listed, and share above which walls under pads govern it.
NO_SHARE, LARGE_SHARE, GOVERNING_SHARE = 5.0e-4, 0.1, 0.5
# Largest lag without a caution, as a fraction of the smallest overlap.
MAX_LAG = 0.01
# Fraction of the buckling load above which second-order effects are not small.
NEAR_BUCKLING = 1.0 / 3.0
# Fractions of the length of the boom: the error of small displacements is told above the first one,
# and is a caution above the second one.
TOLD_DEFLECTION, LARGE_DEFLECTION = 0.05, 0.15
# Errors of tip deflection and moments by small displacements, over the square of the deflection as
# a fraction of the length; measured on elasticas with play (studies/large_deflections.py).
TIP_ERROR, MOMENT_ERROR = 1.1, 0.65
# Number of periods of the boom beyond which a run is too long for a design.
MANY_PERIODS = 1000.0
# Ratio of a mode's frequency to the pendulum's frequency above which the mode belongs to the boom.
APART = 1.2
# Coriolis forces matter above this ratio of the angular speed to the first circular frequency.
SLOW = 0.05
# Fraction of a lateral play above which a caution on bulging walls that close the play is given.
BULGED = 0.1
# Error by the straight path of the tip, over the range of the tip, above which a caution is given.
LARGE_PATH_ERROR = 0.05
# The angle of a pendulum is not small above this ratio of its swing to its length.
SMALL_SWING = 0.2
# Relative error of a reduction or a mesh above which a caution is given.
MAX_RELATIVE_ERROR = 0.01


def walls(context: Context) -> Iterator[str]:
    """Yield the share of soft walls in the tip deflection of the beam, remedies, and a note."""
    if not context.rows or context.beam is None:
        return
    yield from wall_shares(context)
    # A negative share, of lateral pads that close the play, needs no remedy.
    large = (context.wall_part or 0.0) >= LARGE_SHARE
    if large and (better := remedies(context.case, context.beam)):
        yield Sentence(
            "Remedies, each with the static tip deflection that it gives under these loads (for "
            "local plate stresses, run a shell with the remedy):"
        )
        yield from (Sentence(f"- {milli(tip)} mm: {what}") for tip, what in better)
    if note := rigid_wall_note(context.case.models, context.boom):
        yield Sentence(note)


def wall_shares(context: Context) -> Iterator[str]:
    """Yield the share of soft walls or sections in the tip deflection, a caution if they govern."""
    beam, part = context.beam, context.wall_part
    if beam is None or part is None or abs(part) < NO_SHARE:
        return
    (what, where), (time, tip) = beam.boom.yielding.split(maxsplit=1), largest_tip(beam)
    how, source = ("distort", "a frame of plates") if what == "sections" else ("bend", "plates")
    sentence = (
        f"{what} {how} {where}, which moves the tip by {milli(part * tip)} of {milli(tip)} mm, "
        f"{percent(part, 2)}, under the loads at t = {time:.4g} s (estimate from {source})."
    )
    yield (
        sentence
        if abs(part) > GOVERNING_SHARE
        else Sentence(f"{sentence[0].upper()}{sentence[1:]}")
    )


def stick_slip(context: Context) -> Iterator[str]:
    """Yield a caution for each drive that sticks and slips even at its largest speed."""
    system = context.case.system
    for drive in context.drives:
        if drive.critical_speed <= drive.max_speed:
            continue
        remedy = "has no damping; give it a dashpot"
        if drive.critical_speed < inf:
            remedy = (
                f"moves smoothly from {system.text(drive.critical_speed, 'm/s', 3)} on; increase "
                "the speed, the stiffness or the damping"
            )
        yield (
            f"the drive of {drive.inner!r} sticks and slips during its whole travel: it moves at "
            f"{system.text(drive.max_speed, 'm/s', 3)} at most, and {remedy}"
        )


def lag(context: Context) -> Iterator[str]:
    """Yield a caution for each segment with a large lag behind its drive."""
    boom, data, system = context.boom, context.data, context.case.system
    for index, joint in enumerate(boom.joints, start=1):
        name = "drive_lag" if index == 1 else f"drive_lag-{index}"
        if name not in data:
            continue
        lag, overlap = float(np.abs(data[name]).max()), boom.smallest_overlap(joint)
        if lag > MAX_LAG * overlap:
            yield (
                f"{boom.segments[joint.inner].name!r} lags up to {system.text(lag, 'm')} behind "
                f"its drive, more than {TO_PERCENT * MAX_LAG:g} % of the "
                f"{system.text(overlap, 'm')} of overlap: the motion across the boom follows the "
                "drive and neglects the lag"
            )


def failures(context: Context) -> Iterator[str]:
    """Yield the reason of each failed model."""
    yield from (Sentence(f"failed: {name}: {why}") for name, why in context.failures.items())


def buckling(context: Context) -> Iterator[str]:
    """Yield a caution for each model whose axial forces are close to buckling."""
    for state in context.states:
        factor = state.critical_factor
        if factor is not None and factor * NEAR_BUCKLING < 1.0:
            yield (
                f"{state.where} the axial forces are {100.0 / factor:.3g} % of those under which "
                "the boom buckles, more than a third: deflections grow out of proportion"
            )


def deflections(context: Context) -> Iterator[str]:
    """Yield errors of large deflections by small displacements, cautions if they are large."""
    for where, what, tip, end in _deflections(context):
        part = abs(tip) / (end - context.boom.segments[0].start)
        if part > TOLD_DEFLECTION:
            sentence = f"{where} the tip {what} {tip:.3g} m, {deflection_error(part)}"
            if part > LARGE_DEFLECTION:
                yield f"{sentence}; {_advice(context, where)}"
            else:
                yield Sentence(f"{sentence[0].upper()}{sentence[1:]}, on the safe side.")


def deflection_error(part: float) -> str:
    """Return a clause on the errors of a tip deflection, a fraction of the boom's length."""
    return (
        f"{100.0 * part:.2g} % of the boom's length: small displacements make it about "
        f"{100.0 * TIP_ERROR * part**2:.2g} % too large, and moments about "
        f"{100.0 * MOMENT_ERROR * part**2:.2g} %"
    )


def _deflections(context: Context) -> Iterator[tuple[str, str, float, float]]:
    """Yield source, verb, tip deflection and x of the tip in m, of each state and motion.

    Of load cases and combinations it is the one with the largest deflection for its length.
    """
    end = context.boom.tip
    for state in context.states:
        if state.tip is not None:
            yield state.where, "rests at", state.tip, end
    for row in (context.rows or Rows()).where(state=REST, quantity="tip"):
        if row.time:
            yield f"under the loads at t = {row.time:.4g} s", "rests at", row.value, end
    start, combined = context.boom.segments[0].start, context.combined.where(quantity="tip")
    if combined:
        worst = max(combined, key=lambda row: abs(row.value) / ((row.x or end) - start))
        name = worst.state.removeprefix(COMBINATION)
        yield f"under the loads of {name!r}", "is at", worst.value, worst.x or end
    if "tip" in context.data:
        tips = context.data["tip"]
        moves = np.abs(tips.values).max(axis=1).tolist()
        for name, move in zip(tips["model"].values, moves, strict=True):
            yield f"in {name}", "moves by", move, end


def _advice(context: Context, where: str) -> str:
    """Return the advice to change the pads if walls or sections govern, else to check the units."""
    rigid = {f"in {model.name}" for model in context.case.models if not model.needs_shell}
    governing = where not in rigid and (context.wall_part or 0.0) > GOVERNING_SHARE
    if not governing or context.beam is None:
        return "check units and loads"
    return f"{context.beam.boom.yielding} cause most of it; change the pads"


def durations(context: Context) -> Iterator[str]:
    """Yield a caution if the run is shorter than one period, or has very many periods."""
    duration = context.case.time.duration
    for frequency, where in _frequencies(context)[:1]:
        periods, run = duration * frequency, f"time.duration: the run of {duration:g} s"
        if periods > MANY_PERIODS:
            yield (
                f"{run} has {periods:.3g} periods {where}; if the duration is in ms, give "
                f"{1e-3 * duration:g} s"
            )
        elif periods < 1.0:
            yield (
                f"{run} is shorter than one period {where}, {1.0 / frequency:.3g} s; usual are "
                "three periods at least"
            )


def turning(context: Context) -> Iterator[str]:
    """Yield a caution if slewing or luffing is so fast that Coriolis forces on the boom matter."""
    least = APART * pendulum_frequency(context.case)
    bending = [frequency for frequency in _frequencies(context) if frequency[0] > least]
    for frequency, where in bending[:1]:
        for key, _, law in motion_laws(context.case):
            part = np.deg2rad(fastest_turn(law)) / (2.0 * np.pi * frequency)
            if part > SLOW:
                yield (
                    f"{key}: the boom turns with {100.0 * part:.3g} % of its first circular "
                    f"frequency {where}; beyond 5 % the neglected Coriolis forces of its "
                    "vibration are significant"
                )


def _frequencies(context: Context) -> list[tuple[float, str]]:
    """Return all natural frequencies in Hz with their sources, in ascending order."""
    return sorted((hertz, state.where) for state in context.states for hertz in state.frequencies)


def axial_stresses(context: Context) -> Iterator[str]:
    """Yield cautions on wall stresses of shells if axial forces vary along a segment."""
    boom = context.boom
    numbers = range(len(boom.joints))
    if any(moving_force(boom.segments, boom.joints, number) for number in numbers):
        for name in (name for name, model in context.models.items() if model.stress is not None):
            yield (
                f"the walls of {name} carry the axial forces of the initial extension: their "
                "stresses and utilisations neglect the change of axial forces by drives, unlike "
                "stresses of outer fibres"
            )


def bulges(context: Context) -> Iterator[str]:
    """Yield a caution for each model at rest whose bulging walls reduce lateral plays."""
    for state in context.states:
        plays = [(row.value, row.limit, f"x = {row.x:g} m") for row in state.closed if row.limit]
        parts = [
            f"{TO_MILLI * closed:.2g} of {TO_MILLI * play:g} mm at {where}"
            for closed, play, where in plays
            if BULGED * play < closed < play
        ]
        if pressed := [where for closed, play, where in plays if closed >= play]:
            parts.append(f"all of it at {', '.join(pressed)}, where pads on both sides press")
        if parts:
            yield (
                f"{state.where}, static pad forces make walls bulge, which closes lateral play in "
                f"corners: {', '.join(parts)}; beams with rigid walls do not show this"
            )


def straight_path(context: Context) -> Iterator[str]:
    """Yield a caution if the straight path of a tip with a hanging load causes a large error."""
    error = 0.0
    if context.case.hoist is not None and context.beam is not None:
        with suppress(*NUMERICAL_ERRORS):
            vibrating = static_states(context.case, context.beam.boom, beam_of)
            error = straight_path_error(context.case, vibrating)
    if error > LARGE_PATH_ERROR:
        yield (
            "hoist: under large deflections the load lifts off later and oscillates more slowly "
            f"than in the models: the tip's motion is off by about {TO_PERCENT * error:.2g} % of "
            "its range; static states are not affected"
        )


def utilisations(context: Context) -> Iterator[str]:
    """Yield a caution for each static utilisation above 1."""
    for row in (context.rows or Rows()).where(state=REST):
        if (used := row.utilisation or 0.0) > 1.0 and row.of.limit:
            yield (
                f"static utilisation under the loads at t = {row.time:.4g} s: {100.0 * used:.3g} % "
                f"by {row.of.title} ({row.part}, x = {row.x:.4g} m): exceeds {row.of.limit}"
            )


def pulling_cylinders(context: Context) -> Iterator[str]:
    """Yield the largest force of each cylinder that pulls, at rest and in combinations."""
    system = context.case.system
    rows = Rows([*(context.rows or Rows()).where(state=REST), *context.combined])
    forces = [row for row in rows.where(quantity="cylinder_force") if row.value < 0.0]
    for part in dict.fromkeys(row.part for row in forces):
        most = min((row for row in forces if row.part == part), key=lambda row: row.value)
        name = most.state.removeprefix(COMBINATION)
        where = "at rest" if most.state == REST else f"under the loads of {name!r}"
        cylinder = context.boom.cylinders[int(part.partition(" ")[2] or 1) - 1]
        if (area := cylinder.oil_area(pulls=True)) is not None:
            where = f"on the ring of bore less rod, {system.text(area, 'm^2')}, {where}"
        told = f"{part[0].upper()}{part[1:]} pulls with {amount(-most.value, 'N')} {where}."
        if cylinder.resistance(pulls=True) is None:
            missing = next(key for key in ("pressure", "bore", "rod") if not getattr(cylinder, key))
            told += f" The pull is not proved: it has no `{missing}`."
        yield Sentence(told)


def panels(context: Context) -> Iterator[str]:
    """Yield a caution for each wall that buckles under the loads at rest."""
    for row in weakest_plates(context.rows or Rows()):
        if row.value < 1.0:
            yield (
                f"the wall {row.place!r} of {row.part!r} buckles at {number(row.value, 3)} times "
                f"the loads at rest, at x = {context.case.system.text(row.x or 0.0, 'm')} (panel "
                "formulas)"
            )


def limits(context: Context) -> Iterator[str]:
    """Yield a sentence on each limit of a case, a caution if a static result exceeds it."""
    if context.rows is None or context.case.limits is None:
        return
    # Imported late, since the results of a run take half a second.
    from protractile.runs.pipeline.quantities import case_limits

    for limit in case_limits(context.case, context.boom):
        at_rest = limit.quantity.name == "tip_at_rest"
        name = "tip" if at_rest else limit.quantity.name
        row = context.rows.where(state=REST, quantity=name).largest
        if row is None:
            yield Sentence(f"Limit {limit}: a run decides.")
            continue
        largest, title = abs(row.value), limit.quantity.title
        combined = limit_in_combinations(limit, context.combined, context.case)
        what = title if at_rest else f"static {title} (maximum load)"
        static = f"the {what} is {limit.format(largest)}"
        if not limit.is_met_by(largest):
            yield f"the limit {limit} is exceeded: {static}"
        elif combined and not combined[2].is_met_by(combined[1]):
            name, most, own = combined
            yield f"the limit {own} is exceeded under the loads of {name}: {own.format(most)}"
        elif at_rest and context.boom.telescopes:
            yield Sentence(f"Limit {limit}: {static} at the extension at t = 0; a run decides.")
        elif at_rest:
            met = f"Limit {limit}: met in this case, {limit.format(largest)}"
            if combined:
                met += f", and in combinations that demand it, {limit.format(combined[1])} at most"
            yield Sentence(f"{met}.")
        else:
            yield Sentence(f"Limit {limit}: {static}, and the motion adds to it; a run decides.")


def swings(context: Context) -> Iterator[str]:
    """Yield a caution for each model whose hanging load swings by a large angle."""
    hoist = context.case.hoist
    for name in ("swing_out", "swing_aside"):
        if name not in context.data:
            continue
        data, length = context.data[name], hoist.pendulum if hoist and hoist.pendulum else np.inf
        ratios = np.abs(data.values).max(axis=1) / length
        for model, ratio in zip(data["model"].values, ratios, strict=True):
            if ratio > SMALL_SWING:
                yield (
                    f"hoist.pendulum: in {model} the load swings by "
                    f"{np.rad2deg(np.arctan(ratio)):.3g} degrees; its model is for small angles"
                )


def accuracy(context: Context) -> Iterator[str]:
    """Yield cautions on shells with large errors by their reduction or their mesh."""
    # Shells whose mesh follows from contact_tolerance near contacts.
    refined = {
        shell.name
        for shell in select_kind(Shell, context.case.models)
        if shell.contact_tolerance != "any" and shell.contact_line != "surface"
    }
    for name, model in context.models.items():
        if (error := model.reduction_errors.get("contact_compliance") or 0.0) > MAX_RELATIVE_ERROR:
            yield (
                f"the reduction of {name} to {model.modes} coordinates has an error of "
                f"{TO_PERCENT * error:.2g} % of the local contact compliance; allow more modes, or "
                "--modes auto"
            )
        if (error := model.reduction_error or 0.0) > MAX_RELATIVE_ERROR:
            yield (
                f"the reduction of {name} may change the tip's motion by "
                f"{TO_PERCENT * error:.2g} % of its range, since friction depends on vibrations of "
                f"its plates; {_remedy(context.case, name)}"
            )
        if (error := model.mesh_error or 0.0) > MAX_RELATIVE_ERROR:
            yield (
                f"the mesh of {name} causes an error of {TO_PERCENT * error:.2g} % of the local "
                "contact compliance; give a smaller "
                f"{'contact_tolerance' if name in refined else 'mesh_size'}"
            )


def _remedy(case: Case, name: str) -> str:
    """Return what makes the motion of a reduced shell more accurate."""
    (shell,) = (model for model in select_kind(Shell, case.models) if model.name == name)
    finer = "a smaller tolerance" if shell.modes == "auto" else "more modes"
    damped = case.damping.modal or case.damping.mass or case.damping.stiffness
    return f"give {finer}" if damped else f"give damping, which ends these vibrations, and {finer}"

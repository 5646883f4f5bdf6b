# SPDX-License-Identifier: LGPL-3.0-or-later
"""Output of ``check``: tables and sentences on the data of a case.

Beams replace shells here.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from io import StringIO
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console

from protractile.analysis.measure import measure_boom
from protractile.analysis.plate_buckling import measure_plates, weakest_plates
from protractile.analysis.rows import (
    BEAM,
    FARTHEST,
    REST,
    Row,
    Rows,
    extremes,
    static_rows,
)
from protractile.analysis.states import States
from protractile.beam_model.statics import StaticState
from protractile.dynamics.damping import closed_contact_damping
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.motion import constant_load_equilibrium
from protractile.geometry.arrays import Array
from protractile.geometry.axial import axial_force, moving_force_places
from protractile.geometry.boom import Boom
from protractile.geometry.typography import amount, milli, number, without_round_off
from protractile.geometry.units import System
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case, Model
from protractile.runs.cautions.context import Context, State
from protractile.runs.cautions.rules import cautions
from protractile.runs.pipeline.combinations import combination_rows
from protractile.runs.pipeline.drives import drive_lines, stick_slip_lines
from protractile.runs.pipeline.estimates import Preview, run_cost
from protractile.runs.pipeline.statics import (
    Statics,
    cylinder_force,
    first_frequency,
    reaction_rows,
    statics,
)
from protractile.runs.pipeline.turning import shaper_lines, turning_lines
from protractile.runs.process.terminal import Progress, ignore_progress
from protractile.runs.report.boom_tables import (
    joint_table,
    mass_table,
    panel_table,
    segment_table,
    stiffener_table,
)
from protractile.runs.report.load_table import load_table
from protractile.runs.report.static_tables import beam_note, combination_tables, static_table
from protractile.runs.report.tables import WIDE, Cell, Column, Table, print_text

if TYPE_CHECKING:
    import pandas as pd

# Number of modes in the table of damping.
SHOWN_MODES = 3

# Distance of a section from a jump of the axial force, as a fraction of the segment length.
_BESIDE = 1.0e-9

# Damping ratio below which values count as zero.
_ROUND_OFF = 1.0e-12

_BEAMS = "in the beam estimate"

# Beginnings of the sentences that decide.
_FIRST = "caution: ", "Limit "


@dataclass(frozen=True, slots=True, repr=False)
class Check:
    """Tables of a checked case, and sentences on its static state."""

    title: str  #: title of the case
    deciding: Sequence[Table]  #: tables of static results under the largest loads
    inputs: Sequence[Table]  #: tables of parts, loads, reactions, buckling and modes
    lines: Sequence[str]  #: sentences and cautions, those on limits and cautions first

    @property
    def tables(self) -> list[Table]:
        """All tables, each with at least one row."""
        return [*self.deciding, *self.inputs]

    @property
    def frames(self) -> dict[str, pd.DataFrame]:
        """The tables by title, with numbers in displayed units."""
        return {table.title: table.flat_frame for table in self.tables}

    def show(self, console: Console, whole: bool = False) -> None:
        """Print cautions, deciding tables and sentences; the ``whole`` has the other tables too."""
        print_text(console, self.title)
        first = [line for line in self.lines if line.startswith(_FIRST)]
        for line in first:
            print_text(console, line)
        for table in self.deciding:
            table.show(console)
        for line in self.lines[len(first) :]:
            print_text(console, line)
        for table in self.inputs if whole else ():
            table.show(console)

    def __repr__(self) -> str:
        text = StringIO()
        self.show(Console(file=text, width=WIDE), whole=True)
        return text.getvalue()

    def _repr_html_(self) -> str:
        lines = "".join(f"<li>{escape(line)}</li>" for line in self.lines)
        tables = "".join(table._repr_html_() for table in self.tables)
        return f"<h3>{escape(self.title)}</h3>{tables}<ul>{lines}</ul>"


def check_case(checked: CheckedCase, progress: Progress = ignore_progress) -> Check:
    """Return the tables and sentences that ``check`` prints."""
    case, boom, preview = checked.case, checked.boom, Preview(checked)
    static, context = statics(case, boom), Context(case, boom)
    beam = None if static is None else context.beam
    context.rows, context.combined = Rows(), combination_rows(case, progress)
    if beam is not None:
        plates = extremes(measure_plates(beam), BEAM, REST)
        context.rows = Rows([*static_rows(beam, BEAM), *plates])
    factors = {
        _beam_name(model): model.coarsen(boom).critical_factor(checked.model_boom(model))
        for model in (case.models if boom.compressed else ())
    }
    combined = [*combination_tables(context.combined, case)]
    deciding = [
        static_table(case, boom if static is None else static.with_play.boom, context.rows),
        *combined[:1],
    ]
    inputs = [
        *combined[1:],
        panel_table(weakest_plates(context.rows), case.system),
        _buckling(case, boom, factors),
        segment_table(case, boom),
        stiffener_table(boom, case.system),
        joint_table(case, boom),
        _models(case, boom),
        mass_table(boom, case.system),
        load_table(case, boom),
        axial_forces(boom, static),
        _damping_ratios(preview),
        *([_reactions(static.with_play, case.system)] if static else []),
        *([_cylinders(static.with_play, case.system)] if static else []),
    ]
    lines = [*drive_lines(boom, case.system), *stick_slip_lines(context.drives, case.system)]
    lines += [*turning_lines(case), *_shaper_lines(preview)]
    context.states = [State(f"in {name}", factor) for name, factor in factors.items()]
    if static is None or beam is None:
        lines.append("There is no static equilibrium under the loads at t = 0.")
    else:
        hertz = [first_frequency(case, model) for model in static]
        lines += _static_lines(static, beam, hertz)
        closed = context.rows.where(state=REST, quantity="closed_play")
        context.states.append(State(_BEAMS, None, static.with_play.tip, hertz[:1], closed))
    lines += cautions(context)
    lines.append(f"A run may take {run_cost(case, preview)}.")
    # Sorting keeps the order of lines of the same kind.
    lines = sorted(map(case.system.convert, lines), key=lambda line: not line.startswith(_FIRST))
    deciding, inputs = ([table for table in tables if table.rows] for tables in (deciding, inputs))
    return Check(case.title, deciding, inputs, lines)


def _beam_name(model: Model) -> str:
    return f"{model.name} (beam estimate)" if model.needs_shell else model.name


def _models(case: Case, boom: Boom) -> Table:
    rows = []
    for model in case.models:
        joints = model.model_boom(boom).boom.joints
        laws = [str(joint.contact) for joint in joints]
        if len({*laws}) > 1:
            names = [boom.segments[joint.inner].name for joint in joints]
            laws = [f"{name}: {law}" for name, law in zip(names, laws, strict=True)]
        contact = "bonded" if model.bonded else "\n".join(dict.fromkeys(laws))
        rows.append((model.name, model.kind, model.describe(), contact))
    headings = ("model", "kind", "description", "contact of inner\nsegment, k in N/mⁿ")
    return Table.of_rows("", "Models", headings, rows)


def axial_forces(boom: Boom, static: Statics | None) -> Table:
    """Return the table of each segment's extreme axial force, positive in tension.

    ``static`` gives the cylinder forces; it is None without an equilibrium.
    """
    if not boom.compressed and not boom.cylinders:
        return Table("", [])
    state = static.with_play if static else None
    extremes = [_extreme_axial_force(boom, i, state) for i in range(len(boom.segments))]
    columns = [
        Column("segment", [segment.name for segment in boom.segments]),
        Column("axial force", without_round_off([-force for force, _ in extremes]), ".4g", "kN"),
        Column("axial stress", [stress and -stress for _, stress in extremes], ".4g", "MPa"),
    ]
    note = "Includes the cylinder forces at t = 0."
    if boom.telescopes:
        note = "Extreme values over all extensions, with the cylinder forces at t = 0."
    notes = [note] if boom.cylinders else []
    return Table("Extreme axial forces, tension positive", columns, notes)


def _extreme_axial_force(
    boom: Boom, number: int, state: StaticState | None
) -> tuple[float, float | None]:
    """Return the extreme axial force of a segment in N and stress in Pa, over all extensions."""
    segment = boom.segments[number]
    cylinders = [
        (cylinder, cylinder_force(state, k))
        for k, cylinder in enumerate(boom.cylinders, start=1)
        if cylinder.segment == number and state is not None
    ]
    jumps = {*segment.compression.places, *moving_force_places(boom.segments, boom.joints, number)}
    if cylinders and segment.foot is not None:
        jumps |= {segment.foot.x, *(cylinder.x for cylinder, _ in cylinders)}
    ends = [x + side * _BESIDE * segment.length for x in jumps for side in (-1.0, 1.0)]
    x = np.unique(np.clip([*ends, segment.start, segment.end], segment.start, segment.end))
    times = [joint.drive.times for joint in boom.joints if joint.drive is not None]
    times += [change.times for change in boom.axial_changes]
    time = np.unique(np.concatenate([np.zeros(1), *times]))
    forces = axial_force(boom.segments, boom.joints, number, x, time, boom.axial_changes)
    for cylinder, force in cylinders:
        forces = forces - force * cylinder.normal_force(x, segment.foot)
    largest = float(forces.flat[np.abs(forces).argmax()])
    if segment.section is None:
        return largest, None
    stresses = forces / [segment.section_at(at).area for at in x]
    return largest, float(stresses.flat[np.abs(stresses).argmax()])


def _buckling(case: Case, boom: Boom, factors: Mapping[str, float | None]) -> Table:
    """Return the table of the buckling factors of models, by name."""
    shares = [factor and 1.0 / factor for factor in factors.values()]
    columns = [
        Column("model", [*factors]),
        Column("buckling factor", [*factors.values()], ".4g"),
        Column("axial force over\ncritical force", shares, ".3g", "%"),
    ]
    walls = (
        "The factor of a shell is estimated by a beam with the contacts that are closed at t = 0, "
        f"and with elastic {boom.yielding}."
    )
    notes = [walls] if boom.yielding and case.first_shell else []
    return Table("Buckling under the axial forces, joints in contact", columns, notes)


def _damping_ratios(preview: Preview) -> Table:
    """Return the table of damping ratios of the first modes, with contacts closed as at rest."""
    case, boom = preview.checked.case, preview.checked.boom
    coefficients = [
        *case.damping.model_dump().values(),
        *(s.viscous_damping for s in boom.segments),
    ]
    coefficients += [joint.dashpot for joint in boom.joints]
    coefficients += [cylinder.dashpot for cylinder in boom.cylinders]
    coefficients += [support.dashpot for segment in boom.segments for support in segment.supports]
    # Some booms have fewer modes.
    rows = [
        [_beam_name(model), *_ratios(preview, model), *[""] * SHOWN_MODES][: 1 + SHOWN_MODES]
        for model in (case.models if any(coefficients) else ())
    ]
    headings = ("model", *(f"mode {number}" for number in range(1, SHOWN_MODES + 1)))
    note = f"In this table {boom.yielding} are rigid, also for shells."
    notes = [note] if boom.yielding else []
    return Table.of_rows("", "Damping ratios, joints in contact", headings, rows, notes)


def _ratios(preview: Preview, model: Model) -> list[str]:
    try:
        with np.errstate(all="ignore"):
            damping = closed_contact_damping(*_at_rest(preview, model))
    except NUMERICAL_ERRORS:
        return ["cannot be computed"]
    # Dashpots between open stations contribute only round-off.
    return [
        f"{100.0 * ratio if ratio > _ROUND_OFF else 0.0:.3g} % at {hertz:.3g} Hz"
        for hertz, ratio in zip(*damping, strict=True)
    ]


def _at_rest(preview: Preview, model: Model) -> tuple[GapSystem, Array | None]:
    """Return the gap system of the beam preview of a model, and its equilibrium (num_modes,)."""
    motion, at_rest = preview.motion(model), preview.checked.case.start.at_rest
    return motion.system, constant_load_equilibrium(motion.system, at_rest, motion.position)


def _shaper_lines(preview: Preview) -> Iterator[str]:
    """Yield sentences on input shapers for slewing and luffing, from modes of the first model."""
    case, (model, *_) = preview.checked.case, preview.checked.case.models
    if case.slew is None and case.luff is None:
        return
    with suppress(*NUMERICAL_ERRORS), np.errstate(all="ignore"):
        yield from shaper_lines(case, *_at_rest(preview, model))


def _reactions(state: StaticState, system: System) -> Table:
    """Return the table of support reactions, contact forces and contact penetrations."""
    at_place: dict[tuple[str, str], dict[str, Row]] = {}
    for row in reaction_rows(state):
        at_place.setdefault((row.part, row.place), {})[row.quantity] = row
    reactions = [rows["reaction"] for rows in at_place.values()]

    def cells(quantity: str) -> list[Cell]:
        rows = [of.get(quantity) for of in at_place.values()]
        return ["" if row is None else row.value for row in rows]

    along, forces = cells("axial_reaction"), [reaction.value for reaction in reactions]
    columns = [
        Column(
            "segment",
            [reaction.part + ", lug" * reaction.place.startswith("lug") for reaction in reactions],
        ),
        Column(
            f"x\n{system.label('m')}",
            [f"{system.of(reaction.x or 0, 'm'):g}" for reaction in reactions],
        ),
        Column("transverse\nforce", without_round_off(forces), ".4g", "kN"),
        *([Column("axial\nforce", along, ".4g", "kN")] if any(along) else []),
        Column("moment", cells("support_moment"), ".4g", "kN m"),
        Column("contact\npenetration", cells("penetration"), ".3g", "mm"),
    ]
    title = "Reactions of supports and contacts at rest, t = 0"
    signs = (
        "Forces act on the segment. Positive: towards the upper side of the boom, axial forces "
        "towards the tip, moments that turn the tip upwards."
    )
    return Table(title, columns, [signs, beam_note(state.boom)])


def _cylinders(state: StaticState, system: System) -> Table:
    """Return the table of lengths, lever arms and static forces of cylinders, a pair as one."""
    segments, metre = state.boom.segments, system.label("m")
    rows: list[tuple[Cell, ...]] = []
    notes = ["Cylinder forces are positive in compression."] if state.boom.cylinders else []
    for k, cylinder in enumerate(state.boom.cylinders, start=1):
        segment, force = segments[cylinder.segment], cylinder_force(state, k)
        arm = "" if segment.foot is None else system.of(cylinder.arm(segment.foot), "m")
        place, length = f"{system.of(cylinder.x, 'm'):g}", system.of(cylinder.length, "m")
        rows.append((segment.name, place, length, arm, force))
        if cylinder.extension is not None:
            said = f"Cylinder {k} is extended by {system.text(cylinder.extension, 'm')}"
            if cylinder.closed and cylinder.longest:
                said += f" of its stroke of {system.text(cylinder.longest - cylinder.closed, 'm')}"
            notes.append(f"{said}.")
        if (area := cylinder.oil_area(pulls=force < 0.0)) is not None:
            pressure = amount(abs(force) / area, "Pa")
            notes.append(f"Oil pressure of cylinder {k}: {pressure}.")
    lengths = (f"length\n{metre}", ".5g"), (f"lever arm\n{metre}", ".5g")
    columns = "cylinder of", f"x\n{metre}", *lengths, ("force", ".4g", "kN")
    return Table.of_rows("", "Cylinders at rest, t = 0", columns, rows, notes)


def _static_lines(static: Statics, beam: States, hertz: Sequence[float]) -> Iterator[str]:
    """Yield sentences on the static tip, the first frequencies in Hz, and joint rotations."""
    state, bonded = static
    soft = state.boom.yielding
    walls = f", with the compliance of {soft}" if soft else ""
    without = f"with bonded joints and rigid {soft.split()[0]}:" if soft else "without play"
    yield (
        f"Static tip deflection (t = 0) {_BEAMS}{walls}: {milli(state.tip)} mm; {without} "
        f"{milli(bonded.tip)} mm."
    )
    yield (
        f"First natural frequency, joints in contact, {_BEAMS}{walls}: {number(hertz[0], 4)} Hz; "
        f"{without} {number(hertz[1], 4)} Hz."
    )
    causes = f"Play and the {soft} rotate" if soft else "Play rotates"
    tilts = Rows(extremes(measure_boom(beam.largest("tip")), BEAM, FARTHEST))
    rotations, tips = (tilts.where(quantity=name) for name in ("rotation", "rotation_tip"))
    for angle, tip in zip(rotations, tips, strict=True):
        outer = angle.place.removeprefix("in ")
        yield (
            f"{causes} {angle.part!r} by {milli(angle.value)} mrad in {outer!r}, which moves the "
            f"tip by {milli(tip.value)} mm, under the loads at t = {angle.time:.4g} s."
        )

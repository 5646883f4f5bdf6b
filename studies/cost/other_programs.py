# SPDX-License-Identifier: LGPL-3.0-or-later
"""The time step, compared with other programs for motions with contact at equal error.

Each program runs a script of this folder in a separate interpreter. Tables omit programs that are
not installed, with the reason.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from protractile.dynamics.contact import PowerContact
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.report.tables import Cell, Table
from studies.cost.timing import time_in_turns
from studies.motions import OUTPUT_STEP, friction_case, gap_system, model_of, without_friction
from studies.reference_models import impacting_beam

FOLDER = Path(__file__).parent
OTHER_CODES = FOLDER.parents[1] / "build" / "other-codes" / "bin" / "python"

# Permitted errors of both programs, as fractions of the range of the tip.
LEVELS = (0.02, 0.004)
STEPS = (1.0e-3, 5.0e-4, 2.0e-4, 1.0e-4, 5.0e-5, 2.0e-5, 1.0e-5)
# Stiffness in N/m and damping in s/m of a contact that represents a restitution of 0.
SOFT = PowerContact(1.0e7, 1.0, damping=5.0)


class Program(NamedTuple):
    """Another program, with the path of its Python interpreter."""

    name: str
    module: str  #: name of the Python module
    python: Path  #: interpreter that can import the module
    remedy: str  #: instruction to install the program

    @property
    def installed(self) -> bool:
        """Whether the interpreter can import the program."""
        try:
            command = [str(self.python), "-c", f"import {self.module}"]
            return subprocess.run(command, capture_output=True, check=False).returncode == 0
        except FileNotFoundError:
            return False


@dataclass(frozen=True, slots=True)
class Problem:
    """One motion, computed by this program and by another program."""

    what: str
    program: Program
    script: str  #: script of this folder, which reads ``given`` and ``steps`` and prints runs
    given: Mapping[str, Any]
    steps: Sequence[float]  #: steps of the other program in s, descending
    #: function that returns positions (num_times, num_observed) by this program for a step in s
    move: Callable[[float], Array]
    exact: Array  #: converged positions

    def off(self, places: Array) -> float:
        """Return the largest error of positions, as a fraction of the range of the tip."""
        return float(np.abs(places - self.exact).max() / np.ptp(self.exact[:, -1]))

    def elsewhere(self) -> list[tuple[float, float, list[float]]]:
        """Return step in s, error and wall times in s of each run by the other program."""
        done = subprocess.run(
            [str(self.program.python), str(FOLDER / self.script)],
            input=json.dumps({**self.given, "steps": self.steps}),
            capture_output=True,
            text=True,
            check=True,
        )
        runs = json.loads(done.stdout.splitlines()[-1])
        return [(one["step"], self.off(np.array(one["places"])), [one["seconds"]]) for one in runs]

    def here(self, most: int, budget: float) -> list[tuple[float, float, list[float]]]:
        """Return step in s, error and wall times in s of each run by this program."""
        errors = [self.off(self.move(step)) for step in STEPS]
        seconds = time_in_turns([partial(self.move, step) for step in STEPS], most, budget)
        return list(zip(STEPS, errors, seconds, strict=True))


def telescoped_beams() -> Problem:
    """Return the motion of the paper's beams without friction, before it becomes chaotic."""
    duration, case = 0.3, friction_case()
    boom, (model,) = build_boom(case), select_kind(BeamElements, [model_of(case, "beam-fe")])
    system = without_friction(gap_system(case, boom, model))
    (joint,) = boom.joints
    assert model.contact is not None
    station = {"clearance": 0.5 * joint.play, "stiffness": model.contact.stiffness}
    length = model.element_length

    def move(step: float) -> Array:
        run = FixedStep(step)(Motion(system, duration, OUTPUT_STEP))
        return np.asarray(run.data["tip"].values)[:, None]

    beams = [
        {
            "nodes": np.arange(segment.start, segment.end + 0.5 * length, length).tolist(),
            "mass_per_length": segment.mass_per_length,
            "bending_stiffness": segment.material.youngs_modulus * segment.second_moment_of_area,
            "axial_stiffness": segment.material.youngs_modulus * segment.area,
            "load": segment.load,
            "supports": [support.x for support in segment.supports],
        }
        for segment in boom.segments
    ]
    stations = [{"x": x, **station} for x in joint.stations]
    given = {"beams": beams, "stations": stations, "duration": duration}
    program = Program("Exudyn", "exudyn", OTHER_CODES, "make other-codes installs it")
    return Problem(
        f"telescoped beams, {duration:g} s",
        program,
        "exudyn_beams.py",
        {**given, "output_step": OUTPUT_STEP},
        STEPS[:-1],
        move,
        move(2.5e-6),
    )


def ball_on_beam() -> Problem:
    """Return the motion of a ball on a cantilever, up to the first lift-off after chatter."""
    duration, step = 0.03, 1.0e-6
    mass, stiffness = impacting_beam.beam(impacting_beam.ELEMENTS)
    height = impacting_beam.HEIGHT
    motion = impacting_beam.falling(
        impacting_beam.ELEMENTS, SOFT.lower().with_clearance(height), duration
    )

    def move(step: float) -> Array:
        data = FixedStep(step)(motion).data
        return np.column_stack([data["ball"].values + height, data["tip"].values])

    given = {
        "mass": mass.tolist(),
        "stiffness": stiffness.tolist(),
        "height": height,
        "speed": impacting_beam.SPEED,
        "duration": duration,
        "output_step": motion.output_step,
    }
    program = Program(
        "Siconos", "siconos", Path("/usr/bin/python3"), "Debian has it as python3-siconos"
    )
    exact = impacting_beam.moreau_jean(step, duration)[:: round(motion.output_step / step)]
    steps = (1.0e-4, 2.0e-5, 5.0e-6)
    return Problem(
        f"ball on a beam, {1e3 * duration:g} ms", program, "siconos_ball.py", given, steps, move,
        exact,
    )  # fmt: skip


PROBLEMS = {"telescoped beams": telescoped_beams, "ball on a beam": ball_on_beam}


def other_programs(most: int, budget: float, problems: Sequence[str] = tuple(PROBLEMS)) -> Table:
    """Return the table of the largest step of each program for each permitted error, with costs.

    ``most`` and ``budget`` limit repetitions, as in :func:`studies.cost.timing.time_in_turns`.
    """
    rows: list[Sequence[Cell]] = []
    notes = [
        "The reference of beams is a run of protractile with steps of 2.5 µs, that of the ball "
        "the scheme of Moreau and Jean with steps of 1 µs. Exudyn's beams stretch, and its contact "
        "is a penalty. Siconos has an impact law with restitution 0, protractile a damped penalty.",
    ]
    for problem in (PROBLEMS[name]() for name in problems):
        program = problem.program
        if program.installed:
            rows += _at_levels(problem, problem.here(most, budget), problem.elsewhere())
        else:
            notes.append(f"{program.name} is left out: not installed; {program.remedy}.")
    columns = {
        "motion": "", "permitted error (%)": ".2g", "program": "", "step (s)": ".1g",
        "error (%)": ".2g", "wall time (s)": "", "ratio to protractile": ".2g",
    }  # fmt: skip
    title = "Other programs at equal error of the tip"
    return Table.of_rows("others", title, columns, rows, notes)


def _at_levels(
    problem: Problem,
    ours: Sequence[tuple[float, float, list[float]]],
    theirs: Sequence[tuple[float, float, list[float]]],
) -> Iterator[Sequence[Cell]]:
    """Yield a table row of each program for each permitted error that both reach."""
    for level in LEVELS:
        found = [next((run for run in runs if run[1] <= level), None) for runs in (ours, theirs)]
        if found[0] is None or found[1] is None:
            continue
        base = float(np.median(found[0][2]))
        names = ("protractile", problem.program.name)
        for name, run in zip(names, found, strict=True):
            assert run is not None
            step, off, seconds = run
            part = float(np.median(seconds)) / base
            yield problem.what, 100.0 * level, name, step, 100.0 * off, seconds, part

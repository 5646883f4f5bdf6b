# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cost of telescoping during a motion.

The paper's boom extends by 4 m during the motion. The reference is the same boom with the same pads
at a fixed extension.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.util import find_spec
from time import process_time
from typing import Any, NamedTuple

from protractile.cases import change
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.report.tables import Table
from studies.motions import OUTPUT_STEP, gap_system, model_of, move

CASE = CASES / "drawn-out.toml"
MODELS = ("kantorovich-5", "beam-fe", "timoshenko", "shell")
DURATION = 10.0

# Goals: processor time as a multiple of that at a fixed extension.
BEAM_GOAL, SHELL_GOAL = 3.0, 5.0

# Lateral resistance: prescribed normal forces of pads in N, or dashpots in N·s/m.
RESISTED: Mapping[str, Mapping[str, Any]] = {
    "nothing": {},
    "friction": {"joint.normal_forces": [450.0, 500.0]},
    "dashpots": {"joint.dashpot": 300.0},
}

_SHELL = Shell.model_validate(
    {"name": "shell", "kind": "shell", "mesh_size": 0.1, "contact_tolerance": "any"}
)
_PAD = 0.1


class Cost(NamedTuple):
    """Processor times in s of the construction and the motion of a system; number of modes."""

    modes: int
    built: float
    moved: float


def telescoping(models: Sequence[str] = MODELS, duration: float = DURATION) -> Table:
    """Return the processor time of motions of a duration in s, telescoping and at rest.

    The model ``shell`` is left out if FEniCSx is not installed.
    """
    asked = [name for name in models if name != "shell" or find_spec("dolfinx")]
    rows, worst = [], {True: 0.0, False: 0.0}
    for name in asked:
        for resisted, values in RESISTED.items():
            moving, resting = (_cost(case, name) for case in _cases(duration, values))
            ratio = moving.moved / resting.moved
            worst[name == "shell"] = max(worst[name == "shell"], ratio)
            costs = (resting.modes, moving.modes, resting.moved, moving.moved, ratio)
            rows.append((name, resisted, *costs, resting.built, moving.built))
    columns = {
        "model": "", "resisted by": "", "modes at rest": ".0f", "drawn": ".0f", "at rest s": ".2f",
        "drawn out s": ".2f", "times": ".1f", "built at rest s": ".1f", "built drawn s": ".1f",
    }  # fmt: skip
    return Table.of_rows(
        "drawing",
        f"Drawn out by 4 m within {duration:g} s, processor time beside the same boom at rest",
        columns,
        rows,
        [
            f"At most {worst[of_shell]:.1f} times for {what}: the goal of {goal:g} is "
            f"{'reached' if worst[of_shell] <= goal else 'not reached'}."
            for of_shell, what, goal in (
                (False, "beams", BEAM_GOAL),
                (True, "the shell", SHELL_GOAL),
            )
            if worst[of_shell]
        ],
    )


def _cases(duration: float, values: Mapping[str, Any]) -> tuple[Case, Case]:
    """Return the cases with telescoping and at a fixed extension."""
    case = case_file.load(str(CASE))
    # Without a drive, friction of a planar boom needs given normal forces.
    joints = tuple(replace(joint, normal_forces=(0.0, 0.0)) for joint in case.joints)
    case = case.model_copy(update={"joints": joints})
    times = {"time.duration": duration, "joint.drive.time": duration}
    moving = change(case, **times, **values, **{"joint.contact_length": _PAD})
    still = tuple(replace(joint, drive=None) for joint in moving.joints)
    return moving, moving.model_copy(update={"joints": still})


def _cost(case: Case, name: str) -> Cost:
    model = _SHELL if name == _SHELL.name else model_of(case, name)
    begin = process_time()
    system = gap_system(case, build_boom(case), model)
    built = process_time() - begin
    # The first output compiles the time loop.
    move(system, OUTPUT_STEP)
    begin = process_time()
    move(system, case.time.duration)
    return Cost(system.num_modes, built, process_time() - begin)

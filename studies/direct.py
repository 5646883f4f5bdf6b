# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reduced shell, compared with the unreduced shell and another time integrator.

The motion of the paper's boom with friction is regular. On one mesh, the study integrates all
degrees of freedom by the generalised-α method with decreasing steps, and the reduced shell by the
program's integrator. A reduction with more coordinates separates the error of reduction from that
of integration. The cases are the paper's load with contact near webs, and ten times this load with
pads.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from time import perf_counter
from typing import NamedTuple

import numpy as np
from mpi4py import MPI

from protractile.dynamics.energy import ENERGY_BOUND
from protractile.geometry.arrays import Array
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.models import MotionPlan
from protractile.runs.report.tables import Table
from studies.motions import (
    STEP,
    friction_case,
    gap_system,
    scale_loads,
    set_duration,
    shell_of,
    with_pads,
)
from studies.study import Criterion, Piece, Progress, Verification, define_study

# Permitted error of the tip as a fraction of its range.
ALLOWED = 0.005

METHOD = "all degrees of freedom, generalised-α (Chung and Hulbert 1993)"

# Length and width in m of the pads, and ratio of their load to the paper's.
PAD, LOAD = (0.1, 0.06), 10.0

NOTE = (
    "Where a station presses and sticks at once, the sum of both forces moves the boom; how they "
    "share it until the next slip hangs on frequencies far above its motion."
)


class Sizes(NamedTuple):
    """Parameters of the study."""

    mesh: float = 0.2  #: edge length in m
    duration: float = 1.0  #: duration of the motion in s
    #: Steps of the direct integration in s, fractions of the output step, each half the previous
    #: one.
    steps: Sequence[float] = (1.0e-3, 5.0e-4, 2.5e-4, 1.25e-4, 6.25e-5)
    #: Steps in s of the boom with pads under ``LOAD`` times the load.
    hard_steps: Sequence[float] = (2.5e-4, 1.25e-4)
    hard_duration: float = 1.0  #: duration of that motion in s
    #: Options of the reduction with more coordinates.
    shifts: tuple[float, ...] = (5.0, 50.0, 300.0, 1500.0, 8000.0, 40000.0)
    moments: int = 5


class Run(NamedTuple):
    """Motion of one model with one step."""

    how: str  #: model and integrator
    unknowns: int  #: degrees of freedom, or modal coordinates
    step: float  #: time step in s
    tip: Array  #: (num_times,) in m
    impulse: float  #: impulse of all contact forces in N·s
    energy_residual: float  #: energy residual as a fraction of the work
    seconds: float  #: wall time of the motion


def runs_of(case: Case, steps: Sequence[float], sizes: Sizes, progress: Progress) -> list[Run]:
    """Return motions of the reduced shell, of one with more coordinates, and of the full shell.

    The case is planar, with prescribed normal forces. ``steps`` of the full shell in s descend.
    """
    from protractile.shell_model.boom_shell import ShellOptions, assemble_boom
    from protractile.shell_model.reduced_shell import reduce_boom
    from protractile.shell_model.reduction.krylov import KrylovOptions
    from studies.reference_models.unreduced import integrate_directly

    case = set_duration(case, sizes.duration)
    boom, output_step = build_boom(case), case.time.output_step
    model = shell_of(case).model_copy(update={"mesh_size": sizes.mesh, "contact_tolerance": "any"})
    seen = model.model_boom(boom).boom
    krylov = KrylovOptions(sizes.shifts, sizes.moments)
    options = ShellOptions(sizes.mesh, contact_line=model.contact_line)
    finer = replace(options, krylov=krylov)

    def impulse(forces: Array) -> float:
        return float(np.abs(forces).sum()) * output_step

    progress("the reduced shell")
    larger = reduce_boom(seen, finer, MPI.COMM_SELF).system
    found = []
    for how, system in (
        ("reduced", gap_system(case, boom, model)),
        ("reduced, more coordinates", larger),
    ):
        plan = MotionPlan.of(system, case, model.model_copy(update={"step": STEP}))
        plan.warm()
        start = perf_counter()
        motion = plan.trajectory(lambda part: None)
        seconds, data = perf_counter() - start, motion.data
        tip, pushed = np.asarray(data["tip"].values), impulse(data["contact_force"].values)
        taken, residual = float(data.attrs["step"]), motion.energy_residual
        found.append(Run(how, system.num_modes, taken, tip, pushed, residual, seconds))
    full = assemble_boom(seen, options, MPI.COMM_SELF)
    for step in steps:
        progress(f"the unreduced shell, step {step:g} s")
        start = perf_counter()
        direct = integrate_directly(full, sizes.duration, step, output_step)
        seconds = perf_counter() - start
        tip, residual = direct.observed["tip"], direct.energy_residual
        pushed = impulse(direct.contact_forces)
        found.append(Run("unreduced", full.num_dofs, direct.step, tip, pushed, residual, seconds))
    return found


def compare(runs: Sequence[Run], name: str, where: str, sizes: Sizes) -> Iterator[Piece]:
    """Compare the motions of the full shell with those of both reduced shells.

    ``runs`` are results of :func:`runs_of`; ``where`` is the type of contact, and the load.
    """
    from studies.reference_models.unreduced import LOSS_BOUND

    reduced, larger, *direct = runs
    off, off_larger = (
        [float(np.abs(run.tip - other.tip).max() / np.ptp(reduced.tip)) for run in runs]
        for other in (reduced, larger)
    )
    # Order of each halving, and the order of all by least squares.
    halvings = np.log2(np.divide(off_larger[2:-1], off_larger[3:]))
    steps = [run.step for run in direct]
    order = float(np.polyfit(np.log(steps), np.log(off_larger[2:]), 1)[0])
    columns = {
        "shell": "", "unknowns": ".0f", "step (µs)": ".4g", "off the reduced (%)": ".2g",
        "off more coordinates (%)": ".2g", "order": ".2f", "contact impulse (N s)": ".4g",
        "energy residual": ".2g", "wall (s)": ".2g",
    }  # fmt: skip
    yield Table.of_rows(
        name,
        f"The reduced shell against the unreduced one, {where}, mesh of {sizes.mesh:g} m",
        columns,
        [
            (run.how, run.unknowns, 1.0e6 * run.step, 100.0 * one, 100.0 * other, halving,
             run.impulse, run.energy_residual, run.seconds)
            for run, one, other, halving in zip(
                runs, off, off_larger, [None, None, None, *halvings], strict=True
            )
        ],
        (
            f"Largest difference of the tip over {sizes.duration:g} s, in parts of its range. The "
            "unreduced shell goes by the generalised-α method (Chung and Hulbert 1993), which is "
            "of second order until a row closes, opens or turns within a step: that event is "
            f"misplaced in the step. The mean order is {order:.2f}.",
            NOTE,
        ),
    )  # fmt: skip
    on = f"{where}, mesh of {sizes.mesh:g} m, {sizes.duration:g} s"
    method: Criterion = ("other code", METHOD, ALLOWED)
    tips = f"tip of the reduced shell off the unreduced one, part of its range, {on}"
    yield Verification(tips, off[-1], 0.0, "", *method, order)
    for run, bound in ((reduced, ENERGY_BOUND), (direct[-1], LOSS_BOUND)):
        what = f"energy residual of the {run.how} shell, {on}"
        conserved: Criterion = ("analytic", "conservation of energy", bound)
        yield Verification(what, run.energy_residual, 0.0, "", *conserved)


@define_study("direct", "The reduction against the full order")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Compare the unreduced and the reduced shell of the paper's boom."""
    sizes = sizes or Sizes()
    case = friction_case()
    runs = runs_of(case, sizes.steps, sizes, progress)
    yield from compare(runs, "direct-webs", "near webs", sizes)
    hard = f"pads of {PAD[0]:g} m x {PAD[1]:g} m, load x {LOAD:g}"
    sizes = sizes._replace(duration=sizes.hard_duration)
    runs = runs_of(scale_loads(with_pads(case, *PAD), LOAD), sizes.hard_steps, sizes, progress)
    yield from compare(runs, "direct-pads", hard, sizes)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The reduced shell against the unreduced one, moved by another integrator.

The paper's boom with friction, whose motion is regular: on one mesh, all degrees of freedom by the
generalised-α method with ever shorter steps, and the reduction by the splitting. A reduction with
more coordinates tells what is left of the difference to the one, and what to the other. Once as the
paper loads it, near webs, and once with pads under ten times the load.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from time import perf_counter

import numpy as np
import numpy.typing as npt
from mpi4py import MPI

from dynamics.energy import ENERGY_BOUND
from runs.case.build import build_boom, contact_laws
from runs.case.schema import Case
from runs.pipeline.motion import Plan
from runs.report.tables import TextTable
from runs.report.theme import fixed, number
from runs.studies.motions import friction_case, gap_system, loaded, shell_of
from runs.studies.pads import with_pads
from runs.studies.study import Plot, Proof, Study

Array = npt.NDArray[np.float64]

# Allowed of the tip, as a part of its range.
ALLOWED = 0.005

# Length and width in m of the pads under so many times the paper's load.
PAD, LOAD = (0.1, 0.06), 10.0


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured.

    Args:
        mesh: edge length in m.
        duration: of the motion in s.
        steps: of the direct integration in s, parts of the output step, each half the one before.
        hard_steps: the same with pads under ``LOAD`` times the load.
        shifts, moments: of the reduction with more coordinates.
        fine_step: of its splitting in s.
    """

    mesh: float = 0.2
    duration: float = 1.0
    steps: Sequence[float] = (1.0e-3, 5.0e-4, 2.5e-4, 1.25e-4, 6.25e-5)
    hard_steps: Sequence[float] = (2.5e-4, 1.25e-4)
    shifts: tuple[float, ...] = (5.0, 50.0, 300.0, 1500.0, 8000.0, 40000.0)
    moments: int = 5
    fine_step: float = 5.0e-7


@dataclass(frozen=True, slots=True)
class Run:
    """One motion beside the reduced shell's.

    Args:
        how: it was moved.
        unknowns: degrees of freedom, or modal coordinates.
        step: in s.
        apart: largest difference of the tip from the reduced shell's, as a part of its range.
        apart_from_larger: the same from the reduction with more coordinates.
        impulse: of all contact forces in N·s.
        energy_residual: as a part of the work done.
        seconds: wall time of the motion.
    """

    how: str
    unknowns: int
    step: float
    apart: float
    apart_from_larger: float
    impulse: float
    energy_residual: float
    seconds: float


@dataclass(frozen=True, slots=True)
class Comparison:
    """All motions of the study.

    Args:
        time: (num_times,) in s.
        reduced, direct: (num_times,) tips in m of the reduced shell and of the unreduced one with
            the shortest step.
        runs: reduced, with more coordinates, then direct from the longest step to the shortest.
    """

    time: Array
    reduced: Array
    direct: Array
    runs: Sequence[Run]

    @property
    def of_steps(self) -> Sequence[Run]:
        """The direct ones."""
        return self.runs[2:]

    @property
    def order(self) -> float:
        """Slope of the difference from the larger reduction over the step, by least squares."""
        steps = np.log([run.step for run in self.of_steps])
        return float(np.polyfit(steps, np.log([r.apart_from_larger for r in self.of_steps]), 1)[0])


def compare(
    case: Case, steps: Sequence[float], sizes: Sizes, tell: Callable[[str], None]
) -> Comparison:
    """Move the shell reduced and unreduced.

    Args:
        case: in the plane, with prescribed normal forces and a model ``shell``.
        steps: of the unreduced one in s.
        sizes: what is measured.
        tell: told what is being moved.
    """
    from shell_model.boom_shell import ShellOptions, reduce_boom
    from shell_model.reduction.segment import KrylovOptions
    from shell_model.verification.unreduced import assemble_boom, integrate_directly

    time = case.time.model_copy(update={"duration": sizes.duration})
    case = case.model_copy(update={"time": time})
    boom = build_boom(case)
    model = shell_of(case).model_copy(update={"mesh_size": sizes.mesh, "contact_tolerance": "any"})
    laws = contact_laws(case, model)
    options = ShellOptions(sizes.mesh, contact_line=model.contact_line)
    larger = KrylovOptions(sizes.shifts, sizes.moments)

    tell("the reduced shell")
    own = gap_system(case, boom, model)
    more = reduce_boom(
        boom, laws, ShellOptions(sizes.mesh, model.contact_line, krylov=larger), MPI.COMM_SELF
    ).system
    found = []
    for how, system, step in (
        ("reduced", own, model.step),
        ("reduced, more coordinates", more, sizes.fine_step),
    ):
        plan = Plan.of(system, case, model.model_copy(update={"step": step}))
        plan.warm()
        start = perf_counter()
        trajectory = plan.trajectory(lambda part: None)
        seconds = perf_counter() - start
        tip, taken = np.asarray(trajectory.data["tip"].values), trajectory.data.attrs["step"]
        impulse = _impulse(trajectory.data["contact_force"].values, case)
        residual = trajectory.energy_residual
        found.append((how, system.num_modes, taken, tip, impulse, residual, seconds))
    full = assemble_boom(boom, laws, options, MPI.COMM_SELF)
    for step in steps:
        tell(f"the unreduced shell, step {step:g} s")
        start = perf_counter()
        direct = integrate_directly(full, sizes.duration, step, case.time.output_step)
        seconds = perf_counter() - start
        impulse = _impulse(direct.contact_forces, case)
        tip, residual = direct.observed["tip"], direct.energy_residual
        found.append(("unreduced", full.num_dofs, direct.step, tip, impulse, residual, seconds))

    reduced, extended = found[0][3], found[1][3]
    span = float(np.ptp(reduced))
    runs = [
        Run(
            how,
            unknowns,
            float(step),
            float(np.abs(tip - reduced).max()) / span,
            float(np.abs(tip - extended).max()) / span,
            impulse,
            residual,
            seconds,
        )
        for how, unknowns, step, tip, impulse, residual, seconds in found
    ]
    times = case.time.output_step * np.arange(reduced.size)
    return Comparison(times, reduced, found[-1][3], runs)


def table(found: Comparison, where: str, sizes: Sizes) -> TextTable:
    """One row a motion."""
    rows = []
    for i, run in enumerate(found.runs):
        halved = i > 2
        before = found.runs[i - 1]
        order = np.log2(before.apart_from_larger / run.apart_from_larger) if halved else None
        rows.append(
            (
                run.how,
                str(run.unknowns),
                f"{1.0e6 * run.step:g}",
                "" if i == 0 else number(100.0 * run.apart, 2),
                "" if i == 1 else number(100.0 * run.apart_from_larger, 2),
                "" if order is None else fixed(float(order), 2),
                number(run.impulse, 4),
                number(run.energy_residual, 2),
                number(run.seconds, 2),
            )
        )
    return TextTable(
        f"The reduced shell against the unreduced one, {where}, mesh of {sizes.mesh:g} m",
        (
            "shell",
            "unknowns",
            "step (µs)",
            "off the reduced (%)",
            "off more coordinates (%)",
            "order",
            "contact impulse (N s)",
            "energy residual",
            "wall (s)",
        ),
        rows,
        (
            f"Largest difference of the tip over {sizes.duration:g} s, in parts of its range. The "
            "unreduced shell goes by the generalised-α method (Chung and Hulbert 1993), which is "
            "of second order until a row closes, opens or turns within a step: that event is "
            f"misplaced in the step. The mean order is {found.order:.2f}.",
            "Where a station presses and sticks at once, the sum of both forces moves the boom; "
            "how they share it until the next slip hangs on frequencies far above its motion.",
        ),
        name=f"direct-{where.replace(' ', '-')}",
    )


def proofs(found: Comparison, where: str, sizes: Sizes) -> list[Proof]:
    """The tip, and the energy of both motions."""
    finest, reduced = found.runs[-1], found.runs[0]
    where = f"{where}, mesh of {sizes.mesh:g} m, {sizes.duration:g} s"
    return [
        Proof(
            what=f"tip of the reduced shell off the unreduced one, part of its range, {where}",
            value=finest.apart,
            reference=0.0,
            unit="",
            kind="other code",
            source="all degrees of freedom, generalised-α (Chung and Hulbert 1993)",
            allowed=ALLOWED,
            order=found.order,
        ),
        *(
            Proof(
                what=f"energy residual of the {which} shell, {where}",
                value=run.energy_residual,
                reference=0.0,
                unit="",
                kind="analytic",
                source="conservation of energy",
                allowed=ENERGY_BOUND,
            )
            for which, run in (("reduced", reduced), ("unreduced", finest))
        ),
    ]


def _impulse(forces: Array, case: Case) -> float:
    """Of means over output steps."""
    return float(np.abs(forces).sum()) * case.time.output_step


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """The paper's boom with friction, all its degrees of freedom against few coordinates."""
    sizes = sizes or Sizes()
    case = friction_case()
    hard = f"pads of {PAD[0]:g} m x {PAD[1]:g} m, load x {LOAD:g}"
    found = {
        "near webs": compare(case, sizes.steps, sizes, tell),
        hard: compare(loaded(with_pads(case, *PAD), LOAD), sizes.hard_steps, sizes, tell),
    }
    return Study(
        name="direct",
        title="The reduction against the full order",
        tables=[table(one, where, sizes) for where, one in found.items()],
        proofs=[proof for where, one in found.items() for proof in proofs(one, where, sizes)],
        plots=[plot for where, one in found.items() for plot in _plots(one, where, sizes)],
        data={
            where: {"runs": [asdict(run) for run in one.runs], "order": one.order}
            for where, one in found.items()
        },
    )


def _plots(found: Comparison, where: str, sizes: Sizes) -> list[Plot]:
    steps = [run.step for run in found.of_steps]
    times = found.time.tolist()
    name = "direct" if where == "near webs" else "direct-pads"
    return [
        Plot(
            f"{name}-tips",
            f"The reduced shell moves as the unreduced one does, {where}",
            "time (s)",
            "tip (mm)",
            {
                f"{run.how}, {run.unknowns} unknowns": (times, (1.0e3 * tip).tolist())
                for run, tip in (
                    (found.runs[0], found.reduced),
                    (found.runs[-1], found.direct),
                )
            },
            "Tip of the paper's boom with friction, by two integrators: one curve hides the other.",
            logarithmic=False,
        ),
        Plot(
            f"{name}-steps",
            f"Finer steps close in on the reduced shell, {where}",
            "step of the direct integration (s)",
            "tip difference (part of range)",
            {
                "from the reduced shell": (steps, [r.apart for r in found.of_steps]),
                "from the one with more coordinates": (
                    steps,
                    [r.apart_from_larger for r in found.of_steps],
                ),
            },
            f"The largest over {sizes.duration:g} s. Where the curves part, it is the reduction: "
            f"more coordinates change the tip by {100.0 * found.runs[1].apart:.2g} % of its range.",
        ),
    ]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""How results settle as steps, series, elements and meshes refine: ``python -m runs.convergence``.

It takes a motion that is regular, so that two runs may be compared from moment to moment: the
paper's example with friction. The same motion tells what of the distance from the paper's series to
the shell each thing makes that the one leaves out and the other has.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import numpy.typing as npt
from mpi4py import MPI
from rich.console import Console

from dynamics.gap_system import GapSystem
from geometry.boom import Boom
from runs import case as case_file
from runs.build import build_boom
from runs.motion import Motion
from runs.schema import Case, FiniteElementTable, KantorovichTable, Model, ShellTable
from runs.systems import beam_system, reduce_shell
from runs.tables import TextTable, write
from runs.theme import number

Array = npt.NDArray[np.float64]

CASE = Path(__file__).parent / "cases" / "friction-walk.toml"
OUT = Path("runs/out/convergence")
TITLE = "Convergence of the paper's example with friction"

# The models whose integration is refined, and parts of the case's own step.
STEPPED = ("kantorovich-5", "kantorovich-24", "timoshenko", "shell")
STEPS = (1.0, 0.5, 0.25)
# Small enough, in s, for the highest modes of all further refinements.
FINE_STEP = 1.25e-6
TERMS = (3, 6, 12, 24)
ELEMENTS = (2.0, 1.0, 0.5, 0.25)
# From the paper's series to the shell: what is changed, and the model that has it.
WALK = (
    ("the paper's five-term series", "kantorovich-5"),
    ("linear contact", "kantorovich-5-linear"),
    ("more terms", "kantorovich-24-printed"),
    ("a complete base", "kantorovich-24"),
    ("beam elements", "beam-fe"),
    ("rotary inertia", "beam-fe-rotary"),
    ("shear", "timoshenko"),
    ("local flexibility", "timoshenko-local"),
    ("section distortion", "timoshenko-distorting"),
    ("plates", "shell"),
)
# Up to when the walk is to explain all but a hundredth, in s.
EXPLAINED = 5.0
# At which the flexibility of a station is read: below all elastic modes, above the rigid ones.
SLOW = 5.0
MESHES = (0.4, 0.2, 0.1, 0.05)


@dataclass(frozen=True, slots=True)
class Refinement:
    """A model with one thing refined.

    Args:
        what: is refined.
        model: its name in the case.
        sizes: of each run, from the coarsest to the finest.
        unit: of the sizes.
        differences: largest difference of each run's tip from the next finer one's, as a part of
            the finest one's range.
        first_peaks: of the tip in m, one for each run.
    """

    what: str
    model: str
    sizes: Sequence[float]
    unit: str
    differences: Sequence[float]
    first_peaks: Sequence[float]

    @property
    def orders(self) -> list[float]:
        """Observed orders: slopes of the differences over the sizes in a log-log plot."""
        sizes = np.log(self.sizes[: len(self.differences)])
        slopes = np.diff(np.log(self.differences)) / np.diff(sizes)
        return [float(order) for order in np.abs(slopes)]


def refine(
    case: Case,
    what: str,
    model: Model,
    sizes: Sequence[float],
    unit: str,
    at: Callable[[Model, float], Model],
) -> Refinement:
    """Run one model at several sizes.

    Args:
        case: the model's.
        what: is refined.
        model: of the case.
        sizes: from the coarsest to the finest.
        unit: of the sizes.
        at: the model at a size.
    """
    refined = tuple(
        at(model, size).model_copy(update={"name": f"{model.name} {i}"})
        for i, size in enumerate(sizes)
    )
    tips, peaks = _tips(case.model_copy(update={"models": refined}))
    apart = np.abs(np.diff(tips, axis=0)).max(axis=1) / np.ptp(tips[-1])
    return Refinement(what, model.name, list(sizes), unit, apart.tolist(), peaks)


def survey(case: Case, tell: Callable[[str], None]) -> list[Refinement]:
    """Every refinement of the case with friction.

    Args:
        case: with the models of ``runs/cases/friction-walk.toml``.
        tell: told what is being refined.
    """
    models = {model.name: model for model in case.models}
    found = []
    for name in STEPPED:
        tell(f"{name}: step")
        own = models[name].step or case.time.step
        assert own is not None
        steps = [factor * own for factor in STEPS]
        found.append(refine(case, "step", models[name], steps, "s", _with_step))
    asked: Sequence[tuple[str, str, Sequence[float], str, Callable[[Model, float], Model]]] = [
        ("terms of each segment", "kantorovich-24", TERMS, "", _with_terms),
        ("element length", "beam-fe", ELEMENTS, "m", _with_elements),
        ("element length", "timoshenko", ELEMENTS, "m", _with_elements),
        ("mesh size", "shell", MESHES, "m", _with_mesh),
    ]
    for what, name, sizes, unit, at in asked:
        tell(f"{name}: {what}")
        found.append(refine(case, what, _with_step(models[name], FINE_STEP), sizes, unit, at))
    return found


def table(found: Sequence[Refinement]) -> TextTable:
    """One row a run."""
    rows = []
    for refinement in found:
        orders = [None, *refinement.orders]
        for i, size in enumerate(refinement.sizes):
            finest = i == len(refinement.sizes) - 1
            rows.append(
                (
                    f"{refinement.model}: {refinement.what}" if i == 0 else "",
                    f"{number(size)} {refinement.unit}".strip(),
                    "" if finest else number(100.0 * refinement.differences[i]),
                    "" if finest else number(orders[i], 2),
                    f"{1e3 * refinement.first_peaks[i]:.2f}",
                )
            )
    return TextTable(
        TITLE,
        ("refined", "size", "off the next (% of the range)", "order", "first tip peak (mm)"),
        rows,
        (
            "Largest difference of the tip over the whole run from that of the next finer one. The "
            "order is that of the differences.",
        ),
        name="convergence",
    )


@dataclass(frozen=True, slots=True)
class Step:
    """A step of the walk from the series to the shell.

    Args:
        what: is changed.
        model: that has it.
        changes: largest difference from the model before, up to ``EXPLAINED`` and to the end, as
            parts of the shell's range.
        left: the same from the shell.
    """

    what: str
    model: str
    changes: tuple[float, float]
    left: tuple[float, float]


def walk(case: Case) -> list[Step]:
    """Measure each step of ``WALK``.

    Args:
        case: with its models.
    """
    names = [name for _, name in WALK]
    tips, _ = _tips(case_file.select(case, str(CASE), names))
    # A selection keeps the case's order.
    order = [model.name for model in case.models if model.name in names]
    tip = dict(zip(order, tips, strict=True))
    shell = tip[names[-1]]
    early = case.time.output_step * np.arange(shell.size) <= EXPLAINED

    def apart(one: str, other: str) -> tuple[float, float]:
        distance = np.abs(tip[one] - tip[other]) / np.ptp(shell)
        return float(distance[early].max()), float(distance.max())

    before = [names[0], *names[:-1]]
    return [
        Step(what, name, apart(name, previous), apart(name, names[-1]))
        for (what, name), previous in zip(WALK, before, strict=True)
    ]


def walk_table(steps: Sequence[Step]) -> TextTable:
    """One row a step."""

    def percent(parts: tuple[float, float]) -> list[str]:
        return [f"{100.0 * part:.2f}" for part in parts]

    return TextTable(
        "From the paper's series to the shell",
        (
            "with",
            "model",
            f"changes, to {EXPLAINED:g} s (% of the range)",
            "to the end",
            f"left to the shell, to {EXPLAINED:g} s",
            "to the end",
        ),
        [(step.what, step.model, *percent(step.changes), *percent(step.left)) for step in steps],
        name="walk",
    )


def flexibilities(case: Case) -> TextTable:
    """How much more a shell's stations give way than those of Timoshenko's beam.

    Args:
        case: with both, in the plane.
    """
    boom = build_boom(case)
    models = {model.name: model for model in case.models}
    beam, shell = models["timoshenko"], models["shell"]
    stiff = _system(case, boom, beam)
    soft = _system(case, boom, shell)

    def compliance(system: GapSystem, rows: Array) -> Array:
        """Diagonal of B (Ω² + σ)⁻¹ Bᵀ in m/N."""
        return np.asarray((rows**2 / (system.omega2 + (2.0 * np.pi * SLOW) ** 2)).sum(axis=1))

    rigid = compliance(stiff, stiff.rows)
    together = compliance(soft, soft.friction_rows) - rigid
    upper = [int(np.argmax(soft.station_of_row == i)) for i in range(len(soft.stations))]
    alone = compliance(soft, soft.rows[upper]) - rigid
    return TextTable(
        "Flexibility of the shell's stations beyond Timoshenko's beam",
        ("x (m)", "both flanges together (m/N)", "one flange more (m/N)"),
        [
            (f"{x:g}", f"{both:.2e}", f"{one - both:.2e}")
            for x, both, one in zip(soft.stations, together, alone, strict=True)
        ],
        (f"Read at σ = (2π · {SLOW:g} Hz)², with every segment free of the others.",),
        name="flexibility",
    )


def main() -> None:
    """Print the tables, and write them to ``runs/out/convergence``."""
    console = Console()
    case = case_file.load(str(CASE))
    found = survey(case, lambda what: console.print(f"refining {what} ..."))
    steps = walk(case)
    tables = [table(found), walk_table(steps), flexibilities(case)]
    for shown in tables:
        shown.show(console)
    data = {
        "refinements": [{**asdict(one), "orders": one.orders} for one in found],
        "walk": [asdict(step) for step in steps],
    }
    write(OUT, "convergence", TITLE, data, tables)
    console.print(f"written to {OUT}")


def _tips(case: Case) -> tuple[Array, list[float]]:
    """(num_models, num_times) tips in m, and the first peak of each."""
    boom = build_boom(case)
    motions = [Motion.of(_system(case, boom, model), case, boom, model) for model in case.models]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        runs = list(pool.map(lambda motion: motion.trajectory(lambda part: None), motions))
    return np.array([run.data["tip"].values for run in runs]), [run.first_peak()[1] for run in runs]


def _system(case: Case, boom: Boom, model: Model) -> GapSystem:
    if not isinstance(model, ShellTable):
        return beam_system(case, boom, model)
    with TemporaryDirectory(prefix="protractile-") as scratch:
        folder = Path(scratch) / model.name
        return reduce_shell(case, boom, model, MPI.COMM_SELF, folder, lambda *_: None).system


def _with_step(model: Model, step: float) -> Model:
    return model.model_copy(update={"step": step})


def _with_terms(model: Model, terms: float) -> Model:
    assert isinstance(model, KantorovichTable)
    return model.model_copy(update={"terms": (round(terms),) * len(model.terms)})


def _with_elements(model: Model, length: float) -> Model:
    assert isinstance(model, FiniteElementTable)
    return model.model_copy(update={"element_length": length})


def _with_mesh(model: Model, size: float) -> Model:
    assert isinstance(model, ShellTable)
    return model.model_copy(update={"mesh_size": size})


if __name__ == "__main__":
    main()

# SPDX-License-Identifier: LGPL-3.0-or-later
"""How near the shell of the paper's boom is to one of infinitely fine mesh."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.signal import find_peaks

from dynamics.gap_system import GapSystem
from dynamics.trajectory import Trajectory
from runs.case.build import build_boom
from runs.case.schema import Case
from runs.pipeline.motion import Plan
from runs.report.tables import TextTable
from runs.report.theme import fixed, number
from runs.studies.grid_convergence import GridConvergence
from runs.studies.motions import finer, friction_case, gap_system, shell_of
from runs.studies.study import Plot, Proof, Study

Array = npt.NDArray[np.float64]

RATIO = 2.0
# Below it the meshes do not tell where they lead.
LEAST_ORDER = 0.5
# What is allowed of the default mesh, relative to the limit of infinitely fine ones.
ALLOWED = 0.01


@dataclass(frozen=True, slots=True)
class Sizes:
    """What is measured.

    Args:
        meshes: edge lengths over the default ones, each half the one before, three at least.
        default: of them, which is judged.
        duration: of the motion in s.
        frequencies, peaks: how many of the lowest natural frequencies, of the first tip peaks.
    """

    meshes: Sequence[float] = (4.0, 2.0, 1.0, 0.5)
    default: float = 1.0
    duration: float = 3.0
    frequencies: int = 3
    peaks: int = 3


@dataclass(frozen=True, slots=True)
class Quantity:
    """A result on every mesh.

    Args:
        what: it is.
        unit: of the values.
        values: one for each mesh.
    """

    what: str
    unit: str
    values: Sequence[float]

    @property
    def convergence(self) -> GridConvergence:
        """Of the three finest."""
        return GridConvergence.of(self.values, RATIO)


def measure(case: Case, sizes: Sizes, tell: Callable[[str], None]) -> list[Quantity]:
    """Frequencies, flexibilities and tip peaks on every mesh.

    Args:
        case: with friction and a model ``shell``.
        sizes: what is measured.
        tell: told which mesh.
    """
    time = case.time.model_copy(update={"duration": sizes.duration})
    case = case.model_copy(update={"time": time})
    boom = build_boom(case)
    shell = shell_of(case)
    results: list[Mapping[tuple[str, str], float]] = []
    for part in sizes.meshes:
        tell(f"edges x {part:g}")
        model = finer(shell, part)
        system = gap_system(case, boom, model)
        motion = Plan.of(system, case, model).trajectory(lambda part: None)
        results.append(_quantities(system, motion, sizes))
    return [
        Quantity(what, unit, [result[what, unit] for result in results])
        for what, unit in results[-1]
    ]


def table(quantities: Sequence[Quantity], sizes: Sizes) -> TextTable:
    """One row a quantity."""
    rows = []
    for quantity in quantities:
        found = quantity.convergence
        rows.append(
            (
                f"{quantity.what} ({quantity.unit})",
                *(number(value, 6) for value in quantity.values),
                fixed(found.order, 2),
                number(found.limit, 6),
                fixed(100.0 * found.index, 3),
            )
        )
    return TextTable(
        "Meshes of the paper's boom, with friction",
        (
            "quantity",
            *(f"edges × {part:g}" for part in sizes.meshes),
            "order",
            "limit",
            "GCI (%)",
        ),
        rows,
        (
            "Order, Richardson's limit and the grid convergence index of the finest mesh, from the "
            "three finest, with the safety factor 1.25 (Roache 1994). No order where values do not "
            "go one way with ever smaller steps.",
        ),
        name="meshes",
    )


def proofs(quantities: Sequence[Quantity], sizes: Sizes) -> list[Proof]:
    """The default mesh against the limit."""
    default = sizes.meshes.index(sizes.default)
    found = []
    for quantity in quantities:
        convergence = quantity.convergence
        extrapolated = convergence.order > LEAST_ORDER  # False where there is none
        found.append(
            Proof(
                what=f"{quantity.what}, default mesh",
                value=quantity.values[default],
                reference=convergence.limit if extrapolated else quantity.values[-1],
                unit=quantity.unit,
                kind="other code",
                source="limit of its refinement (Richardson 1911)"
                if extrapolated
                else f"edges × {sizes.meshes[-1]:g}",
                allowed=ALLOWED,
                order=convergence.order if extrapolated else None,
            )
        )
    return found


def study(tell: Callable[[str], None], sizes: Sizes | None = None) -> Study:
    """The shell of the paper's boom with friction, on ever finer meshes."""
    sizes = sizes or Sizes()
    quantities = measure(friction_case(), sizes, tell)
    curves = {}
    for quantity in quantities:
        limit = quantity.convergence.limit
        if np.isfinite(limit):
            errors = [abs(value / limit - 1.0) for value in quantity.values]
            curves[quantity.what] = (list(sizes.meshes), errors)
    return Study(
        name="mesh",
        title="Meshes of the paper's boom",
        tables=[table(quantities, sizes)],
        proofs=proofs(quantities, sizes),
        plots=[
            Plot(
                "mesh",
                "The shell settles as its mesh refines",
                "edges over the default ones",
                "error against the limit",
                curves,
                "Relative distance from Richardson's limit of the three finest meshes, for the "
                "paper's boom with friction.",
            )
        ],
        data={
            "meshes": list(sizes.meshes),
            "quantities": [
                {"what": one.what, "unit": one.unit, "values": list(one.values)}
                for one in quantities
            ],
        },
    )


def _quantities(
    system: GapSystem, motion: Trajectory, sizes: Sizes
) -> dict[tuple[str, str], float]:
    from shell_model.contact.local_compliance import compliance, local_compliance

    elastic = system.frequencies[system.frequencies > 0.0][: sizes.frequencies]
    found = {(f"natural frequency {i}", "Hz"): float(f) for i, f in enumerate(elastic, start=1)}
    whole = compliance(system.omega2, system.rows)
    local = local_compliance(whole, system.laws, system.station_of_row.tolist())
    for station, x in enumerate(system.stations):
        row = int(np.argmax(system.station_of_row == station))
        found[f"local compliance at {x:g} m", "m/N"] = float(local[row])
    for i, height in enumerate(peak_heights(motion)[: sizes.peaks], start=1):
        found[f"tip peak {i}", "mm"] = 1.0e3 * height
    return found


def peak_heights(motion: Trajectory) -> list[float]:
    """Heights in m of the tip's peaks, on parabolas through the three highest output values."""
    tip = np.asarray(motion.data["tip"].values)
    places, _ = find_peaks(tip, prominence=0.2 * np.ptp(tip))
    before, top, after = tip[places - 1], tip[places], tip[places + 1]
    bend = before - 2.0 * top + after
    return [float(height) for height in top - 0.125 * (after - before) ** 2 / bend]

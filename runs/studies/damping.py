# SPDX-License-Identifier: LGPL-3.0-or-later
"""Damping ratios asked for against those with which pressed booms swing."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.signal import find_peaks

from dynamics.damping import pressed_modes, with_ratio
from dynamics.equilibrium import equilibrium
from dynamics.gap_system import GapSystem
from dynamics.motion import Motion
from dynamics.splitting import integrate
from runs import CASES
from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.report.tables import TextTable
from runs.report.theme import number
from runs.studies.motions import gap_system, model_of
from runs.studies.study import Proof, Study

Array = npt.NDArray[np.float64]


# Booms, and their cases.
BOOMS = {
    "two segments": "friction-walk.toml",
    "three segments": "three-segments.toml",
    "in space": "spatial.toml",
}

# Of each boom, all with a linear contact.
MODELS = ("kantorovich-24", "timoshenko", "shell")

RATIOS = (0.005, 0.02, 0.05)
MODES = 3

# The numbers of the loads of the cases are those of the masses.
GRAVITY = 9.80665

MESH_SIZE = 0.2

# Step times the highest frequency.
PHASE = 0.2

# For which each mode swings.
PERIODS = 1.1

# What a swing changes of a contact's penetration.
SWING = 0.02


@dataclass(frozen=True, slots=True)
class PressedBoom:
    """A boom that its weight presses, at rest.

    Args:
        name: of the boom and the model.
        system: under its weight, without damping and friction.
        rest: (num_modes,) in √kg·m.
        omega: (MODES,) of the first modes in rad/s.
        shapes: (num_modes, MODES).
        step: of the integrator in s, small for all pressed modes.
    """

    name: str
    system: GapSystem
    rest: Array
    omega: Array
    shapes: Array
    step: float

    @classmethod
    def of(cls, name: str, system: GapSystem) -> PressedBoom:
        """A boom without stops under a load whose numbers are its masses."""
        system = replace(
            system,
            load=-GRAVITY * system.load,
            friction_rows=np.zeros((0, system.num_modes)),
            frictions=(),
        )
        omega, shapes = pressed_modes(system)
        rest = equilibrium(system, system.load)
        step = PHASE / omega[-1]
        return cls(name, system, rest, omega[:MODES], shapes[:, :MODES], step)

    def measured(self, ratio: float, mode: int) -> tuple[float, float]:
        """The ratio by the logarithmic decrement of a mode's swing, and its energy residual."""
        gaps = self.system.rows @ self.rest
        laws = list(zip(self.system.laws, gaps, strict=True))
        pressed = [float(law.force(gap)) != 0.0 for law, gap in laws]
        deep = np.array([abs(gap) - law.clearance for law, gap in laws])
        shape, period = self.shapes[:, mode], 2.0 * np.pi / self.omega[mode]
        reach = np.abs(self.system.rows @ shape)
        run = integrate(
            Motion(
                with_ratio(self.system, ratio),
                PERIODS * period,
                period / 200.0,
                position=self.rest + shape * SWING * (deep / reach)[pressed].min(),
            ),
            self.step,
        )
        swing = (run.states - self.rest) @ shape
        peaks, _ = find_peaks(swing)
        decrement = np.log(swing[0] / swing[peaks[-1]]) / peaks.size
        return float(decrement / np.hypot(2.0 * np.pi, decrement)), run.energy_residual


def study(tell: Callable[[str], None]) -> Study:
    """Every boom and model at every ratio."""
    rows: list[Sequence[str]] = []
    proofs = []
    data = {}
    worst = 0.0
    for boom, file in BOOMS.items():
        for model in MODELS:
            pressed = PressedBoom.of(f"{boom}, {model}", _system(CASES / file, model))
            tell(pressed.name)
            for ratio in RATIOS:
                swings = [pressed.measured(ratio, mode) for mode in range(MODES)]
                ratios = np.array([found for found, _ in swings])
                worst = max(worst, *(residual for _, residual in swings))
                farthest = int(np.abs(ratios - ratio).argmax())
                percent = [number(100.0 * found, 4) for found in ratios]
                rows.append((pressed.name, number(100.0 * ratio), *percent))
                data[f"{pressed.name}, {ratio:g}"] = ratios.tolist()
                proofs.append(
                    Proof(
                        f"damping ratio of {pressed.name}: the mode of the first {MODES} that is "
                        "farthest off",
                        100.0 * float(ratios[farthest]),
                        100.0 * ratio,
                        "%",
                        "analytic",
                        "logarithmic decrement 2πζ/√(1 − ζ²)",
                        0.05,
                    )
                )
    proofs.append(
        Proof(
            "energy residual of these swings, the largest",
            worst,
            0.0,
            "",
            "analytic",
            "conservation of energy",
            1.0e-4,
        )
    )
    table = TextTable(
        "Damping ratios of pressed booms",
        ("boom", "asked\n%", *(f"mode {mode}\n%" for mode in range(1, MODES + 1))),
        rows,
        (
            "From the logarithmic decrements of a small swing about rest under the boom's weight, "
            "in space under a third of it sideways too.",
        ),
        name="damping",
    )
    return Study("damping", "Damping ratios asked for and measured", [table], proofs, data=data)


def _system(path: Path, name: str) -> GapSystem:
    case = case_file.load(str(path))
    model = model_of(case, name)
    if model.meshed:
        model = model.model_copy(update={"mesh_size": MESH_SIZE})
    return gap_system(case, build_boom(case), model)

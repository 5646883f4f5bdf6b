# SPDX-License-Identifier: LGPL-3.0-or-later
"""Damping ratios of computed vibrations with closed contacts, compared with the given ratios."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.signal import find_peaks

from protractile.dynamics.damping import closed_contact_modes, with_modal_damping
from protractile.dynamics.equilibrium import equilibrium
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.report.tables import Table
from studies.motions import gap_system, model_of, without_friction
from studies.study import Criterion, Piece, Progress, Verification, define_study

# Case file of each boom.
BOOMS = {
    "two segments": "friction-walk.toml",
    "three segments": "three-segments.toml",
    "in space": "spatial.toml",
}
# Models of each boom, all with a linear contact law.
MODELS = ("kantorovich-24", "timoshenko", "shell")
MESH_SIZE = 0.2

RATIOS = (0.005, 0.02, 0.05)
MODES = 3
# Load factor: the loads of the cases in N/m have the same numbers as the masses in kg/m.
GRAVITY = 9.80665
# Number of periods of each mode, and of steps per period.
PERIODS, STEPS = 1.1, 2000
# Relative change of a contact's penetration by the vibration.
SWING = 0.02

NOTE = (
    "From the logarithmic decrements of a small swing about rest under the boom's weight, in space "
    "under a third of it sideways too."
)


class PressedBoom(NamedTuple):
    """Boom at rest under its weight."""

    system: GapSystem  #: system under its weight, without damping and friction
    rest: Array  #: (num_modes,) in √kg·m
    omega: Array  #: (MODES,) of the first modes in rad/s
    shapes: Array  #: (num_modes, MODES)

    @classmethod
    def of(cls, system: GapSystem) -> PressedBoom:
        """Return the boom without stops at rest under its weight."""
        system = replace(without_friction(system), load=-GRAVITY * system.load)
        omega, shapes = closed_contact_modes(system)
        rest = equilibrium(system, system.load)
        return cls(system, rest, omega[:MODES], shapes[:, :MODES])

    def measured(self, ratio: float, mode: int) -> tuple[float, float]:
        """Return the damping ratio of a mode by its logarithmic decrement, and energy residual."""
        gaps = self.system.rows @ self.rest
        laws = list(zip(self.system.laws, gaps, strict=True))
        pressed = [float(law.force(gap)) != 0.0 for law, gap in laws]
        deep = np.array([abs(gap) - law.onset(np.copysign(1.0, gap)) for law, gap in laws])
        shape, period = self.shapes[:, mode], 2.0 * np.pi / self.omega[mode]
        reach = np.abs(self.system.rows @ shape)
        run = FixedStep(period / STEPS)(
            Motion(
                with_modal_damping(self.system, ratio),
                PERIODS * period,
                period / 200.0,
                position=self.rest + shape * SWING * (deep / reach)[pressed].min(),
            )
        )
        swing = (run.states - self.rest) @ shape
        peaks, _ = find_peaks(swing)
        decrement = np.log(swing[0] / swing[peaks[-1]]) / peaks.size
        return float(decrement / np.hypot(2.0 * np.pi, decrement)), run.energy_residual


@define_study("damping", "Damping ratios, requested and measured")
def study(progress: Progress) -> Iterator[Piece]:
    """Compare measured and given damping ratios of all booms and models."""
    rows, residuals = [], []
    criterion: Criterion = ("analytic", "logarithmic decrement 2πζ/√(1 − ζ²)", 0.05)
    for (boom, file), model in product(BOOMS.items(), MODELS):
        name = f"{boom}, {model}"
        progress(name)
        pressed = PressedBoom.of(_system(file, model))
        farthest = f"damping ratio of {name}: the mode of the first {MODES} that is farthest off"
        for ratio in RATIOS:
            swings = np.array([pressed.measured(ratio, mode) for mode in range(MODES)])
            residuals.append(float(swings[:, 1].max()))
            worst = 100.0 * float(swings[np.abs(swings[:, 0] - ratio).argmax(), 0])
            rows.append((name, 100.0 * ratio, *(100.0 * swings[:, 0])))
            yield Verification(farthest, worst, 100.0 * ratio, "%", *criterion)
    residual = "energy residual of these swings, the largest"
    criterion = ("analytic", "conservation of energy", 1.0e-4)
    yield Verification(residual, max(residuals), 0.0, "", *criterion)
    modes = {f"mode {mode}\n%": ".4g" for mode in range(1, MODES + 1)}
    columns = {"boom": "", "requested\n%": ".3g", **modes}
    yield Table.of_rows("damping", "Damping ratios of pressed booms", columns, rows, (NOTE,))


def _system(file: str, name: str) -> GapSystem:
    case = case_file.load(str(CASES / file))
    model = model_of(case, name)
    if model.meshed:
        model = model.model_copy(update={"mesh_size": MESH_SIZE})
    return gap_system(case, build_boom(case), model)

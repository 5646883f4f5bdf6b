# SPDX-License-Identifier: LGPL-3.0-or-later
"""Invented curves of the models of the paper's case, and the verdicts on them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from protractile.dynamics.trajectory import Trajectory
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.schema import Case
from protractile.runs.paper.rules import judge
from protractile.runs.paper.statements import STATEMENTS
from protractile.runs.paper.verdicts import Verdict
from protractile.runs.pipeline.results import Results
from tests.runs.case_texts import shipped
from tests.runs.summaries import model_summary, summary_of

PAPER = CASES / "paper.toml"
FIRST_CONTACT = 0.12
PERIOD = 1.1
# First tip peaks in m, of about the heights that the models have.
PEAKS = {
    "kantorovich-4": 0.169,
    "kantorovich-5": 0.171,
    "beam-fe": 0.184,
    "beam-fe-bonded": 0.019,
    "shell": 0.186,
}


def paper() -> Case:
    """Return the paper's case with these models, judged by all statements."""
    found = case_file.select(shipped("paper"), str(PAPER), list(PEAKS))
    return found.model_copy(update={"statements": tuple(STATEMENTS)})


def swing(height: float, duration: float = 10.0) -> np.ndarray:
    """Return a deflection that rises from rest and returns, at steps of 1 ms."""
    time = np.arange(round(duration * 1000) + 1) / 1000
    return height * 0.5 * (1.0 - np.cos(2.0 * np.pi * time / PERIOD))


def curves(duration: float = 10.0, **heights: float) -> dict[str, dict[str, np.ndarray]]:
    """Return tip and head of every model of the paper's case; heights by name, with _ for -.

    Up to the first contact, models with play are equal to ``kantorovich-5``. A head is a tenth of
    its tip, plus 0.3 of the difference of the model's own tip from it.
    """
    peaks = PEAKS | {name.replace("_", "-"): height for name, height in heights.items()}
    touching = np.arange(round(duration * 1000) + 1) / 1000 > FIRST_CONTACT
    common = swing(0.171, duration)
    drawn = {}
    for name, peak in peaks.items():
        own = swing(peak, duration)
        tip = own if name == "beam-fe-bonded" else common + touching * (own - common)
        head = 0.1 * common + 0.3 * (tip - common)
        drawn[name] = {"tip": tip, "head": head}
    return drawn


def verdicts(
    case: Case,
    motion: Mapping[str, Mapping[str, np.ndarray]],
    summary: Mapping[str, Mapping[str, Any]] | None = None,
    ensembles: xr.Dataset | None = None,
) -> dict[str, Verdict]:
    """Judge curves; ``summary`` replaces entries of the models' summaries."""
    size = next(iter(motion.values()))["tip"].size
    data = xr.Dataset(
        {
            place: (("model", "time"), np.array([both[place] for both in motion.values()]))
            for place in ("tip", "head")
        },
        coords={"model": list(motion), "time": np.arange(size) / 1000},
    )
    models = {}
    for name in motion:
        trajectory = Trajectory(data.sel(model=name), np.zeros((0, 0)))
        found: dict[str, Any] = {
            "first_contact": FIRST_CONTACT,
            "first_peak": {place: trajectory.first_peak(place) for place in ("tip", "head")},
            "energy_residual": 1.0e-4,
            "ensemble": {
                "horizons": {"0.01": 0.8, "0.2": 3.2}, "energy_residual": 1e-4, "slow_peaks": None,
            },
        }  # fmt: skip
        models[name] = model_summary(**found | dict((summary or {}).get(name, {})))
    whole = summary_of(models, ensemble={"members": 32, "slow_below": 1.67})
    return {verdict.id: verdict for verdict in judge(Results(case, data, whole, ensembles))}


def verdict(
    key: str,
    motion: Mapping[str, Mapping[str, np.ndarray]] | None = None,
    summary: Mapping[str, Mapping[str, Any]] | None = None,
    tips: Mapping[str, np.ndarray] | None = None,
    case: Case | None = None,
) -> tuple[str, float | None, str]:
    """Judge one statement: the verdict, the number and the reason; usual curves unless given."""
    ensembles = None if tips is None else members(tips)
    found = verdicts(case or paper(), motion or curves(), summary, ensembles)[key]
    return found.verdict, found.measured, found.why


def members(tips: Mapping[str, np.ndarray]) -> xr.Dataset:
    """Return ensembles from the tips (num_members, num_times) of members, by model name."""
    time = np.arange(next(iter(tips.values())).shape[1]) / 1000
    return xr.Dataset(
        {"tip": (("model", "member", "time"), np.array(list(tips.values())))},
        coords={"model": list(tips), "time": time},
    )


def stratifying(drift: float, early: float = 0.0, count: int = 32) -> dict[str, np.ndarray]:
    """Return members of all models with play that vibrate alike for six seconds.

    Each model is later than the previous one by ``early`` in s, and from six seconds on by
    ``drift`` more.
    """
    time = np.arange(10_001) / 1000
    delays = early + drift * np.clip(time - 6.0, 0.0, 1.0)
    names = [name for name in PEAKS if name != "beam-fe-bonded"]
    return {
        name: np.tile(
            PEAKS[name] * 0.5 * (1.0 - np.cos(2.0 * np.pi * (time - i * delays) / PERIOD)),
            (count, 1),
        )
        for i, name in enumerate(names)
    }

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Each model is compared with its reference model; the differences equal stored values."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from runs import CASES
from runs.case import reading as case_file
from runs.case.schema import Case, StopTable
from runs.pipeline.model_quality import compare_models, reference_of

COARSE = CASES / "coarse.toml"
PRESSED = 4500.0, 5000.0
SERIES = ["kantorovich-4", "kantorovich-5"]
TIME = np.arange(10_001) / 1000
CUTOFF = 2.0


def case_of(*names: str, friction: float = 0.0, pressed: tuple[float, ...] = PRESSED) -> Case:
    """Return the coarse case with some of its models, and friction in its joint."""
    case = case_file.select(case_file.load(str(COARSE)), "", names, None)
    rubbing = {"friction": friction, "normal_forces": pressed}
    joints = tuple(replace(joint, **rubbing) for joint in case.joints)
    return case.model_copy(update={"joints": joints})


def swing(scale: float = 1.0, late: float = 0.0) -> np.ndarray:
    """(num_times,) one swing a second, from rest; its range is ``scale``."""
    return 0.5 * scale * (1.0 - np.cos(2.0 * np.pi * (TIME - late)))


def trajectories(**tips: np.ndarray) -> xr.Dataset:
    return xr.Dataset(
        {"tip": (("model", "time"), np.array(list(tips.values())))},
        coords={"model": [name.replace("_", "-") for name in tips], "time": TIME},
    )


def ensembles(members: dict[str, list[np.ndarray]]) -> xr.Dataset:
    return xr.Dataset(
        {"tip": (("model", "member", "time"), np.array(list(members.values())))},
        coords={"model": list(members), "time": TIME},
    )


@pytest.mark.parametrize(
    ("models", "expected"),
    [
        ([*SERIES, "shell", "beam-fe-bonded"], "shell"),
        ([*SERIES, "beam-fe-bonded"], "kantorovich-5"),
        (["beam-fe-bonded"], None),
    ],
)
def test_the_reference_is_the_most_complicated_model(
    models: list[str], expected: str | None
) -> None:
    assert reference_of(case_of(*models).models) == expected


def test_late_and_low_model_differs_at_each_level() -> None:
    """Reference: analytic. Half as high, 50 ms late, within 1 % until 4 s and then a quarter of a
    period apart; distributions of a cosine and of its half are apart by arccos."""
    late = np.where(TIME < 4.0, 0.0, 0.25)
    members = {
        name: [swing(scale, shift), swing(scale, shift + late)]
        for name, scale, shift in (("kantorovich-4", 0.5, 0.05), ("kantorovich-5", 1.0, 0.0))
    }
    data = trajectories(kantorovich_4=members["kantorovich-4"][0], kantorovich_5=swing())
    found = compare_models(case_of(*SERIES), data, ensembles(members), CUTOFF)
    assert found is not None
    assert found.reference == "kantorovich-5"
    assert not found.whole
    (level,) = found.ensembles.values()
    assert level.pointwise.until == pytest.approx(4.0, abs=2e-3)
    apart = np.abs(members["kantorovich-4"][0] - swing())[TIME <= 4.0]
    assert level.pointwise.largest == pytest.approx(apart.max(), rel=1e-6)
    assert level.pointwise.rms == pytest.approx(np.sqrt(np.mean(apart**2)), rel=1e-3)
    # The filter leans on the jump at 4 s: the first two peaks are far from it.
    assert level.peaks.time[:2] == pytest.approx([0.05, 0.05], abs=5e-3)
    assert level.peaks.height[:2] == pytest.approx([-0.5, -0.5], abs=1e-2)
    assert level.peaks.explained[:2] == [False, False]
    spread = level.distributions
    assert spread.range == pytest.approx([1.0, 0.5], rel=1e-3)
    assert spread.mean == pytest.approx([0.5, 0.25], abs=1e-2)
    assert spread.deviation == pytest.approx([0.5 / np.sqrt(2.0), 0.25 / np.sqrt(2.0)], rel=0.02)
    # All values of the half are below 0.5: half of the whole one's are.
    assert spread.distance == pytest.approx(0.5, abs=0.02)


def test_without_a_slow_motion_ensembles_are_not_compared() -> None:
    members = ensembles({name: [swing(), swing()] for name in SERIES})
    data = trajectories(kantorovich_4=swing(), kantorovich_5=swing())
    case = case_of(*SERIES)
    assert compare_models(case, data, members, None) is None
    assert compare_models(case, data, None, None) is None


def test_with_friction_every_model_is_compared_to_the_end() -> None:
    """Reference: analytic. A tip that is 0.1 too high until 5 s and 0.3 later, of a range of 1."""
    above = swing() + np.where(TIME <= 5.0, 0.1, 0.3)
    data = trajectories(kantorovich_4=above, kantorovich_5=swing(), beam_fe_bonded=0.1 * swing())
    case = case_of(*SERIES, "beam-fe-bonded", friction=0.2)
    found = compare_models(case, data, None, None)
    assert found is not None
    assert list(found.whole) == ["kantorovich-4", "beam-fe-bonded"]
    whole = found.whole["kantorovich-4"]
    assert whole.until == [5.0, 10.0]
    assert whole.largest == pytest.approx([0.1, 0.3 / 1.2], rel=1e-2)
    assert whole.rms == pytest.approx([0.1, np.sqrt(0.5 * (0.1**2 + 0.3**2)) / 1.2], rel=1e-2)
    assert found.whole["beam-fe-bonded"].largest == pytest.approx([0.9, 0.9], rel=1e-6)


@pytest.mark.parametrize(
    ("friction", "pressed"), [(0.0, PRESSED), (0.2, ()), (0.2, (0.0, 0.0)), (0.2, (4500.0, 0.0))]
)
def test_friction_under_given_forces_is_regular(
    friction: float, pressed: tuple[float, ...]
) -> None:
    """Reference: physics; what contacts press, and what nothing presses, leaves motion chaotic."""
    case = case_of(*SERIES, friction=friction, pressed=pressed)
    data = trajectories(kantorovich_4=swing(), kantorovich_5=swing())
    assert compare_models(case, data, None, None) is None


def test_motion_with_stops_is_not_regular() -> None:
    """Reference: physics; what bounces is chaotic, whatever rubs besides."""
    case = case_of(*SERIES, friction=0.2)
    stop = StopTable(segment="inner", x=14.0, play=0.1, stiffness=1e7)
    assert case.regular
    assert not case.model_copy(update={"stops": (stop,)}).regular


def test_a_short_run_with_friction_is_compared_to_its_end_alone() -> None:
    data = trajectories(kantorovich_4=0.9 * swing(), kantorovich_5=swing())
    case = case_of(*SERIES, friction=0.2)
    found = compare_models(case, data.sel(time=slice(None, 2.0)), None, None)
    assert found is not None
    assert found.whole["kantorovich-4"].until == [2.0]
    assert found.whole["kantorovich-4"].largest == pytest.approx([0.1], rel=1e-6)


def test_a_model_alone_is_compared_with_nothing() -> None:
    members = ensembles({"kantorovich-4": [swing(), swing()]})
    data = trajectories(kantorovich_4=swing())
    case = case_of("kantorovich-4", friction=0.2)
    assert compare_models(case, data, members, CUTOFF) is None

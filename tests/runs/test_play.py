# SPDX-License-Identifier: LGPL-3.0-or-later
"""The effect of play on results, and contacts without play."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest

from dynamics.contact import PowerContact
from dynamics.equilibrium import equilibrium
from dynamics.excitation import Excitation, Step
from dynamics.gap_system import GapSystem
from runs.case.reading import select
from runs.pipeline.bonded import bonded_system
from runs.pipeline.design_results import DesignResults, PlayDifference
from runs.pipeline.model_quality import quality_notes
from tests.modal import modal_system
from tests.runs.case_texts import shipped
from tests.runs.summaries import answers_of, model_summary, summary_of

if TYPE_CHECKING:
    from mpi4py import MPI


def run_of(names: list[str], comm: MPI.Intracomm | None = None) -> DesignResults:
    return answers_of(select(shipped("coarse"), "", names), comm)


@pytest.fixture(scope="module")
def answers() -> DesignResults:
    """Return the design results of a series and elements with play, and of bonded elements."""
    return run_of(["kantorovich-5", "beam-fe", "beam-fe-bonded"])


def numbers(found: DesignResults, model: str) -> dict[tuple[str, str], PlayDifference]:
    (play,) = (one for one in found.play if one.model == model)
    return {(one.what, one.where): one for one in play.numbers}


def test_play_adds_its_lever_at_rest_and_no_moment(answers: DesignResults) -> None:
    """Reference: by hand. 14 mrad of play and 5 µrad of contacts are 133 mm and 47 µm."""
    assert [play.model for play in answers.play] == ["kantorovich-5", "beam-fe"]
    at_rest = numbers(answers, "beam-fe")["deflection at rest", "tip"]
    assert at_rest.increase == pytest.approx(0.133 + 10.0 * 4.956e-6 - 2.2e-6, abs=1e-7)
    assert at_rest.share == pytest.approx(at_rest.increase / at_rest.bonded)
    series = numbers(answers, "kantorovich-5")["deflection at rest", "tip"]
    assert series.increase == pytest.approx(0.133, rel=5e-3)
    found = answers.models["beam-fe"]
    (rest,), (bonded,) = found.static, found.static_bonded
    # The stations of the bonded boom bend nothing: what is added is the tilt alone.
    assert rest.tip - bonded.tip == pytest.approx(rest.tilts[0].tip, rel=1e-6)
    depths = [pressed.depth for pressed in rest.stations]
    assert depths == pytest.approx([2.2028e-6, 2.7535e-6], rel=1e-4)
    for one, other in zip(rest.diagrams, bonded.diagrams, strict=True):
        np.testing.assert_allclose(one.curves["moment"], other.curves["moment"], atol=0.1)


def test_motions_are_held_against_those_without_play(answers: DesignResults) -> None:
    """Reference: other model, the bonded model of the case with the same elements."""
    own, bonded = (answers.models[name] for name in ("beam-fe", "beam-fe-bonded"))
    assert bonded.motion_bonded is None
    for peak, other in zip(own.motion_bonded.peaks, bonded.motion.peaks, strict=True):
        assert (peak.what, peak.where) == (other.what, other.where)
        assert peak.largest == pytest.approx(other.largest, rel=1e-6)
    found = numbers(answers, "beam-fe")
    for one in found.values():
        assert one.with_play >= 0.0
    largest = own.motion.peaks[0].largest - bonded.motion.peaks[0].largest
    assert found["deflection", "tip"].increase == pytest.approx(largest, rel=1e-6)
    assert ("stress", "inner") in found


@pytest.mark.slow
def test_play_adds_equal_deflections_to_shells_and_beams() -> None:
    """Reference: by hand, the same lever at rest; in motion elements within a fifth."""
    mpi = pytest.importorskip("mpi4py.MPI")
    pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")
    found = run_of(["timoshenko", "shell"], mpi.COMM_SELF)
    shell, beam = (numbers(found, name) for name in ("shell", "timoshenko"))
    assert shell["deflection at rest", "tip"].increase == pytest.approx(0.133, rel=2e-3)
    farther = [one["deflection", "tip"].increase for one in (shell, beam)]
    assert farther[0] == pytest.approx(farther[1], rel=0.2)
    frequencies = [one["first frequency", "bending in z"].bonded for one in (shell, beam)]
    assert frequencies[0] == pytest.approx(frequencies[1], rel=0.02)


def test_models_agree_within_the_stated_difference(answers: DesignResults) -> None:
    """Reference: other results of the same run, the static tips of both models."""
    agreement = [known.line for known in answers.quality_notes if known.what == "agreement"]
    series, beam = (answers.models[name].static[0].tip for name in ("kantorovich-5", "beam-fe"))
    off = f"{100.0 * (series / beam - 1.0):+.2g}".replace("-", "−")
    (line,) = agreement
    start = f"kantorovich-5 differs from beam-fe by {off} % in the static tip deflection, "
    assert line.startswith(start)


def test_chaos_note_names_chaotic_models_only() -> None:
    """Reference: ensembles, one with the horizon 3.2 s and one without divergence."""

    def ensemble(time: float | None) -> dict[str, object]:
        return {"horizons": {"0.2": time}, "energy_residual": 1e-6, "slow_peaks": None}

    summary = summary_of(
        {
            "wild": model_summary(ensemble=ensemble(3.2)),
            "calm": model_summary(ensemble=ensemble(None), energy_residual=2e-4),
        }
    )
    chaotic, regular, energy = quality_notes(summary, DesignResults({}), 10.0)
    assert [one.what for one in (chaotic, regular, energy)] == ["horizon", "horizon", "energy"]
    assert "after these times: wild 3.20 s." in chaotic.line
    assert regular.line == "The motion of calm can be predicted over the whole 10 s."
    assert energy.line == (
        "The energy balance holds within 2 × 10⁻⁴ of the work in every model; calm has the largest "
        "error."
    )
    none = summary_of({"plain": model_summary()})
    assert [one.what for one in quality_notes(none, DesignResults({}), 10.0)] == ["energy"]


LAW = PowerContact(1e6, 1.0).with_clearance(0.01)


@pytest.fixture
def pair() -> GapSystem:
    """Return 1 kg on 100 N/m, 1 kg in it under 5 N with plays of 10 mm, and a stop far below."""
    return modal_system(
        [100.0, 0.0],
        [0.0, -5.0],
        [[-1.0, 1.0], [0.0, 1.0]],
        [LAW, PowerContact(1e5, 1.0).with_clearance(0.5)],
        tip=[0.0, 1.0],
        stations=[1.0, 2.0],
        grounded=[1],
        excitations=[Excitation(np.array([1.0, 0.0]), Step())],
    )


def test_the_bonded_boom_lacks_the_play_alone(pair: GapSystem) -> None:
    """Reference: by hand, −5/100 m, with play 10 mm and 5 µm lower, and √(100/2) rad/s together."""
    rest = equilibrium(pair, pair.load)
    bonded, basis = bonded_system(pair, [rest])
    hung = equilibrium(bonded, bonded.load)
    np.testing.assert_allclose(basis @ hung, [-0.05, -0.05], rtol=1e-9)
    tip = bonded.observers["tip"].row @ hung
    assert pair.observers["tip"].row @ rest - tip == pytest.approx(-0.01 - 5e-6, rel=1e-6)
    np.testing.assert_allclose(bonded.omega2, [50.0], rtol=1e-12)
    np.testing.assert_allclose(basis @ bonded.excitations[0].load, [0.5, 0.5], rtol=1e-12)
    # So is all where nothing presses.
    np.testing.assert_allclose(bonded_system(pair, [])[0].omega2, [50.0], rtol=1e-12)


def test_bonded_system_keeps_the_softening_by_axial_forces(pair: GapSystem) -> None:
    """Reference: analytic. Axial forces take 30 of 100 N/m: both have √(70/2) rad/s."""
    pressed = replace(pair, geometric_stiffness=np.diag([30.0, 0.0]))
    bonded, _ = bonded_system(pressed, [equilibrium(pressed, pressed.load)])
    np.testing.assert_allclose(bonded.omega2, [35.0], rtol=1e-12)
    assert bonded.in_own_modes() is bonded


def test_the_ground_is_still_met(pair: GapSystem) -> None:
    """Reference: by hand. −100 N move it down by 0.5 m and (100 − 50)/(1e5 + 100) m."""
    bonded, basis = bonded_system(pair, [equilibrium(pair, pair.load)])
    assert (list(bonded.stations), list(bonded.grounded)) == ([2.0], [0])
    deep = basis @ equilibrium(bonded, np.array([0.0, -100.0]) @ basis)
    assert deep[1] == pytest.approx(-0.5 - 50.0 / (1e5 + 100.0), rel=1e-6)


def test_lateral_contacts_of_both_walls_are_bonded() -> None:
    """Reference: by hand. 5 N bulge walls by 50 mm, 4 N press at the right; 1 N moves 1/4 m."""
    law = PowerContact(1e5, 1.0).with_clearance(0.08)
    system = modal_system(
        [100.0, 100.0, 4.0],
        [4.0, 5.0, 1.0],
        [[1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]],
        [law, law],
        station_of_row=np.array([0, 0]),
        stations=[1.0],
        station_directions=("y",),
    )
    rest = equilibrium(system, system.load)
    assert [bool(law.force(gap)) for gap in system.rows @ rest] == [True, False]
    bonded, basis = bonded_system(system, [rest])
    hung = basis @ equilibrium(bonded, bonded.load)
    np.testing.assert_allclose(hung, [0.0, 0.0, 0.25], atol=1e-12)

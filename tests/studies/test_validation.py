# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cheap rows of the validation, its page, and the elasticas that check small displacements."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from studies import validation
from studies.large_deflections import PARTS, compare
from studies.reference_models.elastica import Rod, State

ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize("rows", [validation.released_slider, validation.rubbing_mass])
def test_friction_follows_code_aster(rows: object) -> None:
    """Reference: analytic and external, Code_Aster V5.01.100 and 104; steps leave 3e-5."""
    verifications = list(rows())  # type: ignore[operator]
    assert [
        verification.what for verification in verifications if verification.error > 1.0e-4
    ] == []


def test_the_roller_stiffens_the_beam_as_measured() -> None:
    """Reference: measured, DROPBEAR. Without roller 1.8751² and 0.2427, within 1 %."""
    verifications = list(validation.moving_roller())
    assert len(verifications) == 6
    assert max(verification.error for verification in verifications) < 0.012
    area = validation.BEAM_WIDTH * validation.BEAM_THICKNESS
    mass = validation.BEAM_STEEL.density * area * validation.BEAM_LENGTH
    bending = validation.BEAM_STEEL.youngs_modulus * area * validation.BEAM_THICKNESS**2 / 12.0
    stiffness = 3.0 * bending / validation.BEAM_LENGTH**3
    free = np.sqrt(stiffness / (0.2427 * mass + validation.ACCELEROMETERS)) / (2.0 * np.pi)
    assert validation.roller_frequency(1.0e-3) == pytest.approx(free, rel=0.02)


def test_a_heavier_tip_slows_the_boom_lift() -> None:
    """Reference: external, 1.40 Hz of MathWorks' chart, and statics: 1/f² is linear in the mass."""
    (verification,) = validation.boom_lift()
    assert verification.error < 0.02
    light, middle, heavy = (validation.lift_frequency(0.05, 250.0 * k) ** -2 for k in (1, 2, 4))
    assert (heavy - middle) / (middle - light) == pytest.approx(2.0, rel=0.01)


def test_colliding_oscillators_are_mirror_images() -> None:
    """Reference: analytic. The oscillator must touch the wall for a meaningful comparison."""
    verification = validation.impact_pair()
    assert verification.value < 1.0e-9
    pair = validation.Oscillators(25.0, 98696.0, [1.0], 10.0, 0.07).system()
    assert pair.damping == pytest.approx(2.0 * 0.07 * np.sqrt(98696.0 / 25.0))


def test_a_coarse_membrane_is_near_nafems() -> None:
    """Reference: external, NAFEMS FV32, 44.623 and 130.03 Hz."""
    found = validation.tapered_membrane(8)[:2]
    assert found == pytest.approx([44.623, 130.03], rel=2.0e-3)


def test_the_page_has_every_row() -> None:
    page = (ROOT / "docs" / "validation.md").read_text(encoding="utf-8")
    rows = [row.split(" | ") for row in re.findall(r"^\| (?!what|:--)(.*) \|$", page, re.M)]
    computed = [row for row in rows if len(row) == 9]
    assert {row[5] for row in computed} == {"✓"}
    cheap = [*validation.released_slider(), *validation.rubbing_mass(), validation.impact_pair()]
    assert {verification.what for verification in cheap} < {row[0] for row in computed}
    compared = [row for row in rows if len(row) == 7 and row[0] != "motion"]
    assert {row[2] for row in compared} == {"protractile", "Exudyn", "Siconos"}
    assert all(float(row[4]) <= float(row[1]) for row in compared)
    # What is not computed says what is missing.
    others = [row for row in rows if len(row) not in (7, 9)]
    assert all(len(row) == 4 and len(row[2]) > 20 for row in others)


def test_the_template_is_a_case_with_a_table() -> None:
    case = case_file.load(str(ROOT / "examples" / "measured-boom.toml"))
    assert build_boom(case).joints[0].play == 0.003
    with (ROOT / "examples" / "measured-boom.csv").open(encoding="utf-8") as file:
        header, *rows = csv.reader(file)
    assert header[0] == "time (s)"
    assert {len(row) for row in rows} == {len(header)}


@pytest.mark.parametrize(
    ("load", "deflection", "shortening"),
    [(1, 0.301721, 0.056433), (2, 0.493457, 0.160642), (4, 0.669964, 0.328941),
     (8, 0.784982, 0.504828)],
)  # fmt: skip
def test_a_cantilever_with_a_dead_load(load: float, deflection: float, shortening: float) -> None:
    """Reference: external, elliptic integrals at P L²/(E J) = 1, 2, 4, 8, all digits given."""
    rod, force = Rod(1.0, 1.0), np.array([0.0, -float(load)])

    def end(moment: float) -> State:
        return rod.follow(State(0.0, 0.0, 0.0, moment), force, 1.0)[0]

    tip = end(brentq(lambda moment: end(moment).moment, -float(load), 0.0))
    assert (-tip.y, 1.0 - tip.x) == pytest.approx((deflection, shortening), abs=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize(("angle", "play"), [(0.0, 0.0), (45.0, 0.02), (70.0, 0.02)])
@pytest.mark.parametrize("part", PARTS[:2])
def test_the_rule_is_near_and_safe(part: float, angle: float, play: float) -> None:
    """Reference: other code, two elasticas; the rest is the couple P Δ of the axial force."""
    found = compare(part, angle, play)
    tip, moment = found.errors
    assert 0.9 * 1.1 * part**2 < tip < 1.1 * part**2 + 2.5e-3
    assert 0.8 * 0.65 * part**2 < moment < 0.65 * part**2 + 2.5e-3

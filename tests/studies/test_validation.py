# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cheap rows of the validation, its page, and the template of a measured boom."""

import csv
import re
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from studies import validation

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

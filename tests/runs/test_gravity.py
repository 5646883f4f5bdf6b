# SPDX-License-Identifier: LGPL-3.0-or-later
"""Weights and materials of a case."""

from pathlib import Path

import numpy as np
import pytest

from geometry.section import BoxSection
from protractile.cases import run_case
from runs.case import toml
from runs.case.build import build_boom
from runs.case.schema import Case
from tests.runs.case_texts import REST, elements, read_case, refusal

STEEL = "youngs_modulus = 2.1e11\npoissons_ratio = 0.3\ndensity = 7850.0\nyield_strength = 690e6\n"
ALUMINIUM = "{ youngs_modulus = 7e10, poissons_ratio = 0.33, density = 2700.0 }"
ARM = """
title = "Arm"
time = {{ duration = 0.1 }}
{material}
[[segment]]
name = "arm"
span = [0.0, 10.0]
supports = [{{ x = 0.0, kind = "clamped" }}]
section = {{ height = 0.4, width = 0.3, flange = 0.01, web = 0.008 }}
{segment}
{rest}
"""
ELEMENTS = elements("beam", theory="euler-bernoulli", element_length=2.5, rotary_inertia=False)
BOX = BoxSection(height=0.4, width=0.3, flange=0.01, web=0.008)
AREA, SECOND_MOMENT = BOX.area, BOX.second_moment_of_area
LIFTED = f"masses = [{{ x = 4.0, mass = 120.0 }}]\n[payload]\nmass = 500.0\n{REST}"


def text_of(rest: str = "", material: str = "", segment: str = "") -> str:
    material = material or f"[material]\n{STEEL}"
    return ARM.format(material=material, segment=segment, rest=rest) + ELEMENTS


def read(folder: Path, rest: str = "", material: str = "", segment: str = "") -> Case:
    return read_case(folder, text_of(rest, material, segment))


def tip(case: Case) -> np.ndarray:
    return np.asarray(run_case(case).trajectories["tip"].values[0])


@pytest.mark.parametrize("angle", [0.0, 60.0, -30.0])
def test_everything_weighs_across_the_boom(tmp_path: Path, angle: float) -> None:
    """Reference: analytic, q L⁴/8 + F L³/3 + m a² (3L − a)/6 over E J, times 1/(1 − 1/λ)."""
    gravity = f"[gravity]\nangle = {angle}\n"
    moved = tip(read(tmp_path, gravity, segment=LIFTED))
    across = 9.80665 * np.cos(np.radians(angle))
    of_all = (7850.0 * AREA * 10.0**4 / 8.0) + 500.0 * 10.0**3 / 3.0 + 120.0 * 16.0 * 26.0 / 6.0
    expected = -across * of_all / (2.1e11 * SECOND_MOMENT)
    along = 9.80665 * np.sin(np.radians(angle)) / (2.1e11 * SECOND_MOMENT)
    euler, greenhill = 0.25 * np.pi**2 / 10.0**2, 7.8373 / 10.0**3
    share = along * (500.0 / euler + 7850.0 * AREA / greenhill)
    np.testing.assert_allclose(moved, expected / (1.0 - share), rtol=1e-6 + 0.1 * abs(share))


def test_a_payload_weighs_by_itself_alone_without_gravity(tmp_path: Path) -> None:
    """Reference: analytic, F L³/3 E J with standard gravity or the payload's own."""
    rest = '[payload]\nmass = 500.0\n{}\n[start]\nstate = "equilibrium"\n'
    for line, acceleration in (("", 9.80665), ("gravity = 4.0", 4.0)):
        moved = tip(read(tmp_path, rest.format(line)))
        expected = -500.0 * acceleration * 10.0**3 / 3.0 / (2.1e11 * SECOND_MOMENT)
        np.testing.assert_allclose(moved, expected, rtol=1e-6)


def test_a_segment_has_its_own_material(tmp_path: Path) -> None:
    """Reference: analytic, ρ A and E of each segment, by default with the material of the case."""
    (arm,) = build_boom(read(tmp_path, segment=f"material = {ALUMINIUM}")).segments
    assert arm.mass_per_length == pytest.approx(2700.0 * AREA, rel=1e-12)
    assert arm.bending_stiffness == pytest.approx(7e10 * SECOND_MOMENT, rel=1e-12)
    assert arm.rotary_inertia == pytest.approx(2700.0 * SECOND_MOMENT, rel=1e-12)
    (arm,) = build_boom(read(tmp_path)).segments
    assert (arm.material.density, arm.material.yield_strength) == (7850.0, 690e6)


def test_case_needs_no_material_besides_those_of_all_segments(tmp_path: Path) -> None:
    case = read(tmp_path, material="# none\n", segment=f"material = {ALUMINIUM}")
    (arm,) = build_boom(case).segments
    assert arm.material.youngs_modulus == 7e10
    assert read_case(tmp_path, toml.dumps(case)) == case


@pytest.mark.parametrize(
    ("rest", "material", "line"),
    [
        ("",
         "# none\n",
         "material: missing, and 'arm' has none of its own; it is the table of elastic "
         "constants and density, for all segments without a material of their own"),
        ("[payload]\nmass = 5.0\ngravity = 4.9\n[gravity]\nangle = 60.0",
         "",
         "payload.gravity: the table gravity is given, by which the payload weighs too; leave "
         "one of them out"),
    ],
)  # fmt: skip
def test_bad_gravity_is_refused(tmp_path: Path, rest: str, material: str, line: str) -> None:
    assert refusal(tmp_path, text_of(rest, material)) == line

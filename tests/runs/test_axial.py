# SPDX-License-Identifier: LGPL-3.0-or-later
"""Weights, materials and axial forces of a case: values, second-order effects, refusals."""

from pathlib import Path

import numpy as np
import pytest

from protractile.cases import run_case
from protractile.geometry.box import BoxSection
from protractile.geometry.typography import number
from protractile.runs import CASES
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.report.model_tables import buckling_table
from tests.runs.case_texts import (
    CLAMPED,
    REST,
    STEEL,
    box,
    elements,
    joint,
    read_case,
    refusal,
    table,
)
from tests.runs.summaries import printed_check

LIFT = f"""
title = "Lift"
[time]
duration = 0.05
{STEEL}
{box("mast", (0.0, 8.0), (0.40, 0.30, 0.008, 0.006), CLAMPED)}
{box("fly", (6.0, 14.0), (0.36, 0.26, 0.006, 0.005))}
{joint("fly", "mast", 0.01, (6.0, 8.0))}
{table("[[load]]", segment="fly", x=14.0, magnitude=-600.0)}
{elements("beam", theory="euler-bernoulli")}
"""
BONDED = elements("bonded", theory="euler-bernoulli", bonded=True)
MAST = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
FLY = BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005)


def pressed(folder: Path, text: str) -> list[list[float]]:
    """Return P at 3 and 7 m of the mast, and at 7 and 13 m of the fly."""
    boom = build_boom(read_case(folder, LIFT + text))
    places = (np.array([3.0, 7.0]), np.array([7.0, 13.0]))
    return [s.compression(x).tolist() for s, x in zip(boom.segments, places, strict=True)]


def test_weight_goes_along_as_the_angle_says(tmp_path: Path) -> None:
    """Reference: analytic, outboard masses times g sin θ; tension if the boom hangs."""
    mast, fly = 7850.0 * MAST.area, 7850.0 * FLY.area
    text = "[gravity]\nangle = {}\n[payload]\nmass = 300.0\n"
    for angle, part in ((30.0, 0.5), (90.0, 1.0), (-30.0, -0.5)):
        g = part * 9.80665
        expected = [
            [g * (5.0 * mast + 8.0 * fly + 300.0), g * mast],
            [g * (7.0 * fly + 300.0), g * (fly + 300.0)],
        ]
        found = pressed(tmp_path, text.format(angle))
        np.testing.assert_allclose(found, expected, rtol=1e-9)
    assert pressed(tmp_path, text.format(0.0)) == [[0.0, 0.0], [0.0, 0.0]]


@pytest.mark.parametrize(
    ("text", "force"),
    [
        ("[[axial]]\nforce = 5e3\n", 5e3),
        ("[rope]\nfalls = 2\n[payload]\nmass = 600.0\ngravity = 5.0\n", 600.0 * 5.0 / 2),
        ("[rope]\nfalls = 2\n[payload]\nmass = 600.0\n[gravity]\n", 300.0 * 9.80665),
    ],
)  # fmt: skip
def test_a_rope_presses_the_boom_from_tip_to_base(tmp_path: Path, text: str, force: float) -> None:
    """Reference: analytic, the carried weight over the number of falls."""
    np.testing.assert_allclose(pressed(tmp_path, text), [[force, 0.0], [force, force]], rtol=1e-12)


def test_a_force_may_act_anywhere_and_pass_at_a_pin(tmp_path: Path) -> None:
    text = '[[axial]]\nforce = 5e3\nsegment = "fly"\nx = 10.0\n'
    assert pressed(tmp_path, text) == [[5e3, 0.0], [5e3, 0.0]]
    locked = (LIFT + text).replace("play = 0.01", "play = 0.01\nlocked_at = 8.0")
    mast, fly = build_boom(read_case(tmp_path, locked)).segments
    assert mast.compression(np.array([7.0])).tolist() == [5e3]
    assert fly.compression(np.array([7.0, 9.0])).tolist() == [0.0, 5e3]


def test_a_pressed_boom_rests_lower(tmp_path: Path) -> None:
    """Reference: analytic, δ₀/(1 − 1/λ) of the bonded boom within 2 %, with λ of the run."""
    rest = '[start]\nstate = "equilibrium"\n' + BONDED
    tips = {}
    for name, text in (("straight", ""), ("pressed", "[[axial]]\nforce = 1.5e5\n")):
        results = run_case(read_case(tmp_path, LIFT + text + rest), models=["bonded"])
        tips[name] = float(results.trajectories["tip"].values[0, -1])
        summary = results.summary.models["bonded"]
        assert summary.static_tip == pytest.approx(tips[name], rel=1e-6)
    factor = summary.critical_factor
    assert 2.0 < factor < 10.0
    assert tips["pressed"] / tips["straight"] == pytest.approx(1.0 / (1.0 - 1.0 / factor), rel=0.02)
    assert summary.energy_residual < 1e-9


def test_check_and_report_tell_the_buckling_factor(tmp_path: Path) -> None:
    """Reference: the summary of the run."""
    case = read_case(tmp_path, LIFT + "[[axial]]\nforce = 4e4\n" + BONDED)
    results = run_case(case)
    table = buckling_table(results)
    factor = results.summary.models["bonded"].critical_factor
    shown = printed_check(case, 120)
    words = [line.replace("│", " ").split() for line in shown.splitlines()]
    assert ["mast", "−40", number(-0.04 / MAST.area, 4)] in words
    assert number(factor, 4) in shown
    assert f"{100.0 / factor:.3g}" in shown
    assert table.rows[1][1:3] == (f"{factor:.4g}", f"{100.0 / factor:.3g}")
    assert buckling_table(run_case(read_case(tmp_path, LIFT + BONDED))) is None


@pytest.mark.parametrize(
    ("text", "caution"),
    [
        ("", None),
        ("[[axial]]\nforce = 1e4\n", None),
        ("[[axial]]\nforce = 3e5\n",
         "caution: in bonded the axial forces are 48.2 % of those under which the boom buckles, "
         "more than a third: deflections grow out of proportion"),
        ('[[load]]\nsegment = "fly"\nx = 14.0\nmagnitude = -1.2e5\n',
         "caution: {} the tip rests at -2.16 m, 15 % of the boom's length: small displacements "
         "make it about 2.6 % too large, and moments about 1.5 %; check units and loads"),
    ],
)  # fmt: skip
def test_cautions_in_check_and_report(tmp_path: Path, text: str, caution: str | None) -> None:
    case = read_case(tmp_path, (LIFT + text + BONDED).replace("= 0.05", "= 0.5"))
    checked = printed_check(case).splitlines()
    told = run_case(case, models=["bonded"]).summary.cautions
    if caution is None:
        assert told == []
        assert not any(line.startswith("caution") for line in checked)
    else:
        # With play the tip rests lower by what the fly tilts.
        start, _, _ = caution.format("in the beam estimate").partition("2.16")
        assert any(line.startswith(start) for line in checked)
        assert caution.format("in bonded") in told


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("[[axial]]\nforce = 1e6\n",
         "model[1]: the boom of 'beam' buckles under 0.622 times its axial forces, and has no "
         "motion; it must bear more than all of them: make these smaller, or the sections "
         "larger"),
        ("[[axial]]\nx = 3.0\n",
         "axial[1].force: missing; it is the force in N towards the base"),
        ("[rope]\n[payload]\nmass = 100.0\n",
         "rope.falls: missing; it is the number of falls between head and hook; those of the table "
         "hoist unless given"),
        ("[payload]\nmass = 5.0\ngravity = 4.9\n[gravity]\nangle = 60.0\n",
         "payload.gravity: the table gravity is given, by which the payload weighs too; leave "
         "one of them out"),
    ],
)  # fmt: skip
def test_bad_axial_forces_are_refused(tmp_path: Path, text: str, line: str) -> None:
    assert refusal(tmp_path, LIFT + text) == line


TAPERED = """section = { height = 0.7, width = 0.3, flange = 0.012, web = 0.012 }
head_section = { height = 0.5, width = 0.3, flange = 0.006, web = 0.006 }
"""
PRESSED = table("[[axial]]", force=3e5) + elements("beam", theory="euler-bernoulli")


def test_tapered_boom_has_the_largest_stress_at_the_extension(tmp_path: Path) -> None:
    """Reference: by hand, 300 kN on four walls, at 9 m of 6.6 mm, nine tenths of the taper."""
    head, outer, inner, *_ = (CASES / "drawn-out.toml").read_text("utf-8").split("[[segment]]\n")
    numbers = outer[outer.index("mass_per_length") : outer.index("load")]
    box = "section = { height = 0.45, width = 0.25, flange = 0.006, web = 0.006 }\n"
    own = inner[inner.index("mass_per_length") : inner.index("load")]
    parts = head, outer.replace(numbers, TAPERED), inner.replace(own, box).partition("[[model]]")[0]
    case = read_case(tmp_path, "[[segment]]\n".join(parts) + PRESSED)
    rows = [line.replace("│", " ").split() for line in printed_check(case, 120).splitlines()]
    stress = 300e3 / (2.0 * (0.3 + 0.52) * 6.6e-3) / 1e6
    assert ["outer", "−300", number(-stress, 4)] in rows


OF_ARM = "youngs_modulus = 2.1e11\npoissons_ratio = 0.3\ndensity = 7850.0\nyield_strength = 690e6\n"
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


def read(folder: Path, rest: str = "", material: str = "", segment: str = "") -> Case:
    material = material or f"[material]\n{OF_ARM}"
    text = ARM.format(material=material, segment=segment, rest=rest) + ELEMENTS
    return read_case(folder, text)


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
    (steel,) = build_boom(read(tmp_path)).segments
    assert (steel.material.density, steel.material.yield_strength) == (7850.0, 690e6)
    case = read(tmp_path, material="# none\n", segment=f"material = {ALUMINIUM}")
    assert build_boom(case).segments == (arm,)
    assert read_case(tmp_path, toml.dumps(case)) == case

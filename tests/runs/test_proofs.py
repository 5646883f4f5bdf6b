# SPDX-License-Identifier: LGPL-3.0-or-later
"""Proofs of combinations: formulas by hand, the table, the exit status and the report."""

import json
import re
from math import pi, sqrt
from pathlib import Path

import numpy as np
import pytest

from protractile.analysis.plate_buckling import PlateStresses, reduced_stress
from protractile.analysis.rows import Row, Rows, static_rows
from protractile.cases import run_case
from protractile.geometry.box import BoxSection
from protractile.geometry.material import Material
from protractile.geometry.segment import Segment
from protractile.runs.pipeline.combinations import combination_states
from protractile.runs.pipeline.proofs import Proofs, prove
from protractile.runs.pipeline.proofs import proofs_of as rows_of_proofs
from protractile.runs.report.additions import Addition
from protractile.runs.report.document import render
from protractile.runs.report.proof_tables import governing_proof, holds, proof_text
from protractile.runs.report.static_tables import static_table
from tests.runs.case_texts import (
    CLAMPED,
    HINGED,
    STEEL,
    as_toml,
    box,
    edited,
    elements,
    joint,
    read_case,
    refusal,
    shipped,
    table,
)
from tests.runs.test_combinations import CASES, DEPTH, GROUND, LIFT, LUG, by_hand
from tests.system.run_folder import protractile

G = 9.80665
HEIGHT, WIDTH, FLANGE, WEB, LENGTH = 0.40, 0.30, 0.016, 0.008, 6.0
# A cantilever without weight, with a load across its tip and a force along it.
ARM = f"""
title = "An arm"
time = {{ duration = 1.0 }}
model = [{{ name = "beam", kind = "finite-element", theory = "timoshenko" }}]
life = {{ partial_factor = 1.15 }}
limits = {{ tip_at_rest = 0.05 }}
{STEEL}yield_by_thickness = [[0.008, 3.55e8], [0.016, 3.45e8], [0.04, 3.35e8]]
{box("arm", LENGTH, (HEIGHT, WIDTH, FLANGE, WEB), CLAMPED)}
collars = [{{ span = [2.0, 2.5], thickness = 0.01, detail_category = 50.0 }}]
diaphragms = [{{ x = 4.0, thickness = 0.01, detail_category = 71.0 }}]
"""
STORM = table(
    "[[spectrum]]", name="storm", load_cases=["empty", "loaded", "empty", "pulled"], repeats=2000
)
ARM += "".join(
    table("[[load_case]]", name=name, load=[{"segment": "arm", "x": "head", "magnitude": force}])
    for name, force in (("empty", -10e3), ("loaded", -50e3), ("pulled", 20e3))
)
ARM += table("[[spectrum]]", name="day", load_cases=["empty", "loaded"], repeats=100000) + STORM
ARM += table(
    "[[combination]]", name="A", factors={"payload": 1.5},
    resistance={"material": 1.1, "stability": 1.2}, proofs=["yield", "plate", "deflection"],
)  # fmt: skip


def second_moment() -> float:
    """Return the second moment of the walls by their mid-lines, as in a thin-walled section."""
    return FLANGE * WIDTH * HEIGHT**2 / 2.0 + WEB * HEIGHT**3 / 6.0 + WIDTH * FLANGE**3 / 6.0


def shear_stiffness() -> float:
    """Return G A_s of the cantilever's webs in N."""
    return 2.1e11 / 2.6 * 2.0 * WEB * HEIGHT


def proofs_of(folder: Path, text: str) -> tuple[dict[tuple[str, str], Row], Proofs]:
    """Return the proofs by kind and part, for pads with the station, and all proofs."""
    case = read_case(folder, text)
    found = prove(case, combination_states(case))
    stations = [row.place.rpartition(", ")[0] for row in found.rows]
    parts = [
        ", ".join(filter(None, (r.part, s))) for r, s in zip(found.rows, stations, strict=True)
    ]
    return {(r.quantity, part): r for r, part in zip(found.rows, parts, strict=True)}, found


def test_reduced_stress_of_a_wall() -> None:
    """Reference: by hand, b/t = 60 in compression with shear; EN 1993-1-5, 10 (5) b."""
    steel = Material(
        youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0, yield_strength=460e6
    )
    box = BoxSection(height=0.36, width=0.36, flange=0.006, web=0.006)
    arm = Segment.of_section("arm", 0.0, 5.0, steel, box)
    edges, shear = np.full((2, 1, 1, 1), -150e6), np.array([[[40e6]]])
    slenderness = np.array([[[60.0]]])
    wall = PlateStresses(arm, box.plates[:1], np.zeros(1), edges, edges, edges, shear, slenderness)
    unit = pi**2 * 2.1e11 / (12.0 * 0.91 * 60.0**2)
    pressed, sheared = 150e6 / (4.0 * unit), 40e6 / (5.34 * unit)
    # For uniform compression (10.6) is 1/α = 1/2α_x + √(1/4α_x² + 1/α_τ²).
    inverse = 0.5 * pressed + sqrt(0.25 * pressed**2 + sheared**2)
    equivalent = sqrt(150e6**2 + 3.0 * 40e6**2)
    slenderness = sqrt(460e6 / equivalent * inverse)
    rho, chi = (slenderness - 0.22) / slenderness**2, 0.83 / slenderness
    by_hand = sqrt((150e6 / rho) ** 2 + 3.0 * (40e6 / chi) ** 2)
    # k of the table is 8.2/2.05 = 4.0.
    assert reduced_stress(wall) == pytest.approx(by_hand, rel=1e-12)
    own = reduced_stress(wall, [(0.0, 1.0), (slenderness, 0.5), (3.0, 0.1)])
    assert own == pytest.approx(equivalent / 0.5, rel=1e-9)


def test_the_factor_falls_beyond_the_end_of_a_curve(tmp_path: Path) -> None:
    """Reference: a longer curve that falls with the square of the slenderness from its end on."""
    # Slendernesses of a curve that ends beyond all walls.
    beyond = [(s, 0.036 / s**2) for s in np.linspace(0.2, 4.0, 1600).tolist()]
    found = []
    for pairs in ([(0.2, 0.9)], beyond):
        curve = as_toml([[0.0, 1.0], *map(list, pairs)])
        text = edited(ARM, ("\nlimits", f"\nbuckling = {{ curve = {curve} }}\nlimits"))
        proofs, whole = proofs_of(tmp_path, text)
        found.append((proofs["plate", "arm"].utilisation, " ".join(whole.notes)))
    (short, notes), (longer, none) = found
    assert short == pytest.approx(longer, rel=1e-4)
    assert "`buckling.curve` ends at a slenderness of 0.2, and the " in notes
    assert "buckling.curve" not in none


def test_yield_plate_and_deflection_of_a_cantilever(tmp_path: Path) -> None:
    """Reference: analytic. The flanges have 345 MPa, the webs 355 MPa and the mean shear of V."""
    found, _ = proofs_of(tmp_path, ARM)
    force = 75e3
    fibre = 0.5 * (HEIGHT + FLANGE) * force * LENGTH / second_moment()
    shear = force / (2.0 * WEB * HEIGHT)
    of_flange, of_web = fibre / 345e6, sqrt(fibre**2 + 3.0 * shear**2) / 355e6
    one = found["yield", "arm"]
    assert one.state == "combination A, loaded"
    assert one.utilisation == pytest.approx(1.1 * max(of_flange, of_web), rel=1e-3)
    assert ("right" in one.place) == (of_web > of_flange)
    # Stocky walls are not reduced; mid-lines have less stress than outer fibres.
    middle = fibre * HEIGHT / (HEIGHT + FLANGE)
    assert found["plate", "arm"].utilisation == pytest.approx(1.2 * middle / 345e6, rel=1e-3)
    tip = found["deflection", "tip"]
    bent = force * LENGTH**3 / (3.0 * 2.1e11 * second_moment())
    assert tip.value == pytest.approx(bent + force * LENGTH / shear_stiffness(), rel=2e-3)
    assert tip.limit == 0.05


def test_plates_have_their_own_steel(tmp_path: Path) -> None:
    """Reference: other input, the whole arm of the steel of each plate."""

    def rows(text: str) -> Rows:
        case = read_case(tmp_path, text)
        (states,) = (one for one in combination_states(case) if "loaded" in one.combined.name)
        return Rows([*rows_of_proofs(states, case), *states.rows.where(quantity="stress")])

    steels = {"bottom": 9.6e8, "right": 6.9e8, "left": 6.9e8}
    mixed = rows(ARM.replace("collars", f"yield_strengths = {as_toml(steels)}\ncollars", 1))
    for plate, strength in {**steels, "top": 3.45e8}.items():
        whole = rows(re.sub("yield_by_thickness = .*", f"yield_strength = {strength}", ARM))
        for kind in ("yield", "plate"):
            (one,), (other,) = (each.where(quantity=kind, place=plate) for each in (mixed, whole))
            assert one.utilisation == pytest.approx(other.utilisation, rel=1e-12)
    # The outer fibres have the steel of the weaker plate, those above that of the top.
    assert {row.limit for row in mixed.where(quantity="stress")} == {3.45e8}


def test_a_combination_in_motion(tmp_path: Path) -> None:
    """Reference: analytic. A sudden load has twice the deflection, 97 % of it in the first mode."""
    found, _ = proofs_of(tmp_path, ARM)
    text = ARM.replace("factors", "motion = true\nfactors", 1).replace("= 1.0 }", "= 0.2 }", 1)
    moved, _ = proofs_of(tmp_path, text)
    both = found["deflection", "tip"].value, moved["deflection", "tip"].value
    assert both[1] == pytest.approx(2.0 * both[0], rel=0.03)
    assert moved["yield", "arm"].value > 1.9 * found["yield", "arm"].value


def damage_by_hand(x: float, category: float) -> float:
    """Return Miner's sum by EN 1993-1-9, 7.1, of both spectra at x in m."""

    def stress(force: float) -> float:
        return 0.5 * (HEIGHT + FLANGE) * force * (LENGTH - x) / second_moment() / 1e6

    def endured(size: float) -> float:
        constant = 0.737 * category
        if 1.15 * size < 0.549 * constant:
            return np.inf
        slope = 3.0 if 1.15 * size >= constant else 5.0
        return 5e6 * (constant / (1.15 * size)) ** slope

    # The storm has one range from loaded to pulled, and one between the empty states, which is 0.
    return 1e5 / endured(stress(40e3)) + 2e3 / endured(stress(70e3))


@pytest.mark.parametrize(
    ("name", "x", "category"),
    [("collar", 2.0, 50.0), ("diaphragm", 4.0, 71.0), ("worst weld", 0.0, 80.0)],
)
def test_damage_of_details(tmp_path: Path, name: str, x: float, category: float) -> None:
    """Reference: by hand. The standard's limits have three digits, twice with slope 5."""
    found, _ = proofs_of(tmp_path, ARM.replace("{ partial", "{ detail_category = 80.0, partial"))
    one = found["fatigue", f"{name}, arm"]
    assert one.value == pytest.approx(damage_by_hand(x, category), rel=5e-3)
    assert (one.state, one.x) == ("spectrum day", x)


@pytest.mark.slow
def test_cycles_of_a_motion(tmp_path: Path) -> None:
    """Reference: other code path, a run's fatigue life with half a cycle more of fifty."""
    text = edited(
        ARM,
        ("{ partial", "{ detail_category = 80.0, partial"),
        ("= 1.0 }", "= 4.0, output_step = 4e-3 }"),
        ('["empty", "loaded"]', '["loaded", "loaded"]\nmotion = true'),
        (STORM, ""),
    )
    found, _ = proofs_of(tmp_path, text)
    whole = found["fatigue", "worst weld, arm"].value
    load = table("[[load]]", segment="arm", x="head", magnitude=-50e3)
    alone = run_case(read_case(tmp_path, text[: text.index("[[load_case]]")] + load))
    (one,) = alone.rows.where(quantity="run_damage", play=True)
    assert whole == pytest.approx(2e5 * one.value, rel=0.03)


PINNED = (
    LIFT.replace("stiffness = 3e7 }", "stiffness = 3e7, capacity = 3e5, "
                 "pin = { diameter = 0.05, strength = 6e8, planes = 4 } }")
    .replace('"hinged" }', '"hinged", pin = { diameter = 0.06, strength = 6e8 } }')
    .replace('"corner" }', '"corner", allowable_pressure = 5e6 }')
)  # fmt: skip
STRONG = table(
    "[[combination]]", name="A", load_cases=["level"],
    factors={"dead": 1.32, "payload": 1.34, "wind": 0.0},
    resistance={"cylinder": 1.2, "pin": 1.25, "pad": 2.0},
)  # fmt: skip


def test_cylinder_and_pins_of_a_lift(tmp_path: Path) -> None:
    """Reference: analytic, moments about the pin; EN 1993-1-8, table 3.10."""
    found, proofs = proofs_of(tmp_path, PINNED + CASES + STRONG)
    force = by_hand(0.0, 2.0, 1.32, 1.34, 0.0)
    assert found["cylinder", "cylinder"].utilisation == pytest.approx(1.2 * force / 3e5, rel=1e-4)
    shear = 4.0 * 0.6 * 0.25 * pi * 0.05**2 * 6e8
    assert found["pin", "cylinder"].utilisation == pytest.approx(1.25 * force / shear, rel=1e-4)
    assert found["pin", "foot, base"].limit == pytest.approx(0.5 * shear * 1.44 / 1.25)
    states = combination_states(read_case(tmp_path, PINNED + CASES + STRONG))
    pad = found["pad", "fly, station 2"]
    assert pad.place == "station 2, below"
    (pressure,) = states[0].rows.where(quantity="pad_pressure", part="fly", place=pad.place)
    assert pad.utilisation == pytest.approx(2.0 * pressure.value / 5e6, rel=1e-12)
    assert proofs.notes == [
        "Static strength and plate buckling of base, fly are not proved: no yield strength.",
        "Local plate stress is not proved: these proofs use a beam, which has none. `protractile "
        "prove CASE.toml --shell NAME` proves it by a shell of the case.",
        "Column buckling is not proved: along the boom only cylinders press.",
        "Fatigue strength is not proved: the case has no `[[spectrum]]`.",
        "Static tip deflection is not proved: no combination lists `deflection`.",
    ]


@pytest.mark.parametrize(
    ("ground", "data", "proved", "words"),
    [
        (
            "[0.8, -1.2]",
            {},
            True,
            "Oil pressure of the cylinder is not proved: it has no `pressure`",
        ),
        (
            "[0.8, 1.2]",
            {},
            False,
            "Oil pressure of the cylinder is not proved: it has no `pressure`",
        ),
        ("[0.8, 1.2]", {"pressure": 2.5e7}, True, ""),
        ("[0.8, 1.2]", {"rod": None, "pressure": 2.5e7}, False, "Buckling of the rod of the cyl"),
        ("[0.8, 1.2]", {"rod": None}, False, "Force of the cylinder is not proved: it has no `cap"),
        ("[0.8, 1.2]", {"rod": None, "capacity": 3e5}, True, ""),
    ],
)
def test_a_cylinder_without_pressure(
    tmp_path: Path, ground: str, data: dict[str, float | None], proved: bool, words: str
) -> None:
    """Reference: analytic. A push is proved by the buckling of the rod, a pull by the pressure."""
    keys = {"bore": 0.14, "rod": 0.1} | data
    given = "".join(f", {key} = {value}" for key, value in keys.items() if value is not None)
    text = LIFT.replace(str(list(GROUND)), ground).replace("= 3e7 }", f"= 3e7{given} }}")
    found, proofs = proofs_of(tmp_path, text + CASES + STRONG)
    assert (("cylinder", "cylinder") in found) == proved
    notes = [note for note in proofs.notes if "the cylinder" in note]
    assert [note[: len(words)] for note in notes] == [words] * bool(words)
    if proved and "capacity" not in data:
        # The boom lies, and its ground is given at 45 degrees.
        end = complex(*json.loads(ground)) * 1j**0.5
        away = abs(LUG - DEPTH * 1j - end) ** 2
        buckling = pi**3 * 2.1e11 * 0.1**4 / 64.0 / away
        limit = 2.5e7 * 0.25 * pi * (0.14**2 - 0.1**2) if data else buckling
        assert found["cylinder", "cylinder"].limit == pytest.approx(limit / 1.2, rel=1e-9)


def test_a_slender_column_buckles(tmp_path: Path) -> None:
    """Reference: analytic, Euler's cantilever π² E J/(4 L²) with shear (Engesser 1891)."""
    text = ARM.replace("load = [{", "axial = [{ force = 2e6 }]\nload = [{")
    text = text.replace('"yield", ', '"column", ')
    found, _ = proofs_of(tmp_path, text)
    euler = pi**2 * 2.1e11 * second_moment() / (4.0 * LENGTH**2)
    column = found["column", "boom"]
    assert column.value == pytest.approx(1.5 * 2e6)
    engesser = 1.0 / (1.0 / euler + 1.0 / shear_stiffness())
    assert column.limit == pytest.approx(engesser / 1.2, rel=2e-3)


@pytest.mark.parametrize(("force", "status"), [(50e3, 0), (150e3, 1)])
def test_exit_status_and_width(
    here: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
    force: float,
    status: int,
) -> None:
    """Proofs that fail are on stderr alone."""
    monkeypatch.setenv("COLUMNS", "80")
    text = ARM.replace("-50000.0", f"-{force}").replace("repeats = 100000", "repeats = 1")
    Path("arm.toml").write_text(text.replace("tip_at_rest = 0.05", "tip_at_rest = 1.0"), "utf-8")
    assert protractile("prove", "arm.toml") == status
    shown = capsys.readouterr()
    assert max(map(len, shown.out.splitlines())) <= 80
    for words in ("All 5 proofs of the combinations are satisfied", "Governing"):
        assert (words in shown.out) == (status == 0)
    failed = shown.err.strip().splitlines()
    assert len(failed) == 2 * status
    assert all("exceeds" in failed[0] and "static strength, arm" in shown.err for _ in failed)


def test_a_case_without_combinations_is_proved_itself(tmp_path: Path) -> None:
    """Reference: by construction. The sentences named combinations."""
    nothing = dict.fromkeys(("load_cases", "combinations", "spectra"), ())
    case = read_case(tmp_path, ARM).model_copy(update=nothing)
    proofs = prove(case, combination_states(case))
    sentence = governing_proof(proofs, case.system)
    assert "combination" not in sentence
    assert sentence.startswith(f"All {len(proofs.rows)} proofs are satisfied")


def test_the_first_screen_of_the_report(tmp_path: Path) -> None:
    results = run_case(read_case(tmp_path, ARM))
    page = render(results, Addition(), [], [])
    proofs = Proofs.among(results.rows, results.summary.design.proof_notes, results.case)
    sentence = governing_proof(proofs, results.case.system)
    assert sentence.split(". Governing")[0] in page.split("<table")[0]
    for title in ("Largest results of each combination", "Envelope of the combinations", "Proofs"):
        assert title in page


def test_shipped_cases_are_proved() -> None:
    """Reference: non-regression. The crane's slender webs fail in buckling alone."""
    for name, weak in (
        ("lift", ()),
        ("inspection-arm", ()),
        ("crane-proof", ("base", "second", "third", "fly")),
    ):
        case = shipped(name)
        found = prove(case, combination_states(case))
        assert {"deflection", "fatigue"} <= {row.quantity for row in found.rows}
        failed = {(row.quantity, row.part) for row in found.rows if not holds(row)}
        assert failed == {("plate", part) for part in weak}
    first = proof_text(found.rows[0], found, case.system)
    assert first.startswith("plate buckling, base, right side, wall 1 from below at x = 4.2 m: ")
    assert " MPa (stress / reduction factor) exceeds " in first


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("0.016, 3.45e8", "0.008, 3.45e8"),
         "material.yield_by_thickness: thicknesses must rise; entry 2 repeats that of entry 1"),
        (("yield_by", "yield_strength = 3e8\nyield_by"),
         "material: has yield_strength and yield_by_thickness; give one of them"),
        (("collars", "yield_strengths = { web = 9.6e8 }\ncollars"), "segment[1].yield_strengths: "
         "'web' is no plate of 'arm'; give 'bottom', 'right', 'top' or 'left'"),
        (('["empty", "loaded"]', '["empty", "full"]'), "spectrum[1].load_cases: 'full' is no load "
         "case; give 'empty', 'loaded' or 'pulled'"),
    ],
)  # fmt: skip
def test_bad_proofs(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    assert refusal(tmp_path, ARM.replace(*change)) == message


def test_cylinders_are_judged_by_the_forces_that_they_carry(tmp_path: Path) -> None:
    """Reference: other code path, static results by the names of the cylinders. Of a pair in a boom
    in space one carries half of the sum and half of the difference, and half of the capacity.
    """
    jack = {"segment": "base", "depth": 0.2, "stiffness": 5e8}
    text = f"""
title = "Two cylinders"
time = {{ duration = 1.0 }}
gravity = {{ angle = 0.0 }}
start = {{ state = "equilibrium" }}
{STEEL}{elements("beam")}
{box("base", 6.0, (0.3, 0.2, 0.006, 0.005), HINGED)}
{box("fly", (4.5, 9.0), (0.25, 0.15, 0.005, 0.004))}
{joint("fly", "base", 0.002, (4.6, 5.9), "lateral_play = 0.002")}
{table("[[cylinder]]", x=2.0, ground=[0.7, -1.6], spread=0.5, capacity=3e5, **jack)}
{table("[[cylinder]]", x=4.0, ground=[2.5, -1.6], capacity=1e5, **jack)}
{table("[[load]]", segment="fly", x=9.0, magnitude=500.0, direction="y")}
{table("[[load]]", segment="fly", x=9.0, magnitude=-1000.0)}
"""
    found, _ = proofs_of(tmp_path, text)
    (state,) = combination_states(read_case(tmp_path, text))
    (apart,) = state.rows.where(quantity="cylinder_force_difference")
    both, force = state.rows.where(quantity="cylinder_force")
    assert found["cylinder", "cylinder 2"].value == pytest.approx(force.value)
    larger = found["cylinder", "cylinder 1"]
    assert larger.value == pytest.approx(0.5 * (abs(both.value) + abs(apart.value)))
    assert larger.limit == pytest.approx(0.5 * 3e5)
    assert abs(apart.value) > 0.1 * abs(both.value)
    assert state.states is not None
    rows = Rows(static_rows(state.states, "beam"))
    shown = static_table(state.combined.case, state.states.boom, rows)
    (used,) = (row[-1] for row in shown.rows if row[0].startswith("larger force of two cylinders"))
    assert used == f"{100.0 * larger.utilisation:.3g}"

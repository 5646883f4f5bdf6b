# SPDX-License-Identifier: LGPL-3.0-or-later
"""Load cases and combinations of a case, their statics, and their tables."""

from math import cos, hypot, radians, sin
from pathlib import Path

import pytest

from protractile.analysis.rows import COMBINATION, Row
from protractile.runs.case.reading import convert_to_si
from protractile.runs.pipeline.combinations import combination_rows
from protractile.runs.report.static_tables import combination_tables, row_name
from tests.runs.case_texts import HINGED, box, read_case, refusal, table
from tests.runs.summaries import printed_check

G = 9.80665
# A stiff lift of two boxes, so that deflections hardly change lever arms.
HEIGHT, WIDTH, WALL = 0.30, 0.22, 0.006
CAGE, PEOPLE, WIND = 150.0, 230.0, 900.0
LUG, DEPTH, GROUND = 2.4, 0.25, (0.7, -1.1)
ENDS = {"stations": ["tail", "head"]}
PAD = {"length": 0.1, "width": 0.05, "thickness": 0.012, "bears": "corner"}
LIFT = f"""
title = "A lift of two boxes"
time = {{ duration = 1.0 }}
gravity = {{ angle = 45.0 }}
payload = {{ mass = {CAGE}, group = "dead" }}
cylinder = [
  {{ segment = "base", x = {LUG}, depth = {DEPTH}, ground = {list(GROUND)}, stiffness = 3e7 }},
]
material = {{ youngs_modulus = 9e11, poissons_ratio = 0.3, density = 7850.0 }}
model = [{{ name = "beam", kind = "finite-element", theory = "timoshenko" }}]
load = [{{ segment = "fly", x = "head", magnitude = -1595.0, ramp = 0.1 }}]
{box("base", 6.0, (HEIGHT, WIDTH, WALL, WALL), HINGED)}
{box("fly", 5.0, (0.25, 0.18, WALL, WALL))}
{table("[[joint]]", outer="base", inner="fly", extension=4.0, **ENDS, play=0.003, pad=PAD)}
"""
CASES = table("[[load_case]]", name="raised", payload=PEOPLE, load=[]) + table(
    "[[load_case]]", name="level", angle=0.0, extension={"fly": 2.0}, payload=PEOPLE,
    load=[{"segment": "fly", "x": "head", "magnitude": -WIND, "group": "wind"}],
)  # fmt: skip
FACTORS = table(
    "[[combination]]", name="A", factors={"dead": [1.2, 1.1], "payload": 1.34, "wind": 0.0}
) + table(
    "[[combination]]", name="B", load_cases=["level"],
    factors={"dead": 0.0, "payload": 1.1, "wind": 1.22},
)  # fmt: skip


def results(folder: Path, text: str) -> dict[str, dict[tuple[str, str, str], Row]]:
    """Return the rows of each combination by quantity, part and place."""
    found: dict[str, dict[tuple[str, str, str], Row]] = {}
    for row in combination_rows(read_case(folder, text)):
        found.setdefault(row.state.removeprefix(COMBINATION), {})[row.key] = row
    return found


TIP, CYLINDER = ("tip", "tip", ""), ("cylinder_force", "cylinder", "")


def by_hand(angle: float, extension: float, dead: float, people: float, wind: float) -> float:
    """Return the force of the cylinder in N, from moments about the pin, in upright axes."""
    turn = radians(angle)
    moment = wind * (6.0 + extension)
    for height, width, length, start in (
        (HEIGHT, WIDTH, 6.0, 0.0), (0.25, 0.18, 5.0, 1.0 + extension),
    ):  # fmt: skip
        mass = 7850.0 * 2.0 * WALL * (height + width) * length
        moment += dead * mass * G * (start + 0.5 * length) * cos(turn)
    moment += (dead * CAGE + people * PEOPLE) * G * (6.0 + extension) * cos(turn)
    # The ground end stays where it is at 45 degrees; the lug moves with the boom.
    old = radians(45.0)
    x0 = GROUND[0] * cos(old) - GROUND[1] * sin(old)
    z0 = GROUND[0] * sin(old) + GROUND[1] * cos(old)
    x1, z1 = LUG * cos(turn) + DEPTH * sin(turn), LUG * sin(turn) - DEPTH * cos(turn)
    arm = (x1 * (z1 - z0) - z1 * (x1 - x0)) / hypot(x1 - x0, z1 - z0)
    return moment / arm


def test_the_cylinder_of_a_lift_in_all_combinations(tmp_path: Path) -> None:
    """Reference: analytic, moments about the pin, with wall areas of mid-lines."""
    found = results(tmp_path, LIFT + CASES + FACTORS)
    assert [*found] == ["A, raised", "A, level", "B, level"]
    for name, numbers in (
        ("A, raised", (45.0, 4.0, 1.32, 1.34, 0.0)),
        ("A, level", (0.0, 2.0, 1.32, 1.34, 0.0)),
        ("B, level", (0.0, 2.0, 0.0, 1.1, 1.22 * WIND)),
    ):
        # Deflections change lever arms at 45 degrees by less than 0.5 %.
        force = found[name][CYLINDER].value
        assert force == pytest.approx(by_hand(*numbers), rel=5e-3 if "raised" in name else 1e-4)


def test_pads_and_foot_of_a_combination(tmp_path: Path) -> None:
    """Reference: analytic, lever rule on the level fly between the centres of its pads."""
    level = results(tmp_path, LIFT + CASES + FACTORS)["B, level"]
    tip = 1.1 * PEOPLE * G + 1.22 * WIND
    for place, lever in (("station 1, above", 2.05), ("station 2, below", 4.95)):
        # Two pads of 0.1 m x 0.05 m share the force of a side.
        pressure = 0.5 * tip * lever / 2.9 / 0.005
        assert level["pad_pressure", "fly", place].value == pytest.approx(pressure, rel=1e-4)
    # The pin takes what the cylinder pushes, less the loads at the tip.
    turn = radians(45.0)
    x0 = GROUND[0] * cos(turn) - GROUND[1] * sin(turn)
    z0 = GROUND[0] * sin(turn) + GROUND[1] * cos(turn)
    length = hypot(LUG - x0, -DEPTH - z0)
    force = by_hand(0.0, 2.0, 0.0, 1.1, 1.22 * WIND)
    across, along = force * (-DEPTH - z0) / length - tip, force * (LUG - x0) / length
    foot = level["foot_reaction", "base", "at 0 m"]
    assert foot.value == pytest.approx(hypot(across, along), rel=1e-4)


def test_load_cases_alone_have_unit_factors(tmp_path: Path) -> None:
    """Reference: a separate case of the same boom."""
    found = results(tmp_path, LIFT + CASES)
    assert [*found] == ["raised", "level"]
    alone = LIFT.replace("magnitude = -1595.0", "magnitude = 0.0").replace(
        f"mass = {CAGE}", f"mass = {CAGE + PEOPLE}"
    )
    other = results(tmp_path, alone + '[[load_case]]\nname = "same"\n')["same"]
    for key, one in found["raised"].items():
        assert one.value == pytest.approx(other[key].value, rel=1e-12)


def test_without_gravity_the_payload_alone_weighs(tmp_path: Path) -> None:
    """Reference: analytic, the force at the tip."""
    text = LIFT.replace("gravity = { angle = 45.0 }\n", "") + FACTORS.replace("0.0, p", "1.0, p")
    text = text.replace('load_cases = ["level"]\n', "").replace('group = "dead"', 'group = "test"')
    text = text.replace("wind = 1.22", "test = 3.0").replace("wind = 0.0", "test = 2.0")
    found = results(tmp_path, text)
    arm = LUG * (-DEPTH - GROUND[1]) + DEPTH * (LUG - GROUND[0])
    arm /= hypot(LUG - GROUND[0], -DEPTH - GROUND[1])
    for name, payload, test in (("A", 1.34, 2.0), ("B", 1.1, 3.0)):
        force = 10.0 * (test * CAGE * G + payload * 1595.0) / arm
        assert found[name][CYLINDER].value == pytest.approx(force, rel=1e-3)


def test_load_cases_in_millimetres_and_from_files(tmp_path: Path) -> None:
    """Reference: non-regression, the same case in SI units. The file has the constant load."""
    (tmp_path / "wind.csv").write_text("0,1\n1,1\n", encoding="utf-8")
    text = (LIFT + CASES).replace('group = "wind"', 'group = "wind", file = "wind.csv"')
    plain = results(tmp_path, LIFT + CASES)["level"]
    assert results(tmp_path, text)["level"][TIP].value == pytest.approx(plain[TIP].value, rel=1e-12)
    case = read_case(tmp_path, LIFT + CASES)
    level = convert_to_si(case.model_copy(update={"units": "mm-t-s"})).load_cases[1]
    assert level.extension == {"fly": 0.002}
    assert level.payload == 1.0e3 * PEOPLE


def test_the_states_of_combinations_have_a_progress(tmp_path: Path) -> None:
    """Reference: by construction. Two load cases in one combination, and one in another."""
    told: list[float] = []
    case = read_case(tmp_path, LIFT + CASES + FACTORS)
    found = combination_rows(case, lambda model, stage, part: told.append(part))
    assert len({row.state for row in found}) == 3
    assert told == [0.0, 1 / 3, 2 / 3, 1.0]


def test_check_marks_the_governing_combination(tmp_path: Path) -> None:
    case = read_case(tmp_path, LIFT + CASES + FACTORS)
    found = combination_rows(case)
    first, envelope = combination_tables(found, case)
    lowest = min(found.where(quantity="tip"), key=lambda row: row.value)
    marked = dict(zip(first.columns[0].cells, first.columns[1].text, strict=True))
    governing = lowest.state.removeprefix(COMBINATION)
    assert [name for name, tip in marked.items() if "*" in tip] == [governing]
    cells = {row[0]: row[1:] for row in envelope.rows}
    assert cells["tip"][2] == governing
    of_pads = found.where(quantity="pad_pressure")
    named = {(row.state.removeprefix(COMBINATION), row_name(row, case.system)) for row in of_pads}
    pads = [name for name in cells if name.startswith("pad, fly at ")]
    assert len(pads) == 2
    assert all((cells[name][2], name) in named for name in pads)
    assert envelope.notes == [
        "Pads and contacts move with the extension; x is given for the governing combination."
    ]
    text = printed_check(case, 80)
    assert "Largest results of each combination" in text
    assert max(map(len, text.splitlines())) <= 80


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("dead = 0.0, ", ""), "combination[2].factors.dead: missing, and the weight of the "
         "boom is of this group; give its factor, 0 where it does not act"),
        (("payload = 1.1, ", ""), "combination[2].factors.payload: missing, and the payload of "
         "'level' is of this group; give its factor, 0 where it does not act"),
        ((", wind = 1.22", ""), "combination[2].factors.wind: missing, and load[1] is of this "
         "group; give its factor, 0 where it does not act"),
        (('["level"]', '["low"]'), "combination[2].load_cases: 'low' is no load case; give "
         "'raised' or 'level'"),
        (('name = "B"', 'name = "A"'), "combination[2].name: 'A' is the name of "
         "combination[1] already; give each its own"),
        (("fly = 2.0", "mid = 2.0"), "load_case[2].extension.mid: no joint has 'mid' as inner "
         "segment; give 'fly'"),
        (("fly = 2.0", "fly = 9.0"), "load_case[2].joint[1].extension: must be at least 0 m and "
         "below 5 m, so that 'fly' begins in 'base', got 9 m"),
        (("gravity = { angle = 45.0 }\n", ""), "load_case[2].angle: the case has no table gravity, "
         "whose angle it replaces"),
    ],
)  # fmt: skip
def test_bad_combinations(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    text = (LIFT + CASES + FACTORS).replace(*change)
    assert refusal(tmp_path, text) == message

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact laws that a case file gives as tables."""

from pathlib import Path

import numpy as np
import pytest

from dynamics.contact import PowerContact
from dynamics.contact_table import TableContact
from protractile.cases import change
from runs.case import toml
from runs.case.contact import JointTable
from runs.case.schema import Case
from tests.runs.case_texts import read_case, refusal
from tests.runs.coarse_case import COARSE
from tests.runs.summaries import motion_of
from tests.touching import contact_laws

LAW = "stiffness = 1e13\nexponent = 2.0\n"
# Penetrations of up to 0.5 mm, by 5 µm.
DEPTHS = np.linspace(0.0, 5.0e-4, 101)[1:]
POINTS = [[float(p), float(1e13 * p**2)] for p in DEPTHS]


def case_with(folder: Path, law: str) -> Case:
    return read_case(folder, COARSE.replace(LAW, law))


def test_table_approximates_the_sampled_law(tmp_path: Path) -> None:
    """Reference: analytic, chords of p² lie above it by k (Δp)²/4 at most."""
    case = case_with(tmp_path, f"force_table = {POINTS}\n")
    (law,) = contact_laws(case, case.models[0])
    power = PowerContact(1e13, 2.0).with_clearance(7.0e-3)
    y = np.concatenate([[-1.0], [1.0]]) * (7.0e-3 + np.linspace(0.0, 5.0e-4, 999)[:, None])
    above = np.abs(law.force(y)) - np.abs(power.force(y))
    assert -1e-6 < above.min() < 1e-6
    assert above.max() == pytest.approx(0.25 * 1e13 * (5.0e-6) ** 2, rel=1e-2)
    assert read_case(tmp_path, toml.dumps(case)) == case


def test_motion_of_a_table_follows_the_sampled_law(tmp_path: Path) -> None:
    """Reference: the power law. At 10 kN the chords have an error of 60 N."""
    tips = []
    for law in (LAW, f"force_table = {POINTS}\n"):
        case = change(case_with(tmp_path, law), **{"time.duration": 0.25})
        tips.append(motion_of(case, 1).data["tip"].values)
    assert np.abs(tips[1] - tips[0]).max() < 1e-3 * np.ptp(tips[0])


def test_a_file_and_a_model_s_own_table_are_the_same(tmp_path: Path) -> None:
    lines = "".join(f"{p!r}, {force!r}\n" for p, force in POINTS)
    (tmp_path / "pad.csv").write_text(f"# m, N\n{lines}", encoding="utf-8")
    inline = case_with(tmp_path, f"force_table = {POINTS}\n")
    assert case_with(tmp_path, 'force_file = "pad.csv"\n') == inline
    own = COARSE.partition("contact = {")
    model = 'contact = { force_file = "pad.csv" }'
    case = read_case(tmp_path, own[0] + model + own[2].partition("}")[2])
    (law,) = contact_laws(case, case.models[2])
    (same,) = contact_laws(inline, inline.models[2].model_copy(update={"contact": None}))
    assert law == same


def test_to_the_sides_a_stiffness_makes_a_power_law_beside_a_table() -> None:
    to_the_sides = {"lateral_play": 0.01, "lateral_stiffness": 1.0e9, "lateral_exponent": 1.5}
    table = ((1.0e-3, 2.0),)
    joint = JointTable("a", "b", stations=(1.0,), play=0.0, force_table=table, **to_the_sides)
    assert joint.law("y") == PowerContact(1.0e9, 1.5)
    assert joint.law("z") == TableContact((1.0e-3,), (2.0,))


@pytest.mark.parametrize(
    ("law", "message"),
    [
        ("exponent = 2.0", "joint[1].stiffness: missing; it is the contact stiffness in N/m^n "
         "where the inner segment presses up"),
        ("force_table = [[1e-3, 2.0]]\nstiffness = 1e9",
         "joint[1].stiffness: force_table is given; leave one of them out"),
        ("force_table = [[1e-3, 2.0]]\nstiffness_below = 0.0",
         "joint[1].stiffness_below: force_table is given; leave one of them out"),
        ("force_table = [[1e-3, 2.0]]\nexponent = 2.0",
         "joint[1].exponent: force_table is given; leave one of them out"),
        ("force_table = [[1e-3, 2.0]]\nlateral_play = 0.01\nlateral_exponent = 2.0",
         "joint[1].lateral_exponent: force_table is given; leave one of them out"),
        ('force_table = [[1e-3, 2.0]]\nforce_file = "back.csv"',
         "joint[1].force_file: force_table is given; leave one of them out"),
        ("force_table = [[0.0, 0.0], [1e-3, 2.0]]",
         "joint[1].force_table: depths must be finite and rise from above 0"),
        ('force_file = "back.csv"',
         "joint[1].force_file: 'back.csv' has a penetration in line 2 that does not rise; sort "
         "them"),
        ('force_file = "pulls.csv"',
         "joint[1].force_file: forces must be positive, and must not fall at the end"),
    ],
)  # fmt: skip
def test_bad_tables_are_refused(tmp_path: Path, law: str, message: str) -> None:
    for name, text in (("back", "2e-3, 1\n1e-3, 2\n"), ("pulls", "1e-3, 2\n2e-3, -1\n")):
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    assert refusal(tmp_path, COARSE.replace(LAW, f"{law}\n")) == message

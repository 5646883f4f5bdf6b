# SPDX-License-Identifier: LGPL-3.0-or-later
"""The tutorial's case gives the numbers that the page shows."""

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import protractile as pt
from protractile.analysis.measure import measure_boom
from protractile.analysis.rows import INITIAL, MOTION, Row, Rows
from protractile.beam_model.statics import StaticState, static_state
from protractile.dynamics.damping import closed_contact_modes
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import OF_INPUTS, cautions
from protractile.runs.folder.cache import Cache
from protractile.runs.live.beam import beam_results
from protractile.runs.live.controls import Draft
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.statics import cylinder_force, statics
from tests.docs.conftest import DOCS, toml_blocks
from tests.runs.case_texts import read_case

PAGE = (DOCS / "tutorial.md").read_text("utf-8")

Runner = Callable[..., Results]


def numbers(label: str, nth: int = 0) -> list[float]:
    """Return the numbers of the nth table row with this label; no number is NaN."""
    rows = [line for line in PAGE.splitlines() if line.startswith(f"| {label} |")]
    cells = [cell.strip(" ").split(" ")[0] for cell in rows[nth].strip("|").split("|")[1:]]
    return [float(cell.replace("−", "-").replace("–", "nan")) for cell in cells]


def shown(value: float, digits: int, label: str, nth: int = 0, column: int = 0) -> bool:
    """Return whether the page shows a value, rounded to its digits after the point."""
    return numbers(label, nth)[column] == pytest.approx(round(value, digits), abs=1e-9)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Runner:
    """Return a function that runs some models of a case and returns the results."""

    def of(text: str, *models: str, **changes: object) -> Results:
        case = pt.change(read_case(tmp_path_factory.mktemp("tutorial"), text), **changes)
        return pt.run_case(case, models=[*models])

    return of


def peak(rows: Rows, quantity: str, **labels: object) -> Row:
    """Return the largest value of a quantity in motion."""
    return rows.where(state=MOTION, quantity=quantity, **labels).largest


def checked(case: pt.Case) -> StaticState:
    """Return the static state that ``check`` prints."""
    found = statics(case, build_boom(case))
    return found.with_play


def first_frequency(state: StaticState) -> float:
    """Return the first frequency in Hz with the joints in contact."""
    return float(closed_contact_modes(state.system, state.position)[0][0]) / (2.0 * np.pi)


def test_values_of_the_first_check(tmp_path: Path) -> None:
    """Reference: the page, to its digits."""
    case = read_case(tmp_path, toml_blocks("tutorial.md")[0])
    boom = build_boom(case)
    assert cautions(Context(case, boom), OF_INPUTS) == []
    mass = sum(segment.mass_per_length * segment.length for segment in boom.segments)
    assert shown(mass, 0, "mass of the boom")
    state = checked(case)
    assert shown(1e-3 * cylinder_force(state, 1), 2, "force of the cylinder")
    assert shown(1e3 * state.tip, 1, "static tip deflection (t = 0)")
    measured = measure_boom(static_states(case, state.boom).farthest)
    (tilted,) = (one.values.item() for one in measured if one.quantity == "rotation_tip")
    assert shown(-1e3 * tilted, 1, "part due to play and to walls that bend under pads")
    walls = static_state(state.boom, walls=0.0).tip - state.tip
    assert shown(1e3 * walls, 1, "part due to walls that bend under pads")
    assert shown(first_frequency(state), 2, "first natural frequency, joints in contact")


def test_beam_results_equal_the_page(run: Runner, lift: str, tmp_path: Path) -> None:
    """Reference: the page, to its digits."""
    results = run(lift, "beam")
    rows, summary = results.rows.where(model="beam", play=True), results.summary.models["beam"]
    tip = peak(rows, "tip")
    at_rest = rows.at_rest(tip)
    state = checked(read_case(tmp_path, lift))
    assert shown(1e3 * state.tip, 1, "static tip deflection (t = 0), empty cage")
    assert shown(1e-3 * cylinder_force(state, 1), 1, "force of the cylinder", 1)
    assert shown(first_frequency(state), 2, "first natural frequency, joints in contact", 1)
    part = 100.0 / summary.critical_factor
    assert shown(part, 2, "largest axial force over the buckling load")
    assert shown(1e3 * at_rest, 1, "static tip deflection, people in the cage (mm)")
    assert shown(1e3 * abs(tip.value), 1, "maximum tip deflection (mm)")
    assert shown(rows.dynamic_factor(tip), 2, "dynamic factor φ")
    frequencies = rows.where(state=INITIAL, quantity="frequency")
    assert shown(frequencies[0].value, 2, "first natural frequency (Hz)")
    cylinder = abs(peak(rows, "cylinder_force").value)
    assert shown(1e-3 * cylinder, 1, "cylinder force, maximum (kN)")
    head = abs(peak(rows, "contact_force", x=6.5).value)
    assert shown(1e-3 * head, 1, "force at the head of the base, maximum (kN)")
    bending = abs(peak(rows, "stress").value)
    assert shown(1e-6 * bending, 1, "bending stress, maximum (MPa)")
    assert summary.contact_changes == 0
    for play in ("1", "6"):
        swept = run(lift, "beam", **{"joint.play": 1e-3 * float(play), "time.duration": 0.5})
        assert shown(1e3 * swept.rows.at_rest(peak(swept.rows.where(play=True), "tip")), 1, play)


@pytest.fixture(scope="module")
def draft(lift: str, tmp_path_factory: pytest.TempPathFactory) -> Draft:
    """Return the draft of the case, and store its shell in the cache."""
    pytest.importorskip("dolfinx", reason="shells need FEniCSx")
    from mpi4py import MPI

    path = tmp_path_factory.mktemp("live") / "my-lift.toml"
    path.write_text(lift, "utf-8")
    draft = Draft.load(str(path))
    context = BuildContext(MPI.COMM_SELF, cache=Cache.of_user())
    build(draft.case, draft.boom, draft.shells[0], context)
    return draft


@pytest.mark.slow
@pytest.mark.parametrize(
    ("label", "key", "value"),
    [
        ("play of 16 mm", "joint[1].play", 0.016),
        ("pads of 12 mm", "joint[1].pad.length", 0.012),
    ],
)
def test_the_live_page_has_the_numbers_of_its_table(
    draft: Draft, label: str, key: str, value: float
) -> None:
    """Reference: the page, to its digits; the cache has the shell of the case."""
    *_, motion = beam_results(draft.beam(draft.changed({key: value})), draft, lambda: None)
    rows = {title: text.replace("−", "-") for title, text in motion["rows"]}
    tip = rows["Maximum dynamic tip deflection (factor φ), mm"].split(" ")[0]
    assert shown(-float(tip), 1, label)
    used = re.search(r"([0-9.]+) %", rows["Governing pad: force, pressure, utilisation"])
    assert shown(float(used[1]), 0, label, column=1)


@pytest.mark.slow
@pytest.mark.usefixtures("draft")
def test_shell_results_equal_the_page(run: Runner, lift: str) -> None:
    """Reference: the page, to its digits; the cache has the shell of the case."""
    results = run(lift, "shell", "calibrated", **{"time.duration": 0.4})
    shell = results.rows.where(model="shell", play=True)
    largest = abs(peak(shell, "tip").value)
    assert shown(1e3 * largest, 1, "maximum tip deflection (mm)", 1)
    patches = {
        (curve.segment, round(curve.place, 3)): curve.values["von_mises_patch"].max()
        for curve in results.curves.where(model="shell", state="history")
    }
    for place, label in ((("base", 6.5), "head of the base"), (("fly", 5.3), "tail of the fly")):
        assert shown(1e-6 * patches[place], 0, f"plate stress at the {label} (MPa)")
    pad = max(row.utilisation for row in shell.where(state=MOTION, quantity="pad_pressure"))
    assert shown(100.0 * pad, 0, "pad utilisation at the head of the base (%)")
    calibrated = peak(results.rows.where(model="calibrated", play=True), "tip")
    assert abs(calibrated.value) == pytest.approx(largest, rel=1e-3)
    frequencies = shell.where(state=INITIAL, quantity="frequency")
    assert shown(frequencies[0].value, 2, "first natural frequency (Hz)", column=1)

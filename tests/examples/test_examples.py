# SPDX-License-Identifier: LGPL-3.0-or-later
"""The examples and the notebook run as they are printed."""

import ast
import json
import sys
from base64 import b64encode
from collections.abc import Iterator
from contextlib import redirect_stdout
from copy import deepcopy
from dataclasses import replace
from importlib import import_module
from io import BytesIO, StringIO
from pathlib import Path
from types import ModuleType
from typing import Any

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
import pytest

import protractile as pt
from protractile.dynamics.integrator import FixedStep, simulate
from protractile.dynamics.motion import Motion
from protractile.dynamics.predictability import integrate_ensemble
from tests.dynamics.reference import CHAOTIC
from tests.runs.case_texts import COARSE, read_case

Cell = dict[str, Any]

# Lines of an output beyond which it is not compared.
_LONG = 20


def code_cells(notebook: dict[str, Any]) -> list[Cell]:
    """Return the cells with code."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def run_cell(cell: Cell, names: dict[str, Any], count: int) -> Iterator[Cell]:
    """Run a cell, and yield its outputs: printed text, the last value, figures."""
    body = ast.parse("".join(cell["source"])).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    value = None
    with redirect_stdout(StringIO()) as printed:
        exec(compile(ast.Module(body, []), "cell", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    if text := printed.getvalue():
        yield {"output_type": "stream", "name": "stdout", "text": text.splitlines(True)}
    if value is not None:
        data = {"text/plain": repr(value).splitlines(True)}
        if hasattr(value, "_repr_html_"):
            data["text/html"] = value._repr_html_().splitlines(True)
        yield {
            "output_type": "execute_result", "execution_count": count, "metadata": {}, "data": data
        }  # fmt: skip
    for number in plt.get_fignums():
        picture = BytesIO()
        plt.figure(number).savefig(picture, format="png", dpi=72, bbox_inches="tight")
        data = {"image/png": b64encode(picture.getvalue()).decode()}
        yield {"output_type": "display_data", "metadata": {}, "data": data}
    plt.close("all")


def run(notebook: dict[str, Any]) -> dict[str, Any]:
    """Run all cells, replace their outputs, and return their names."""
    names: dict[str, Any] = {"__name__": "__main__"}
    for count, cell in enumerate(code_cells(notebook), start=1):
        cell |= {"execution_count": count, "outputs": [*run_cell(cell, names, count)]}
    return names


def plain(cell: Cell) -> list[str]:
    """Return the lines of text in a cell's outputs.

    Long outputs are left out: they are the tables of ``check``, which have tests of their own.
    """
    texts = [out.get("text") or out["data"].get("text/plain", []) for out in cell["outputs"]]
    return [line.rstrip() for text in texts if len(text) <= _LONG for line in text]


if __name__ == "__main__":
    plt.switch_backend("agg")
    file = Path(sys.argv[1])
    content = json.loads(file.read_text("utf-8"))
    run(content)
    file.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", "utf-8")


EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture
def example(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """Return the module of a test, as if run in its own folder."""
    monkeypatch.syspath_prepend(str(EXAMPLES))
    yield import_module(request.param)
    for path in EXAMPLES.glob("*.py"):
        sys.modules.pop(path.stem, None)


def of(name: str) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("example", [name], indirect=True)


@of("bouncing_ball")
def test_a_ball_bounces(example: ModuleType) -> None:
    """Reference: analytic. A fall lasts √(2h/g), and a contact (2/ω)(π − atan(v ω/g))."""
    motion = example.fall()
    fall = np.sqrt(2.0 * example.HEIGHT / example.GRAVITY)
    omega = np.sqrt(example.STIFFNESS)
    contact = 2.0 / omega * (np.pi - np.arctan(fall * omega))
    # The straight line through a step misses the parabola by g h²/8v.
    assert motion.first_contact == pytest.approx(fall, rel=1e-7)
    height = motion.data["height"].interp(time=2.0 * fall + contact, method="quadratic")
    assert float(height) == pytest.approx(example.HEIGHT, rel=1e-6)
    assert motion.energy_residual < 1e-9


@of("change_a_case")
def test_changed_case_equals_case_of_a_changed_file(example: ModuleType, tmp_path: Path) -> None:
    """Reference: other code path, a case file with this number."""
    case = read_case(tmp_path, COARSE.replace("play = 0.014", "play = 0.007"))
    expected = pt.run_case(case, models=["kantorovich-5"])
    found = example.run(0.007)
    np.testing.assert_array_equal(found.trajectories["tip"], expected.trajectories["tip"])
    assert found.summary.models["kantorovich-5"].first_contact < 0.1


@of("boom_in_python")
def test_the_fly_falls_freely_through_its_play(example: ModuleType) -> None:
    """Reference: analytic. A uniform load q moves a free beam by q t²/2m without bending."""
    mass = example.boom().segments[1].mass_per_length
    expected = np.sqrt(example.PLAY * mass / -example.LOAD)
    motion = pt.BeamElements(example.boom(), element_length=1.0).simulate(1.0)
    assert motion.first_contact == pytest.approx(expected, rel=1e-4)
    assert motion.energy_residual < 1e-3


@of("what_play_adds")
def test_play_turns_the_fly(example: ModuleType) -> None:
    """Reference: analytic. The fly moves by Δ up at 6 m, down at 8 m: by 7 Δ at 14 m."""
    added = example.deflection(bonded=False) - example.deflection(bonded=True)
    assert added == pytest.approx(-7.0 * 5.0e-3, rel=2e-3)


@of("own_contact_law")
def test_a_rubber_stop_takes_all_the_energy(example: ModuleType) -> None:
    """Reference: analytic. ½ m v² = ½ k p² + ¼ c p⁴ at the largest penetration."""
    law, speed = example.RubberStop(1.0e5, 1.0e9), 3.0
    depth = np.sqrt((np.sqrt(law.linear**2 + 2.0 * law.cubic * speed**2) - law.linear) / law.cubic)
    motion = example.strike(law, speed)
    peak = float(motion.data["contact_force_peak"].max())
    assert peak == pytest.approx(law.linear * depth + law.cubic * depth**3, rel=1e-3)
    assert motion.energy_residual < 1e-4


@of("own_integrator")
def test_another_integrator_finds_the_same(example: ModuleType) -> None:
    """Reference: other code, the program's time step, before chaos."""
    system = replace(CHAOTIC, laws=[pt.PowerContact(1.0e4, 2.0).with_clearance(0.02)])
    other = simulate(system, 2.0, 1e-2, integrator=example.RungeKutta())
    ours = simulate(system, 2.0, 1e-2, integrator=FixedStep(1e-5))
    assert ours.data.attrs["contact_changes"] >= 2
    np.testing.assert_allclose(other.data["tip"], ours.data["tip"], atol=1e-6)
    assert other.first_contact == pytest.approx(ours.first_contact, abs=1e-2)
    assert other.energy_residual < 1e-6
    ensemble = integrate_ensemble(
        Motion(system, 1.0, 1e-2), 2, 1e-3, 7, "load", example.RungeKutta()
    )
    np.testing.assert_allclose(ensemble["tip"][0], other.data["tip"][:101], atol=1e-9)


@of("sweep")
def test_mass_rebounds_with_the_given_restitution(example: ModuleType) -> None:
    """Reference: analytic, the restitution from which the damping is computed."""
    for asked in (0.3, 0.7, 1.0):
        assert example.rebound(asked) == pytest.approx(asked, abs=2e-3)


@pytest.mark.slow
@of("boom_in_python")
def test_beams_and_shells_are_one_boom(example: ModuleType) -> None:
    """Reference: other code: beams and shells are compared. Both move freely at first."""
    pytest.importorskip("dolfinx", reason="shells need FEniCSx")
    boom = example.boom()
    shell = pt.Shell(boom, mesh_size=0.4).simulate(0.5)
    beam = pt.BeamElements(boom, theory="timoshenko").simulate(0.5)
    assert shell.first_contact == pytest.approx(beam.first_contact, rel=1e-6)
    assert shell.first_peak()[1] == pytest.approx(beam.first_peak()[1], rel=0.02)
    assert shell.compare(beam, until=beam.first_contact).largest < 1e-3


FILE = EXAMPLES / "notebook.ipynb"


@pytest.mark.slow
@pytest.mark.filterwarnings("default")
@pytest.mark.usefixtures("in_this_process")
def test_a_notebook_gives_its_outputs_again() -> None:
    """Reference: its own outputs, line by line, and analytic results for what it computes."""
    kept = json.loads(FILE.read_text("utf-8"))
    again = deepcopy(kept)
    with mpl.rc_context({"backend": "agg"}):
        names: dict[str, Any] = run(again)
    for before, now in zip(code_cells(kept), code_cells(again), strict=True):
        assert plain(now) == plain(before)
    # The fly turns by play over the distance of the pads' midpoints, 2 Δ / 1.38 m, about the lower
    # one, 4.56 m behind the tip.
    tips = names["swept"]["tip_at_rest"].sel(model="beam").values
    added = 0.004 * (4.56 / 1.38 + 0.5)
    assert tips[1:] - tips[:-1] == pytest.approx(added, rel=5e-3)
    # The masses of both segments, 7850 kg/m³ of the walls along their middle lines.
    masses = names["checked"].frames["Masses"]["own mass, kg"]
    arm, fly = (2.0 * (b * tf + h * tw) for h, b, tf, tw in (
        (0.300, 0.220, 0.006, 0.005), (0.256, 0.180, 0.005, 0.004)
    ))  # fmt: skip
    assert [*masses[:2]] == pytest.approx([7850.0 * 8.0 * arm, 7850.0 * 6.0 * fly], rel=1e-12)
    # Bisection ends with a bracket of a thousandth.
    assert names["largest"] == pytest.approx(0.004 + (0.18 - tips[1]) / (added / 0.004), rel=5e-3)

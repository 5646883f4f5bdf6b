# SPDX-License-Identifier: LGPL-3.0-or-later
"""Booms for other programs."""

import re
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from runpy import run_path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

import protractile as pt
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.export.opensees import _points, write
from protractile.runs.pipeline.models import build
from studies.motions import friction_case, model_of, move, with_pads
from tests.other_codes import INSTALLED, run_elsewhere
from tests.runs.case_texts import elements, read_case, refused, shipped, table

# A load that grows, a weight, a spring: what the paper's boom does not have.
MORE = "".join(
    table("[[load]]", segment="inner", **keys)
    for keys in (
        {"x": 14.0, "magnitude": 300.0, "ramp": 0.2},
        {"from": 11.0, "to": 13.5, "magnitude": 40.0},
    )
)
CONTACT = {"stiffness": 1e9, "exponent": 1.0}
MODEL = elements("timoshenko", theory="timoshenko", contact=CONTACT)


def run(script: Path, *arguments: str) -> float:
    told = run_elsewhere(str(script), *arguments, folder=script.parent)
    found = re.search(r": ([-\d.e]+) m", told)
    assert found is not None, told
    return float(found[1])


def boom_with_more(folder: Path) -> Case:
    text = (CASES / "friction-walk.toml").read_text(encoding="utf-8")
    heavier = text.replace(
        "supports = [0.0, 2.0]", "supports = [0.0, { x = 2.0, stiffness = 5e7 }]"
    )
    boom, _, _ = heavier.replace("[[joint]]", f"{MORE}\n[[joint]]", 1).partition("[[model]]")
    return read_case(folder, boom + MODEL)


def exported(case: Case, folder: Path, comm: Any = None, cache: Any = None) -> Path:
    write(case, "", comm, folder / "boom.py", cache)
    return folder / "boom.py"


class _Sinking(ModuleType):
    """A substitute for OpenSees: nodes move down by 1 mm per step, then up again."""

    steps = 0

    def analyze(self, *_: object) -> int:
        self.steps += 1
        return 0

    def nodeDisp(self, *_: object) -> float:
        return -1.0e-3 * min(self.steps, 10 - self.steps)

    def nodeCoord(self, *_: object) -> tuple[float, float]:
        return 0.0, 0.0

    def __getattr__(self, name: str) -> Callable[..., None]:
        return lambda *_: None


def test_the_largest_tip_may_be_a_downward_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Reference: by hand, −5 mm after five of ten steps."""
    script = exported(boom_with_more(tmp_path), tmp_path)
    package, program = ModuleType("openseespy"), _Sinking("openseespy.opensees")
    monkeypatch.setattr(package, "opensees", program, raising=False)
    monkeypatch.setitem(sys.modules, "openseespy", package)
    monkeypatch.setitem(sys.modules, "openseespy.opensees", program)
    monkeypatch.setattr(sys, "argv", [str(script), "--step", "1", "--duration", "10"])
    run_path(str(script), run_name="__main__")
    assert capsys.readouterr().out.startswith("largest tip: -0.005 m; written to ")


@INSTALLED
@pytest.mark.slow
def test_a_beam_rests_and_peaks_elsewhere_as_here(tmp_path: Path) -> None:
    """Reference: other code, OpenSees with its elements, Newton's method and TR-BDF2."""
    case = boom_with_more(tmp_path)
    script = exported(case, tmp_path)
    system = build(case, build_boom(case), case.models[0]).system
    at_first = replace(system.gather_loads(), excitations=())
    rest = at_first.observers["tip"].row @ equilibrium(at_first, at_first.load)
    assert run(script, "--static") == pytest.approx(float(rest), rel=1e-6)
    tip = np.asarray(move(system, 0.8).data["tip"].values)
    assert 500 < tip.argmax() < 790
    peak = run(script, "--duration", "0.8", "--step", "2e-4")
    assert peak == pytest.approx(tip.max(), rel=2e-3)


@INSTALLED
@pytest.mark.slow
def test_lift_rests_on_its_cylinder_in_opensees_as_here(tmp_path: Path) -> None:
    """Reference: other code, OpenSees with a truss as the cylinder of the level lift."""
    level = {"gravity.angle": 0.0, "damping.modal": 0.0, "start.state": "rest"}
    case = pt.change(pt.load_case(CASES / "lift.toml"), **level)
    case = case_file.select(case, "", ["timoshenko"])
    script = exported(case, tmp_path)
    system = build(case, build_boom(case), case.models[0]).system.gather_loads()
    rest = system.observers["tip"].row @ equilibrium(system, system.load)
    assert run(script, "--static") == pytest.approx(float(rest), rel=1e-6)


@INSTALLED
@pytest.mark.slow
def test_a_calibrated_beam_rests_and_peaks_elsewhere_on_its_springs(tmp_path: Path) -> None:
    """Reference: other code, OpenSees. Coupling of springs is less than a thousandth."""
    pytest.importorskip("dolfinx", reason="a shell calibrates it")
    from mpi4py import MPI

    from protractile.runs.case.kinds.model import BuildContext
    from protractile.runs.folder.cache import Cache
    from studies.calibrated_beams import calibrated_beam

    case = with_pads(friction_case(), 0.1, 0.06)
    shell = model_of(case, "shell").model_copy(update={"mesh_size": 0.5})
    model = calibrated_beam(case, shell, fields=False)
    case = case.model_copy(update={"models": (model,)})
    cache = Cache(tmp_path / "cache")
    script = exported(case, tmp_path, MPI.COMM_SELF, cache)
    tools = BuildContext(MPI.COMM_SELF, cache=cache)
    system = build(case, build_boom(case), model, tools).system
    rest = float(system.observers["tip"].row @ equilibrium(system, system.load))
    plain = case.model_copy(update={"models": (model_of(friction_case(), "timoshenko"),)})
    stiff = build(plain, build_boom(plain), plain.models[0]).system
    without = float(stiff.observers["tip"].row @ equilibrium(stiff, stiff.load))
    # Both press at the midpoints of the pads; springs alone lower the tip, by 5 %.
    assert rest > 1.04 * without
    assert run(script, "--static") == pytest.approx(rest, rel=1e-3)
    tip, plain_tip = (np.asarray(move(s, 0.8).data["tip"].values) for s in (system, stiff))
    assert 500 < tip.argmax() < 790
    assert tip.max() > 1.1 * plain_tip.max()
    peak = run(script, "--duration", "0.8", "--step", "2e-4")
    assert peak == pytest.approx(tip.max(), rel=1e-2)


def test_points_follow_a_law_behind_its_spring() -> None:
    """Reference: analytic, y = Δ + (F/k)^(1/n) + F/K."""
    law = PowerContact(1.0e9, 1.5).with_clearance(0.007).one_sided(-1)
    approaches, forces = np.array(_points(law, 1.0 / 2.0e7))
    pressed = forces < 0.0
    assert (np.diff(approaches) > 0.0).all()
    assert forces.min() == pytest.approx(-1.0e7, rel=0.5)
    expected = 0.007 + (-forces[pressed] / 1.0e9) ** (1.0 / 1.5) - forces[pressed] / 2.0e7
    np.testing.assert_allclose(-approaches[pressed], expected, rtol=1e-9)


def test_unsupported_cases_are_refused(tmp_path: Path) -> None:
    case = shipped("spatial")
    with refused(
        "case.toml: joint.lateral_play: cannot be exported to OpenSees, for which a boom must be "
        "flat and undamped, start from rest, and have friction under given normal_forces only; "
        "leave it out"
    ):
        write(case_file.select(case, "", ["beam-fe"]), "case.toml", None, tmp_path / "x.py", None)
    case = case_file.select(friction_case(), "", ["kantorovich-5"])
    with refused("case.toml: --model: must be beam elements with play, and there are none"):
        write(case, "case.toml", None, tmp_path / "x.py", None)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells from the cache, in other units, and in combinations."""

from dataclasses import replace
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.analysis.measure import measure
from protractile.analysis.model import AnalysisModel
from protractile.analysis.rows import COMBINATION, extremes
from protractile.analysis.states import States
from protractile.dynamics.excitation import Ramp
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.joint import Pad
from protractile.runs.case import reading as case_file
from protractile.runs.case.amounts import convert_to_si
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds import KINDS
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.load_tables import LoadTable
from protractile.runs.case.schema import Case
from protractile.runs.case.sections import SectionTable
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.combinations import CombinationState
from protractile.runs.pipeline.combined_shells import shell_states
from protractile.runs.pipeline.models import build
from protractile.runs.pipeline.proofs import prove
from protractile.runs.process.terminal import shorten
from protractile.runs.report import terminal_tables
from protractile.shell_model.reduced_shell import ReducedShell, reduce_boom
from tests.runs.case_texts import read_case, shipped
from tests.runs.case_texts import table as case_table
from tests.runs.summaries import rubbing
from tests.runs.test_combinations import CASES, FACTORS, LIFT
from tests.system.run_folder import protractile

pytestmark = pytest.mark.slow

SIZES = "height", "width", "flange", "web"


@pytest.fixture
def case() -> Case:
    return case_file.select(shipped("coarse"), "", ["shell"], 1.0)


def reduce(case: Case, cache: Cache) -> ReducedShell:
    tools = BuildContext(MPI.COMM_SELF, cache=cache)
    return build(case, build_boom(case), case.models[0], tools).shell


def entries(cache: Cache) -> list[Path]:
    return list(cache.folder.glob("*.record"))


def test_a_second_run_skips_mesh_and_reduction_of_the_same_mesh(case: Case, tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache")
    first = reduce(case, cache)
    second = reduce(case, cache)
    assert {*first.seconds} == {"mesh", "assembly", "rows", "reduction", "fields", "mesh error"}
    assert list(second.seconds) == ["cache"]
    for name in ("omega2", "load", "rows", "friction_rows"):
        assert np.array_equal(getattr(first.system, name), getattr(second.system, name))
    assert first.system.laws == second.system.laws
    assert first.errors == second.errors
    assert first.fields.identical(second.fields)
    assert "reduction" in reduce(case_file.select(case, "", None, 0.6), cache).seconds
    assert len(entries(cache)) == 2


def varied(case: Case, play: float, times: float, ramp: float) -> Case:
    """Return the case with another play, multiplied loads, and a gust that rises in ``ramp`` s."""
    gust = LoadTable(segment="inner", x="head", magnitude=-50.0 * times, ramp=ramp)
    joints = tuple(replace(joint, play=play) for joint in case.joints)
    segments = []
    for table, segment in zip(case.segments, build_boom(case).segments, strict=True):
        assert segment.section is not None
        sizes = {name: getattr(segment.section, name) for name in SIZES}
        # An inferred section would follow the play.
        own = {"height_to_width": None, "section": SectionTable(**sizes)}
        segments.append(table.model_copy(update={"load": times * table.load, **own}))
    change = {"joints": joints, "segments": tuple(segments), "loads": (gust,)}
    return case.model_copy(update=change)


def test_another_play_and_load_are_the_same_entry(case: Case, tmp_path: Path) -> None:
    """Reference: other code path, the boom reduced with its own play and loads."""
    cache = Cache(tmp_path / "cache")
    reduce(varied(case, 0.014, 1.0, 0.5), cache)
    other = varied(case, 0.004, -3.0, 0.1)
    found = reduce(other, cache).system
    assert len(entries(cache)) == 1
    contacts = other.models[0].model_boom(build_boom(other))
    own = reduce_boom(contacts.boom, other.models[0].options(), MPI.COMM_SELF).system
    assert found.laws == own.laws
    assert [x.history for x in found.excitations] == [Ramp(0.1)]
    moved, expected = (
        [one.rows / (one.omega2 + 1.0e4) @ load for load in (one.load, one.excitations[0].load)]
        for one in (found, own)
    )
    for mine, theirs in zip(moved, expected, strict=True):
        assert np.abs(mine - theirs).max() < 1e-9 * np.abs(theirs).max()


def test_unwritable_cache_gives_one_line(
    case: Case, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    folder = tmp_path / "cache"
    folder.write_text("a file where the folder should be")
    assert reduce(case, Cache(folder)).system.num_modes > 0
    what = "the cache cannot be written (Not a directory), and results are not kept for later runs"
    line = f"{what}; give another folder in PROTRACTILE_CACHE, or --no-cache"
    assert caplog.messages == [f"{shorten(str(folder))}: {line}"]


# n = 1, so that the shell's contacts are no stiffer than a run's.
LINEAR = {"stiffness": 1.0e9, "exponent": 1.0}
SERIES = {"kind": "kantorovich", "terms": (3, 3), "base": "complete", "rotary_inertia": True}
SHELL = {"kind": "shell", "mesh_size": 0.5, "contact_tolerance": "any"}


@pytest.mark.parametrize(
    ("table", "joint"),
    [
        (SERIES, {"stiffness": 1.0e13, "exponent": 2.0}),
        (SHELL | {"contact_line": "near webs"}, {"pad": Pad(0.1, 0.06)} | LINEAR),
        (SHELL | {"contact_line": "surface", "surface_points": (4, 2)}, LINEAR),
    ],
    ids=["series", "pads", "surface"],
)
def test_motions_do_not_know_the_units(table: dict[str, Any], joint: dict[str, Any]) -> None:
    """Reference: the model in SI units, tips within 1e-9, with friction and contacts."""
    model = KINDS[table["kind"]].model_validate({"name": "model", **table})
    case = rubbing(shipped("coarse"))
    joints = tuple(replace(own, **joint) for own in case.joints)
    case = case.model_copy(update={"joints": joints, "models": (model,)})
    motions = []
    for one in (case, convert_to_si(case.model_copy(update={"units": "mm-t-s"}))):
        built = build(one, build_boom(one), one.models[0], BuildContext(MPI.COMM_SELF))
        motions.append(FixedStep(1.0e-4)(Motion(built.system, 0.5)))
    si, mm = motions
    assert mm.first_contact == pytest.approx(si.first_contact, rel=1.0e-6)
    assert mm.first_contact < 0.4
    assert mm.energy_residual == pytest.approx(si.energy_residual, rel=0.01, abs=1.0e-9)
    for name in ("tip", "tail", "gap", "work", "friction_loss"):
        expected = si.data[name].values
        apart = np.abs(1.0e3 * mm.data[name].values - expected).max()
        assert apart <= (1.0e-9 if name == "tip" else 1.0e-8) * np.ptp(expected), name


# It lifts the tip until it is let go.
RELEASED = '{ segment = "fly", x = "head", magnitude = 3e3, released = true, group = "wind" }'
# Two levels of load and of axial forces at 45 degrees and, retracted, another geometry.
TEXT = (
    """
model = [
  { name = "beam", kind = "finite-element" },
  { name = "shell", kind = "shell", mesh_size = 0.4, contact_tolerance = "any" },
]
buckling = { modes = 1 }
"""
    + LIFT.replace("9e11", "2.1e11, yield_strength = 3.55e8")
    .replace('model = [{ name = "beam", kind = "finite-element", theory = "timoshenko" }]', "")
    .replace('bears = "corner"', "allowable_pressure = 2e7")
    + CASES.replace("load = [{", f"load = [{RELEASED}, {{")
    + FACTORS
    + case_table(
        "[[combination]]", name="C", load_cases=["raised"], factors={"dead": 1.0, "payload": 0.0}
    )
)


@pytest.fixture(scope="module")
def states(tmp_path_factory: pytest.TempPathFactory) -> list[CombinationState]:
    case = read_case(tmp_path_factory.mktemp("shell"), TEXT)
    shell = case.models[1]
    return shell_states(case, shell, BuildContext(MPI.COMM_WORLD))


def test_one_shell_serves_combinations_of_a_geometry(states: list[CombinationState]) -> None:
    """Reference: other code path, a shell reduced for a single combination."""
    names = [state.combined.name for state in states]
    assert names == ["A, raised", "A, level", "B, level", "C, raised"]
    for state in states[2:]:
        case = state.combined.case
        shell, boom = case.models[1], build_boom(case)
        joined = shell.model_boom(boom)
        built = shell.build(joined, BuildContext(MPI.COMM_WORLD))
        lines = shell.lines(joined.boom, built)
        loaded = AnalysisModel.of(joined.boom, built.system, lines)
        alone = States.at_rest(loaded, case.time.duration)
        expected = {row.key: row.value for row in extremes(measure(alone), "shell", "rest")}
        for row in state.rows:
            if row.quantity in ("tip", "stress", "pad_pressure", "cylinder_force"):
                # The axial forces of the shared shell would change the tip of C by 0.7 %.
                assert row.value == pytest.approx(expected[row.key], rel=2e-4)
        if not boom.compressed:
            assert state.critical_factor is None
            continue
        assert built.shell is not None
        assert state.critical_factor is not None
        system = built.system.gather_loads()
        factors = (built.shell.critical_factor_at(system, system.load_at(t)) for t in alone.time)
        # Walls keep the largest axial forces of all combinations, which is on the safe side.
        assert 0.85 < state.critical_factor / min(factors) < 1.0


def test_proofs_by_patches_and_factors(states: list[CombinationState], tmp_path: Path) -> None:
    """Reference: by hand. The factor multiplies loads, and hence the stress, up to buckling."""
    case = read_case(tmp_path, TEXT)
    proofs = {(row.quantity, row.part): row for row in prove(case, states).rows}
    of = {COMBINATION + state.combined.name: state for state in states}
    walls = [wall for state in states for wall in state.walls]
    patches = [w.values.max() for w in walls if (w.quantity, w.part) == ("wall_stress", "base")]
    assert len(patches) == len(states)
    assert proofs["patch", "base"].value == max(patches)
    column = proofs["column", "boom"]
    state = of[column.state]
    assert state.critical_factor is not None
    expected = state.critical_factor * column.value
    expected /= state.combined.combination.resistance.stability
    assert column.limit == pytest.approx(expected, rel=1e-12)
    # Of both geometries, the state with the lowest estimate has factors.
    assert [s.combined.name for s in states if s.buckling] == ["A, raised", "A, level"]
    one = proofs["buckling", "base"]
    factor = next(x.factors[0] for x in of[one.state].buckling if x.segment == "base")
    slenderness = (3.55e8 / (one.value * factor)) ** 0.5
    reduction = min(1.0, (slenderness - 0.22) / slenderness**2) if slenderness > 0.673 else 1.0
    reduction = min(reduction, 0.83 / max(slenderness, 0.83))
    assert one.limit == pytest.approx(reduction * 3.55e8, rel=1e-9)


def test_the_command_takes_a_shell(
    states: list[CombinationState],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    taken = Mock(return_value=states)
    monkeypatch.setattr(terminal_tables, "shell_states", taken)
    path = tmp_path / "lift.toml"
    path.write_text(TEXT, encoding="utf-8")
    assert protractile("prove", path, "--shell", "shell") in (0, 1)
    (case, shell, _), _ = taken.call_args
    assert shell == case.models[1]
    shown = capsys.readouterr().out
    assert "By shell, with the axial forces of each combination." in shown
    assert max(map(len, shown.splitlines())) <= 80
    assert protractile("prove", path, "--shell", "beam") == 2
    assert "--shell: 'beam' is not a shell" in capsys.readouterr().err

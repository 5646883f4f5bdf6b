# SPDX-License-Identifier: LGPL-3.0-or-later
"""Combinations by a shell: one reduction for each geometry, patch stresses and buckling."""

from pathlib import Path

import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.analysis.measure import measure
from protractile.analysis.model import AnalysisModel
from protractile.analysis.rows import COMBINATION, extremes
from protractile.analysis.states import States
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.combinations import CombinationState
from protractile.runs.pipeline.combined_shells import shell_states
from protractile.runs.pipeline.proofs import prove
from tests.runs.case_texts import read_case
from tests.runs.test_combinations import CASES, FACTORS, LIFT
from tests.system.run_folder import protractile

SHELL = """
model = [
  { name = "beam", kind = "finite-element" },
  { name = "shell", kind = "shell", mesh_size = 0.3, contact_tolerance = "any" },
]
buckling = { modes = 1 }
"""
# Two levels of load and of axial forces at 45 degrees and, retracted, another geometry.
TEXT = (
    SHELL
    + LIFT.replace("9e11", "2.1e11, yield_strength = 3.55e8")
    .replace('model = [{ name = "beam", kind = "finite-element", theory = "timoshenko" }]', "")
    .replace('bears = "corner"', "allowable_pressure = 2e7")
    + CASES
    + FACTORS
    + """
[[combination]]
name = "C"
load_cases = ["raised"]
factors = { dead = 1.0, payload = 0.0 }
"""
)

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def states(tmp_path_factory: pytest.TempPathFactory) -> list[CombinationState]:
    case = read_case(tmp_path_factory.mktemp("shell"), TEXT)
    shell = case.models[1]
    # The command takes these shells from the cache.
    return shell_states(case, shell, BuildContext(MPI.COMM_WORLD, cache=Cache.of_user()))


def test_one_shell_serves_combinations_of_a_geometry(states: list[CombinationState]) -> None:
    """Reference: other code path, a shell reduced for a single combination."""
    names = [one.combined.name for one in states]
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
        assert built.shell is not None
        system = built.system.gather_loads()
        factors = [
            built.shell.critical_factor_at(system, system.load_at(time))
            for time in alone.time.tolist()
        ]
        if not boom.compressed:
            assert state.critical_factor is None
            continue
        # Walls keep the largest axial forces of all combinations, which is on the safe side.
        assert state.critical_factor is not None
        assert 0.85 < state.critical_factor / min(factors) < 1.0


def test_proofs_by_patches_and_factors(states: list[CombinationState], tmp_path: Path) -> None:
    """Reference: by hand. The factor multiplies loads, and hence the stress, up to buckling."""
    case = read_case(tmp_path, TEXT)
    proofs = {(row.quantity, row.part): row for row in prove(case, states).rows}
    patches = [
        float(wall.values.max())
        for state in states
        for wall in state.walls
        if (wall.quantity, wall.part) == ("wall_stress", "base")
    ]
    assert len(patches) == len(states)
    assert proofs["patch", "base"].value == max(patches)
    column = proofs["column", "boom"]
    state = next(state for state in states if COMBINATION + state.combined.name == column.state)
    stability = state.combined.combination.resistance.stability
    assert state.critical_factor is not None
    expected = state.critical_factor * column.value / stability
    assert column.limit == pytest.approx(expected, rel=1e-12)
    # Of both geometries, the state with the lowest estimate has factors.
    buckled = [state for state in states if state.buckling]
    assert [one.combined.name for one in buckled] == ["A, raised", "A, level"]
    one = proofs["buckling", "base"]
    factor = next(
        found.factors[0]
        for state in buckled
        if COMBINATION + state.combined.name == one.state
        for found in state.buckling
        if found.segment == "base"
    )
    slenderness = (3.55e8 / (one.value * factor)) ** 0.5
    reduction = min(1.0, (slenderness - 0.22) / slenderness**2) if slenderness > 0.673 else 1.0
    reduction = min(reduction, 0.83 / max(slenderness, 0.83))
    assert one.limit == pytest.approx(reduction * 3.55e8, rel=1e-9)


def test_the_command_takes_a_shell(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    path = tmp_path / "lift.toml"
    path.write_text(TEXT, encoding="utf-8")
    assert protractile("prove", path, "--shell", "shell") in (0, 1)
    shown = capsys.readouterr().out
    assert "By shell, with the axial forces of each combination." in shown
    assert max(map(len, shown.splitlines())) <= 80
    assert protractile("prove", path, "--shell", "beam") == 2
    assert "--shell: 'beam' is not a shell" in capsys.readouterr().err

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Error of a shell's motion with friction by its reduction."""

from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.dynamics.reduction import restrict
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.models import build
from tests.runs.case_texts import STEEL, box, joint, read_case, table
from tests.runs.summaries import finished

SUPPORTS = "supports = [0.0, 1.4]\nload = 880.0"
RUBBING = "friction = 0.2\nnormal_forces = [4500.0, 5000.0]"
TEXT = f"""
title = "Rubbing"
{table("[time]", duration=2.0, step=2.0e-5)}
{STEEL}
{box("outer", (0.0, 8.0), (0.42, 0.40, 0.008, 0.005), SUPPORTS)}
{box("inner", (6.6, 14.5), (0.39, 0.35, 0.006, 0.0045), "load = 620.0")}
{joint("inner", "outer", 0.01, (6.6, 8.0), RUBBING)}
"""


def shells(folder: Path, *tolerances: float, more: str = "") -> Case:
    """Return a case with a shell for each tolerance, named ``shell-TOLERANCE``."""
    models = [
        table(
            "[[model]]",
            name=f"shell-{one:g}",
            kind="shell",
            mesh_size=0.4,
            contact_tolerance="any",
            tolerance=one,
        )
        for one in tolerances
    ]
    return read_case(folder, "\n".join([TEXT, *models, more]))


@pytest.mark.slow
def test_damped_motion_is_as_exact_as_the_tolerance_says(tmp_path: Path) -> None:
    """Reference: the same shell with a tolerance of 1e-8, in motion with 1 % of modal damping.

    The default tolerance is good to 0.3 % of the range, and the estimate is above the error.
    """
    case = shells(tmp_path, 5e-4, 1e-6, 1e-8, more=table("[damping]", modal=0.01))
    run = finished(case, RunContext(MPI.COMM_WORLD))
    tips = run.results.trajectories["tip"]
    exact = tips.sel(model="shell-1e-08").values
    errors = {
        one: float(np.abs(tips.sel(model=one).values - exact).max() / np.ptp(exact))
        for one in ("shell-0.0005", "shell-1e-06")
    }
    assert errors["shell-0.0005"] < 0.003
    assert errors["shell-1e-06"] < 0.7 * errors["shell-0.0005"]
    for name, error in errors.items():
        estimate = run.results.summary.models[name].reduction_error
        assert estimate is not None
        assert error < estimate < 0.005
    assert run.results.summary.models["shell-0.0005"].energy_residual < 1e-11
    assert not [one for one in run.results.summary.cautions if "the reduction of" in one]


@pytest.mark.slow
def test_undamped_plates_make_the_motion_uncertain(tmp_path: Path) -> None:
    """Reference: the same shell with a tolerance of 1e-8, and exact words.

    Without damping, friction depends on vibrations of plates above 50 Hz. The error of 4 % of the
    tip's range is estimated within a factor of 2.5, and told.
    """
    run = finished(shells(tmp_path, 5e-4, 1e-8), RunContext(MPI.COMM_WORLD))
    tips = run.results.trajectories["tip"]
    coarse, exact = (tips.sel(model=f"shell-{one}").values for one in ("0.0005", "1e-08"))
    error = float(np.abs(coarse - exact).max() / np.ptp(exact))
    estimate = run.results.summary.models["shell-0.0005"].reduction_error
    assert estimate is not None
    assert error > 0.03
    assert 0.4 * error < estimate < 2.5 * error
    assert (
        f"caution: the reduction of shell-0.0005 may change the tip's motion by "
        f"{100.0 * estimate:.2g} % of its range, since friction depends on vibrations of its "
        "plates; give damping, which ends these vibrations, and a smaller tolerance"
    ) in run.results.summary.cautions
    assert any(
        f"shell-0.0005: the reduction changes the tip's motion by about {100.0 * estimate:.2g} %"
        in note.line
        for note in run.results.summary.design.quality_notes
    )


@pytest.mark.slow
def test_the_coarser_basis_is_part_of_the_basis(tmp_path: Path) -> None:
    """Reference: analytic, orthonormal columns and Cauchy's interlacing of eigenvalues."""
    case = shells(tmp_path, 5e-4)
    built = build(case, build_boom(case), case.models[0], BuildContext(MPI.COMM_WORLD))
    assert built.shell is not None
    basis, system = built.shell.coarser, built.system
    assert basis.T @ basis == pytest.approx(np.eye(len(basis.T)), abs=1e-10)
    coarser = restrict(system, basis)
    assert 0.3 * system.num_modes < coarser.num_modes < 0.8 * system.num_modes
    rigid = system.omega2 == 0.0
    assert np.count_nonzero(coarser.omega2 == 0.0) == np.count_nonzero(rigid)
    every, fewer = np.sort(system.omega2), np.sort(coarser.omega2)
    assert (fewer >= every[: fewer.size] * (1.0 - 1e-9)).all()
    # Rigid motions and the first elastic mode are in both.
    assert fewer[rigid.sum()] == pytest.approx(every[rigid.sum()], rel=1e-3)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""A luffed boom from its case file to its trajectory."""

from pathlib import Path

import numpy as np
import pytest

from geometry.boom import Boom, Cylinder, Support
from protractile.cases import run_case
from runs.case.build import build_boom
from runs.case.schema import Case
from runs.case.toml import dumps
from tests.runs.case_texts import REST, STEEL, box, elements, joint, read_case, table
from tests.runs.summaries import printed_check

JACK = {"depth": 0.5, "ground": [1.2, -2.4], "stiffness": 6e7, "dashpot": 2e4}
LUFFED = f"""
title = "A boom on its cylinder"
time = {{ duration = 0.05, output_step = 1e-3 }}
gravity = {{ acceleration = 9.80665 }}
payload = {{ mass = 1000.0 }}
{STEEL}{REST}
{box("base", (0.0, 9.0), (0.60, 0.40, 0.010, 0.008))}
supports = [{{ x = 0.0, kind = "hinged", depth = 0.2 }}]
{box("fly", (7.5, 15.0), (0.56, 0.36, 0.008, 0.006))}
{joint("fly", "base", 0.004, (7.5, 9.0), "dashpot = 500.0")}
{table("[[cylinder]]", segment="base", x=3.0, **JACK)}
{elements("elements", element_length=1.5)}
{table("[[model]]", name="series", kind="kantorovich", terms=[10, 8], base="complete")}
{table("[[model]]", name="rigid", kind="rigid")}
{elements("bonded", bonded=True)}
"""


@pytest.fixture
def case(tmp_path: Path) -> Case:
    return read_case(tmp_path, LUFFED)


def turning(boom: Boom) -> float:
    """Moment of the weights about the hinge in N·m."""
    weights = [segment.mass_per_length * segment.length for segment in boom.segments]
    moment = weights[0] * 4.5 + weights[1] * 11.25 + 1000.0 * 15.0
    return moment * 9.80665


# From (1.2, −2.4) to (3, −0.5) m, about (0, −0.2) m.
ARM = (3.0 * 1.9 + 0.3 * 1.8) / np.hypot(1.8, 1.9)


def test_cylinder_of_the_boom_follows_the_case(case: Case, tmp_path: Path) -> None:
    """This holds for the case as written, and after a run has written it again."""
    for boom in (build_boom(case), build_boom(read_case(tmp_path, dumps(case)))):
        assert boom.segments[0].supports == (Support(0.0, "hinged", depth=0.2),)
        assert boom.cylinders == (
            Cylinder(0, 3.0, depth=0.5, ground=(1.2, -2.4), stiffness=6.0e7, dashpot=2.0e4),
        )
        assert boom.joints[0].dashpot == 500.0


def test_every_model_stands_on_its_cylinder(case: Case) -> None:
    """Reference: analytic, moments about the hinge. Nothing moves; energy is conserved."""
    results, boom = run_case(case), build_boom(case)
    force = results.trajectories["cylinder_force"]
    assert force.attrs == {
        "units": "N",
        "long_name": "spring force of the cylinder at x = 3 m of 'base', positive in compression",
    }
    for model in ("elements", "series", "rigid", "bonded"):
        pressed = force.sel(model=model).values
        assert pressed == pytest.approx(np.full(pressed.size, turning(boom) / ARM), rel=1e-5)
        assert results.summary.models[model].energy_residual < 1e-4


def test_check_reports_the_cylinder_and_its_damping(case: Case) -> None:
    """Reference: analytic, the lever arm about the pin, the moment of the weights, and the axial
    component between pin and lug.
    """
    told = printed_check(case)
    row = next(line for line in told.split("cylinder of")[1].splitlines() if "base" in line)
    _, x, length, arm, force = row.split()
    assert x == "3"
    assert [float(length), float(arm)] == pytest.approx([np.hypot(1.8, 1.9), ARM], rel=1e-3)
    assert float(force) == pytest.approx(1e-3 * turning(build_boom(case)) / ARM, rel=1e-3)
    assert len([line for line in told.splitlines() if " % at " in line]) == 4
    along = 1e-3 * turning(build_boom(case)) / ARM * 1.8 / np.hypot(1.8, 1.9)
    row = next(line for line in told.split("axial forces")[1].splitlines() if "base" in line)
    assert float(row.split()[1].replace("−", "-")) == pytest.approx(-along, rel=1e-3)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Buckling factor of a boom of shells, with compliant contacts and sections that distort."""

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from mpi4py import MPI

from protractile.beam_model.static_model import estimate_critical_factor
from protractile.dynamics.equilibrium import equilibrium
from protractile.geometry.boom import Boom
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.model import BuildContext, BuiltModel
from protractile.runs.pipeline.models import build
from tests.runs.case_texts import read_case

# A hexagon whose plates bend under pads on their corners.
HEXAGON = """
title = "Hexagon on corner pads"
time = { duration = 1.0 }
material = { youngs_modulus = 2.1e11, poissons_ratio = 0.3, density = 7850.0 }
gravity = { angle = 0.0 }
start = { state = "equilibrium" }
payload = { mass = 6000.0 }
axial = [{ force = 200000.0 }]

[[model]]
name = "shell"
kind = "shell"
mesh_size = 0.3

[[segment]]
name = "outer"
length = 8.7
supports = [{ x = 0.0, kind = "clamped" }]
[segment.section]
shape = "hexagon"
height = 0.82
width = 0.58
flat = 0.39
top = 0.008
bottom = 0.011
web = 0.007

[[segment]]
name = "inner"
length = 8.7
[segment.section]
shape = "hexagon"
height = 0.74
width = 0.50
flat = 0.32
top = 0.007
bottom = 0.009
web = 0.006

[[joint]]
outer = "outer"
inner = "inner"
extension = 7.1
stations = ["tail", "head"]
play = 0.004
pad = { length = 0.25, width = 0.07, thickness = 0.020, bears = "corner" }
"""


# The same boom of thick boxes in space, under 1 MN.
BOXES = re.sub(
    r"shape = .*\n(height.*\nwidth.*\n)flat.*\ntop.*\nbottom.*\nweb.*",
    r"\1flange = 0.02\nweb = 0.02",
    HEXAGON.replace("play = 0.004", "play = 0.004\nlateral_play = 0.004")
    .replace("200000.0", "1e6")
    .replace("mesh_size = 0.3", 'mesh_size = 0.3\ncontact_tolerance = "any"'),
)


def shell_of(folder: Path, text: str) -> BuiltModel:
    case = read_case(folder, text)
    return build(case, build_boom(case), case.models[0], BuildContext(MPI.COMM_WORLD))


def boom_of(folder: Path, text: str) -> Boom:
    return build_boom(read_case(folder, text))


def southwell(built: BuiltModel, tip: str, push: float = 0.0, time: float = 0.0) -> float:
    """Return the buckling factor at a time in s by Southwell's plot (1932) of a deflection.

    It grows with δ/P = δ/P_cr + constant near the critical force, δ being its growth from P = 0.
    ``push`` is a force along ``tip`` in N.
    """
    assert built.shell is not None
    assert built.critical_factor is not None
    loaded, row = built.system.gather_loads(), built.system.observers[tip].row
    system, load = loaded.at_time(time), loaded.load_at(time) + push * row
    added = system.geometric_stiffness if system.geometric_stiffness.size else 0.0
    of_shell = np.pad(built.shell.geometric, (0, system.num_modes - len(built.shell.geometric)))
    parts = np.array([0.0, 0.9, 0.97]) * built.critical_factor
    tips: Sequence[float] = [
        float(
            row
            @ equilibrium(
                replace(system, geometric_stiffness=part * (of_shell + added) - of_shell), load
            )
        )
        for part in parts
    ]
    growth = np.array(tips[1:]) - tips[0]
    return float(np.diff(growth)[0] / np.diff(growth / parts[1:])[0])


@pytest.mark.slow
def test_the_factor_is_that_of_the_growth_of_the_tip(tmp_path: Path) -> None:
    """Reference: the shell's own tip under growing axial forces.

    With bonded joints the factor is twice as large, as that of a beam.
    """
    built = shell_of(tmp_path, HEXAGON)
    assert built.critical_factor == pytest.approx(southwell(built, "tip"), rel=0.01)
    assert built.shell is not None
    assert built.shell.critical_factor is not None
    assert built.critical_factor is not None
    assert built.shell.critical_factor > 1.9 * built.critical_factor
    # The estimate of check and prove, of a beam whose sections distort.
    assert estimate_critical_factor(boom_of(tmp_path, HEXAGON)) == pytest.approx(
        built.critical_factor, rel=0.06
    )


@pytest.mark.slow
def test_the_factor_of_a_hoist_is_that_after_lift_off(tmp_path: Path) -> None:
    """Reference: the shell's own tip under growing axial forces, while the load hangs.

    The factor was 5.46, that of a beam.
    """
    hoist = "hoist = { mass = 8000.0, stiffness = 4e6, travel = 20.0, time = 0.5 }"
    text = HEXAGON.replace("payload = { mass = 6000.0 }", hoist)
    built = shell_of(tmp_path, text.replace("angle = 0.0", "angle = 60.0"))
    assert built.critical_factor == pytest.approx(5.35, rel=1e-3)
    assert built.critical_factor == pytest.approx(southwell(built, "tip", time=0.5), rel=0.01)


@pytest.mark.slow
def test_pads_of_a_column_without_loads_across_it_are_compliant(tmp_path: Path) -> None:
    """Reference: other view, the estimate of a beam; and the shell with bonded joints.

    No load presses the pads. With bonded joints the factor is more than twice as large.
    """
    text = HEXAGON.replace("angle = 0.0", "angle = 90.0")
    built = shell_of(tmp_path, text)
    assert built.critical_factor == pytest.approx(
        estimate_critical_factor(boom_of(tmp_path, text)), rel=0.06
    )
    assert built.shell is not None
    assert built.shell.critical_factor is not None
    assert built.critical_factor is not None
    assert built.shell.critical_factor > 1.9 * built.critical_factor


@pytest.mark.slow
def test_contacts_that_no_load_presses_are_as_compliant(tmp_path: Path) -> None:
    """Reference: the shell's own lateral tip under growing axial forces and a lateral force.

    With rigid lateral contacts the factor is 2 % larger.
    """
    built = shell_of(tmp_path, BOXES)
    expected = southwell(built, "tip_lateral", 100.0)
    assert built.critical_factor == pytest.approx(expected, rel=0.003)

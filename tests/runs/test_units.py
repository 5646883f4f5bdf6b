# SPDX-License-Identifier: LGPL-3.0-or-later
"""The same numbers in SI units and in mm, t and s, to exclude dimensional constants."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.integrator import AdaptiveStep, FixedStep, Integrator
from protractile.dynamics.motion import Motion
from protractile.geometry.joint import Pad
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds import KINDS
from protractile.runs.case.kinds.model import BuildContext
from protractile.runs.case.reading import convert_to_si
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.models import build
from tests.runs.case_texts import shipped
from tests.runs.summaries import rubbing

pytestmark = pytest.mark.slow

# n = 1, so that the shell's contacts are no stiffer than a run's.
LINEAR, QUADRATIC = {"stiffness": 1.0e9, "exponent": 1.0}, {"stiffness": 1.0e13, "exponent": 2.0}
SERIES = {"kind": "kantorovich", "terms": (3, 3), "base": "complete", "rotary_inertia": True}
ELEMENTS = {"kind": "finite-element", "element_length": 0.5, "rotary_inertia": True}
SHELL = {"kind": "shell", "mesh_size": 0.5, "contact_tolerance": "any"}


def case_of(table: dict[str, Any], friction: float = 0.2, **joint: Any) -> Case:
    """Return the coarse case with one model, friction in its joint and other keys of it."""
    case = rubbing(shipped("coarse"), friction) if friction else shipped("coarse")
    model = KINDS[table["kind"]].model_validate({"name": "model", **table})
    joints = tuple(replace(one, **joint) for one in case.joints)
    return case.model_copy(update={"joints": joints, "models": (model,)})


def system_of(case: Case) -> GapSystem:
    """Return the system of a case's model."""
    (model,) = case.models
    tools = None
    if model.needs_shell:
        pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")
        from mpi4py import MPI

        tools = BuildContext(MPI.COMM_SELF)
    return build(case, build_boom(case), model, tools).system


def agree(case: Case, integrator: Integrator, duration: float) -> None:
    """Check motions of numbers in m and in mm: tip within 1e-9 of its range, the rest 1e-8."""
    in_mm = convert_to_si(case.model_copy(update={"units": "mm-t-s"}))
    si, mm = (integrator(Motion(system_of(one), duration)) for one in (case, in_mm))
    assert mm.first_contact == pytest.approx(si.first_contact, rel=1.0e-6)
    assert mm.first_contact < 0.5
    assert mm.energy_residual == pytest.approx(si.energy_residual, rel=0.01, abs=1.0e-9)
    for name in ("tip", "tail", "gap", "work", "friction_loss"):
        expected = si.data[name].values
        apart = np.abs(1.0e3 * mm.data[name].values - expected).max()
        within = 1.0e-9 if name == "tip" else 1.0e-8
        assert apart <= within * np.ptp(expected), name


@pytest.mark.parametrize("model", [SERIES, ELEMENTS], ids=["series", "elements"])
@pytest.mark.parametrize("law", [LINEAR, QUADRATIC], ids=["linear", "quadratic"])
def test_beams_do_not_know_the_units(model: dict[str, Any], law: dict[str, float]) -> None:
    """Reference: the model in SI units within 1e-9, with friction and contacts."""
    agree(case_of(model, **law), FixedStep(1.0e-4), 1.0)


def test_steps_by_tolerance_do_not_know_the_units() -> None:
    """Reference: the same model in SI units, without play or without friction, until chaos."""
    agree(case_of(SERIES, friction=0.0, play=0.0, **LINEAR), AdaptiveStep(), 0.3)


@pytest.mark.parametrize(
    ("line", "pad"),
    [("near webs", None), ("near webs", Pad(0.1, 0.06)), ("surface", None)],
    ids=["near webs", "pads", "surface"],
)
def test_shells_do_not_know_the_units(line: str, pad: Pad | None) -> None:
    """Reference: the model in SI units within 1e-9, a coarse mesh with friction."""
    points = {"surface_points": (4, 2)} if line == "surface" else {}
    model = SHELL | {"contact_line": line} | points
    agree(case_of(model, pad=pad, **LINEAR), FixedStep(1.0e-4), 0.6)

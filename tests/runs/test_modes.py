# SPDX-License-Identifier: LGPL-3.0-or-later
"""Modes of a boom, and the kinds of models in a case file."""

from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from protractile.analysis.model import AnalysisModel
from protractile.analysis.modes import Mode, match_modes, modes
from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.kantorovich import kantorovich_segments
from protractile.beam_model.lines import lines
from protractile.beam_model.segment_model import gap_system
from protractile.cases import run_case
from protractile.dynamics.damping import closed_contact_modes
from protractile.geometry.boom import Boom, Material, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.runs.case.kinds import KINDS
from tests.runs.case_texts import COARSE, read_case, refusal
from tests.runs.test_actions import CANTILEVER
from tests.runs.test_statics import ball

BOX = BoxSection(height=0.30, width=0.20, flange=0.006, web=0.006)


@pytest.fixture(scope="module")
def arm(spatial_boom: Boom, steel: Material) -> Boom:
    """Return a cantilever of 10 m in space; the second segment is bonded to the first half."""
    root = Segment.of_section("root", 0.0, 10.0, steel, BOX, supports=(Support(0.0, "clamped"),))
    # As light as none, and rigid beside it.
    sleeve = BoxSection(height=0.25, width=0.15, flange=0.001, web=0.001)
    light = Material(youngs_modulus=2.1e3, poissons_ratio=0.3, density=1e-6)
    dummy = Segment.of_section("dummy", 9.0, 10.0, light, sleeve)
    joint = replace(spatial_boom.joints[0], stations=(9.0, 10.0), bonded=True)
    return Boom((root, dummy), (joint,))


def found(boom: Boom, models: list[SegmentModel]) -> list[Mode]:
    system = gap_system(boom.bonded, models)
    return modes(AnalysisModel.of(boom, system, lines(boom, models)), np.zeros(system.num_modes))


def test_modes_are_those_of_an_exact_beam(arm: Boom) -> None:
    """Reference: analytic, (βL)² = 3.51602, 22.0345 and √(GJ/I) / 4L (Blevins 1979)."""
    root, lateral = arm.segments[0], arm.segments[0].lateral
    first = finite_element_segments(arm, 0.5, "euler-bernoulli", rotary_inertia=False)
    names = {(mode.motion, mode.number): mode for mode in found(arm, first)}
    for way, second_moment in (
        ("bending in z", root.second_moment_of_area),
        ("bending in y", lateral.second_moment_of_area),
    ):
        speed = np.sqrt(2.1e11 * second_moment / root.mass_per_length) / 100.0
        for number, root_of in ((1, 3.51602), (2, 22.0345)):
            mode = names[way, number]
            assert mode.frequency == pytest.approx(root_of * speed / (2.0 * np.pi), rel=1e-4)
            assert mode.share > 0.999
    twisting = root.material.shear_modulus * lateral.torsion_constant / lateral.polar_inertia
    assert names["twist", 1].frequency == pytest.approx(np.sqrt(twisting) / 40.0, rel=1e-3)


def test_modes_match_in_any_order(arm: Boom) -> None:
    """Reference: the same boom on its side, with exchanged planes."""
    models = finite_element_segments(arm, 0.5, "euler-bernoulli", rotary_inertia=False)
    series = kantorovich_segments(arm, [12, 4], "complete", rotary_inertia=False)
    here, there = found(arm, models), found(arm, series)
    moved = list(reversed(there))
    for mode, match in zip(here, match_modes(arm, here, moved), strict=True):
        other = moved[match.number - 1]
        assert (other.motion, other.number) == (mode.motion, mode.number)
        assert match.alike > 0.999
        assert match.off == pytest.approx(0.0, abs=2e-3)
    sideways = [mode for mode in there if mode.motion == "bending in y"]
    upright = [mode for mode in here if mode.motion == "bending in z"]
    assert match_modes(arm, upright, sideways) == [None] * len(upright)


def test_rigid_segment_has_modes_of_its_contacts() -> None:
    """Reference: analytic, a ball of 1 kg without elastic modes, on a contact of 1e6 N/m."""
    omega, _ = closed_contact_modes(ball())
    np.testing.assert_allclose(omega, [1e3])


RIGID = '[[model]]\nname = "bodies"\nkind = "rigid"\n'


def test_each_kind_is_listed_by_the_name_in_its_table() -> None:
    names = [get_args(table.model_fields["kind"].annotation) for table in KINDS.values()]
    assert names == [(name,) for name in KINDS]


def test_rigid_segments_run_beside_the_others(tmp_path: Path) -> None:
    """Reference: analytic, free fall q/m of the inner segment across the clearance Δ."""
    case = read_case(tmp_path, COARSE.partition("[[model]]")[0] + RIGID)
    summary = run_case(case).summary.models["bodies"]
    assert (summary.kind, summary.degrees_of_freedom) == ("rigid", 2)
    assert summary.energy_residual < 1e-5
    # A uniform load on a free body turns it nowhere.
    assert summary.first_contact == pytest.approx(np.sqrt(2.0 * 7.0e-3 / 1.0), abs=1e-5)


def test_immovable_rigid_segments_are_refused(tmp_path: Path) -> None:
    assert refusal(tmp_path, CANTILEVER + RIGID) == (
        "model[1].kind: every segment is held, and no rigid one could move; give another kind, or "
        "elastic supports"
    )

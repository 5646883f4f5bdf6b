# SPDX-License-Identifier: LGPL-3.0-or-later
"""The kinds of models as a case file gives them."""

from dataclasses import replace
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from dynamics.contact import PowerContact
from geometry.boom import Boom
from protractile.cases import run_case
from runs.case import reading as case_file
from runs.case.kinds import KINDS
from runs.case.kinds.rigid import Rigid
from tests.runs.case_texts import refused
from tests.runs.coarse_case import COARSE
from tests.runs.test_actions import CANTILEVER

RIGID = '[[model]]\nname = "bodies"\nkind = "rigid"\n'


def test_each_kind_is_listed_by_the_name_in_its_table() -> None:
    names = [get_args(table.model_fields["kind"].annotation) for table in KINDS.values()]
    assert names == [(name,) for name in KINDS]


def test_rigid_segments_run_beside_the_others(tmp_path: Path) -> None:
    """Reference: analytic, free fall q/m of the inner segment across the clearance Δ."""
    path = tmp_path / "case.toml"
    text = COARSE.partition("[[model]]")[0] + RIGID
    path.write_text(text, encoding="utf-8")
    summary = run_case(case_file.load(str(path))).summary.models["bodies"]
    assert (summary.kind, summary.degrees_of_freedom) == ("rigid", 2)
    assert summary.energy_residual < 1e-5
    # A uniform load on a free body turns it nowhere.
    assert summary.first_contact == pytest.approx(np.sqrt(2.0 * 7.0e-3 / 1.0), abs=1e-5)


def test_play_of_a_joint_is_the_play_of_its_contacts(paper_boom: Boom) -> None:
    """Reference: analytic, free fall q/m of the inner segment across the clearance Δ."""
    peaks = []
    for play in (0.014, 0.004):
        (joint,) = paper_boom.joints
        joint = replace(joint, play=play, contact=PowerContact(1.0e9, 1.0))
        motion = Rigid(replace(paper_boom, joints=(joint,))).simulate(0.3)
        assert motion.first_contact == pytest.approx(np.sqrt(play), abs=1e-5)
        peaks.append(np.abs(motion.data["tip"].values).max())
    assert peaks[0] > peaks[1] + 4.0e-3


def test_immovable_rigid_segments_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "case.toml"
    path.write_text(CANTILEVER + RIGID, encoding="utf-8")
    with refused(
        f"{path}: model[1].kind: every segment is held, and no rigid one could move; give another "
        "kind, or elastic supports"
    ):
        case_file.load(str(path))

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Studies on coarse meshes: their verifications hold, and facts on which their pages rely."""

import json
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from protractile.runs.case.build import build_boom
from studies import benchmarks, contact_size, design_results, stress
from studies.motions import friction_case
from studies.reference_models.benchmarks import PUBLISHED
from studies.study import Study
from studies.working_load import ContactResults, ContactType, Point, PointMotion

ROOFS = benchmarks.Sizes(
    roof=(4, 8, 16), cylinder=(12, 24, 48), hemisphere=(8, 16, 32), twisted=(1, 2, 4), plate=(4, 8)
)
CONTACTS = contact_size.Sizes(
    meshes=(8.0, 4.0, 2.0), default=4.0, lengths=(0.1,), pads=((0.2, 0.06),), loads=(10.0,)
)
PATCHES = stress.Sizes(meshes=(0.2, 0.1, 0.05), default=0.1, places=(14.0,))


def column(rows: Any, name: str, of: str) -> list[float]:
    """Return the numbers of the row of a quantity, by its columns with this text."""
    row = next(row for row in rows if name in str(row[next(iter(row))]))
    return [float(value) for key, value in row.items() if of in key]


def coarse_shells_close_in(study: Study) -> None:
    """External and analytic: each error is small, and falls by the order."""
    curves = {what: curve[1] for plot in study.plots for what, curve in plot.curves.items()}
    for what, last, order in (
        ("Scordelis-Lo roof, 16 edges", 0.01, 1.1),
        ("pinched cylinder, 48 edges", 0.01, 2.0),
        ("hemisphere, 32 edges", 0.02, 2.0),
    ):
        assert curves[what][-1] < last
        assert np.log2(curves[what][-2] / curves[what][-1]) > order
    rows = study.data["benchmarks"]
    coarse, medium, fine = column(rows, "roof", "edges")
    assert coarse < medium < fine < PUBLISHED.scordelis_lo_roof
    assert 1.02 < column(rows, "with shear", "edges")[-1] / PUBLISHED.pinched_cylinder < 1.03


def pads_beside_webs_give_way_more(study: Study) -> None:
    """By order: a flange is ten times as soft as a corner, and pads lower the peak."""
    rows = study.data["local-compliance"]
    local = np.array([[row[f"edges × {part:g}"] for part in (8.0, 4.0, 2.0)] for row in rows])
    assert (np.diff(local[1:3], axis=1) > 0.0).all()
    assert (local[3:] > 10.0 * local[1:3]).all()
    peaks = [row["first tip peak\nload × 10 (mm)"] for row in study.data["contact-size"]]
    assert 350.0 < peaks[0] < 0.8 * peaks[1]


def a_triangle_at_a_contact_has_no_stress_and_a_patch_has(study: Study) -> None:
    """Analytic, where refinement doubles a point's stress."""
    assert all(verification.holds for verification in study.verifications)
    for x in (9, 10):
        triangle, patch = (
            column(study.data["stress"], f"largest {what} at {x} m", " m")
            for what in ("triangle", "patch")
        )
        assert 1.2 < triangle[-1] / triangle[-2] < 1.7
        assert patch[-1] == pytest.approx(patch[-2], rel=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("module", "sizes", "fact"),
    [
        (benchmarks, ROOFS, coarse_shells_close_in),
        (contact_size, CONTACTS, pads_beside_webs_give_way_more),
        (stress, PATCHES, a_triangle_at_a_contact_has_no_stress_and_a_patch_has),
    ],
)
def test_a_study_on_coarse_meshes_tells_its_facts(
    module: ModuleType, sizes: Any, fact: Callable[[Study], None]
) -> None:
    """Reference: that of each fact; a verification holds where coarse meshes reach it."""
    study = module.study(lambda step: None, sizes)
    json.dumps(study.data, allow_nan=module is not benchmarks)
    fact(study)


def test_existing_first_peaks_are_verified() -> None:
    """Reference: analytic, changes of 1 % of the tip, and of 2 % of the only peak."""

    def told(*peaks: float) -> list[tuple[str, float]]:
        points = [Point(1.0e-3 * i, 1.0) for i in range(len(peaks))]
        touch = ContactType("points", "webs", friction_case(), points, 1.0)
        motions = {
            point: [PointMotion(np.array([0.0, tip]), np.array([height]), np.ones(2))
                    for tip, height in ((1.01, peak), (1.0, 1.0))]
            for point, peak in zip(points, peaks, strict=True)
        }  # fmt: skip
        return [(v.what, v.value) for v in ContactResults(touch, motions).verifications]

    none = float("nan")
    tip = ("tip, part of its range, webs, worst of 2 points (0 mm, load × 1)", pytest.approx(0.01))
    peak = ("first tip peak, webs, worst of 1 points (1 mm, load × 1)", pytest.approx(0.02))
    assert told(none, none) == [tip]
    assert told(none, 1.02) == [peak, tip]


def test_forces_by_hand_are_in_balance() -> None:
    """Reference: analytic, 550.7 N upwards at 14 m with lever arms of 4 and 5 m; all moments."""
    forces = stress.contact_forces(build_boom(friction_case()))
    assert forces == {9.0: (-1, pytest.approx(4.0 * 550.7)), 10.0: (1, pytest.approx(5.0 * 550.7))}
    tail, head = design_results.station_forces()
    assert tail + head == pytest.approx(550.7)
    assert tail * 9.0 + head * 10.0 == pytest.approx(550.7 * 14.0)
    foot, far = design_results.support_forces()
    assert foot + far + 831.6 + tail + head == pytest.approx(0.0, abs=1e-9)
    moments = far * 2.0 + 831.6 * 5.0 + tail * 9.0 + head * 10.0
    assert moments == pytest.approx(0.0, abs=1e-9)

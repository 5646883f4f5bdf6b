# SPDX-License-Identifier: LGPL-3.0-or-later
"""Studies on coarse meshes: their verifications hold, and facts on which their pages rely."""

import json
from collections.abc import Callable, Mapping
from functools import cache
from importlib import import_module
from typing import Any

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from protractile.runs.case.build import build_boom
from studies import (
    benchmarks,
    contact_size,
    design_results,
    stress,
)
from studies.motions import friction_case
from studies.reference_models.benchmarks import PUBLISHED
from studies.study import Study
from studies.working_load import ContactResults, ContactType, Point, PointMotion

SIZES: Mapping[str, Any] = {
    "benchmarks": benchmarks.Sizes(
        roof=(4, 8, 16), cylinder=(12, 24, 48), hemisphere=(8, 16, 32), twisted=(1, 2, 4),
        plate=(4, 8),
    ),
    "contact_size": contact_size.Sizes(
        meshes=(8.0, 4.0, 2.0), default=4.0, lengths=(0.1,), pads=((0.2, 0.06),), loads=(10.0,)
    ),
    "stress": stress.Sizes(meshes=(0.2, 0.1, 0.05), default=0.1, places=(14.0,)),
}  # fmt: skip
# Starts of the verifications that coarse meshes do not reach; "" for all.
UNREACHED = {
    "benchmarks": ("",),
    "contact_size": ("",),
}


@cache
def found(name: str) -> Study:
    study: Study = import_module(f"studies.{name}").study(lambda step: None, SIZES[name])
    return study


def column(rows: Any, name: str, of: str) -> list[float]:
    """Return the numbers of the row of a quantity, by its columns with this text."""
    row = next(row for row in rows if name in str(row[next(iter(row))]))
    return [float(value) for key, value in row.items() if of in key]


def coarse_shells_close_in() -> None:
    """External and analytic: each error is small, and falls by the order."""
    curves = {what: curve[1] for plot in found("benchmarks").plots
              for what, curve in plot.curves.items()}  # fmt: skip
    for what, last, order in (
        ("Scordelis-Lo roof, 16 edges", 0.01, 1.1),
        ("pinched cylinder, 48 edges", 0.01, 2.0),
        ("hemisphere, 32 edges", 0.02, 2.0),
    ):
        assert curves[what][-1] < last
        assert np.log2(curves[what][-2] / curves[what][-1]) > order
    rows = found("benchmarks").data["benchmarks"]
    coarse, medium, fine = column(rows, "roof", "edges")
    assert coarse < medium < fine < PUBLISHED.scordelis_lo_roof
    assert 1.02 < column(rows, "with shear", "edges")[-1] / PUBLISHED.pinched_cylinder < 1.03


def pads_beside_webs_give_way_more() -> None:
    """By order: a flange is ten times as soft as a corner, and pads lower the peak."""
    rows = found("contact_size").data["local-compliance"]
    local = np.array([[row[f"edges × {part:g}"] for part in (8.0, 4.0, 2.0)] for row in rows])
    assert (np.diff(local[1:3], axis=1) > 0.0).all()
    assert (local[3:] > 10.0 * local[1:3]).all()
    peaks = [
        row["first tip peak\nload × 10 (mm)"] for row in found("contact_size").data["contact-size"]
    ]
    assert 350.0 < peaks[0] < 0.8 * peaks[1]


def stiffeners_act_at_their_ends_alone() -> None:
    """Analytic masses; each stiffens its own end, and leaves the other."""
    outer, collared, inner, banded, closed, both = found("stiffeners").data["variants"]
    mass, more = "mass (kg)", "one flange more (nm/N)"
    around, opening = 2.0 * (0.488874 + 0.325916), 0.463596 * 0.270571
    assert collared[mass] - outer[mass] == pytest.approx(7850.0 * around * 0.003, rel=1.0e-4)
    assert closed[mass] - inner[mass] == pytest.approx(7850.0 * opening * 0.008, rel=1.0e-3)
    for stiff, plain, there, elsewhere in (
        (collared, outer, "10 m", "9 m"), (banded, inner, "9 m", "10 m"),
        (closed, inner, "9 m", "10 m"),
    ):  # fmt: skip
        assert stiff[f"{there}: {more}"] < 0.6 * plain[f"{there}: {more}"]
        assert stiff[f"{elsewhere}: {more}"] == pytest.approx(
            plain[f"{elsewhere}: {more}"], rel=0.05
        )
    assert both[f"9 m: {more}"] < min(one[f"9 m: {more}"] for one in (banded, closed))


def a_triangle_at_a_contact_has_no_stress_and_a_patch_has() -> None:
    """Analytic, where refinement doubles a point's stress."""
    for x in (9, 10):
        triangle, patch = (
            column(found("stress").data["stress"], f"largest {what} at {x} m", " m")
            for what in ("triangle", "patch")
        )
        assert 1.2 < triangle[-1] / triangle[-2] < 1.7
        assert patch[-1] == pytest.approx(patch[-2], rel=0.03)


FACTS: Mapping[str, Callable[[], None]] = {
    "benchmarks": coarse_shells_close_in, "contact_size": pads_beside_webs_give_way_more,
    "stiffeners": stiffeners_act_at_their_ends_alone,
    "stress": a_triangle_at_a_contact_has_no_stress_and_a_patch_has,
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", SIZES)
def test_a_study_on_coarse_meshes_tells_its_facts(name: str) -> None:
    """Reference: that of each verification and of each fact."""
    json.dumps(found(name).data, allow_nan=name != "benchmarks")
    failed = [v.what for v in found(name).verifications if not v.holds]
    assert [what for what in failed if not what.startswith(UNREACHED.get(name, ()))] == []
    FACTS[name]()


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

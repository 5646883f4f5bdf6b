# SPDX-License-Identifier: LGPL-3.0-or-later
"""Studies on coarse meshes."""

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from protractile.runs.case.build import build_boom
from studies import contact_size, design_results, direct, mesh, stiffeners, stress, surface_contact
from studies.motions import friction_case


def silent(step: str) -> None:
    """Report no progress."""


CONTACT_SIZE = contact_size.Sizes(
    meshes=(8.0, 4.0, 2.0),
    default=4.0,
    lengths=(0.1,),
    pads=((0.2, 0.06),),
    loads=(10.0,),
)


@pytest.mark.slow
def test_pads_beside_the_webs_give_way_more() -> None:
    """Reference: by order. A flange is ten times as soft as a corner."""
    found = contact_size.study(silent, CONTACT_SIZE)
    meshes = found.data["local-compliance"]
    local = np.array([[row[f"edges × {part:g}"] for part in CONTACT_SIZE.meshes] for row in meshes])
    of_support, of_corner, of_pad = local[0], local[1:3], local[3:]
    assert of_support[-1] == pytest.approx(of_support[-2], rel=0.01)
    assert of_corner.shape == (2, 3)
    assert (np.diff(of_corner, axis=1) > 0.0).all()
    assert (of_pad > 10.0 * of_corner).all()
    peaks = [row["first tip peak\nload × 10 (mm)"] for row in found.data["contact-size"]]
    assert 350.0 < peaks[0] < 0.8 * peaks[1]


DIRECT = direct.Sizes(
    mesh=2.0,
    duration=0.37,
    steps=(1.0e-3, 5.0e-4),
    hard_steps=(2.5e-4, 1.25e-4),
    hard_duration=0.2,
    shifts=(5.0, 50.0, 300.0, 1500.0, 8000.0),
    moments=4,
)


@pytest.mark.slow
def test_tip_follows_the_unreduced_shell() -> None:
    """Reference: other code, the unreduced shell by the generalised-α method."""
    found = direct.study(silent, DIRECT)
    assert list(found.data) == ["direct-webs", "direct-pads"]
    own, larger, coarse, fine = found.data["direct-webs"]
    assert own["unknowns"] < larger["unknowns"] < 0.1 * coarse["unknowns"]
    off, off_larger = "off the reduced (%)", "off more coordinates (%)"
    assert own[off] == larger[off_larger] == 0.0
    assert 0.0 < fine[off_larger] < coarse[off_larger] < 0.05
    assert all(row["contact impulse (N s)"] > 500.0 for row in found.data["direct-pads"])
    assert len(found.verifications) == 6
    assert all(verification.holds for verification in found.verifications)


MESH = mesh.Sizes(meshes=(8.0, 4.0, 2.0), default=4.0, duration=0.9, frequencies=2, peaks=1)


@pytest.mark.slow
def test_coarse_meshes_close_in() -> None:
    """Reference: other code, the limit of uniform meshes."""
    found = mesh.study(silent, MESH)
    values = {
        row["quantity"]: [row[f"edges × {part:g}"] for part in MESH.meshes]
        for row in found.data["meshes"]
    }
    lowest = values["natural frequency 1 (Hz)"]
    assert lowest[0] > lowest[1] > lowest[2]
    verifications = {verification.what: verification for verification in found.verifications}
    frequency = verifications["natural frequency 1, default mesh"]
    assert frequency.holds
    assert frequency.value == lowest[1]
    assert frequency.order == pytest.approx(2.0, abs=0.5)
    assert frequency.source.startswith("limit of its refinement")
    assert lowest[2] == pytest.approx(7.2565, rel=1.0e-3)
    assert values["tip peak 1 (mm)"][2] == pytest.approx(177.5, rel=0.005)


STIFFENERS = stiffeners.Sizes(
    mesh=0.3, collars=(0.010,), diaphragms=(0.008,), frequencies=2, plate_mesh=0.05
)


@pytest.mark.slow
def test_stiffeners_act_at_their_ends_only() -> None:
    """Reference: analytic, a sheared plate, a ring, masses; each acts at its end only."""
    found = stiffeners.study(silent, STIFFENERS)
    for verification in found.verifications:
        assert verification.holds, (verification.what, verification.error)
    assert [verification.unit for verification in found.verifications] == ["N m", "m²/N", "m²/N"]

    outer, collared, inner, banded, closed, both = found.data["variants"]
    mass, more = "mass (kg)", "one flange more (nm/N)"
    perimeter, opening = 2.0 * (0.488874 + 0.325916), 0.463596 * 0.270571
    assert collared[mass] - outer[mass] == pytest.approx(
        7850.0 * perimeter * 0.3 * 0.01, rel=1.0e-4
    )
    assert closed[mass] - inner[mass] == pytest.approx(7850.0 * opening * 0.008, rel=1.0e-3)
    for stiff, plain, there, elsewhere in (
        (collared, outer, "10 m", "9 m"),
        (banded, inner, "9 m", "10 m"),
        (closed, inner, "9 m", "10 m"),
    ):
        assert stiff[f"{there}: {more}"] < 0.6 * plain[f"{there}: {more}"]
        together = f"{there}: both flanges (nm/N)"
        assert stiff[together] < plain[together]
        other = f"{elsewhere}: {more}"
        assert stiff[other] == pytest.approx(plain[other], rel=0.05)
    tail = [one[f"9 m: {more}"] for one in (banded, closed, both)]
    assert tail[2] < min(tail[:2])
    # The head's mass lowers what bends as a whole.
    assert collared["f1 (Hz)"] < outer["f1 (Hz)"]


STRESS = stress.Sizes(meshes=(0.2, 0.1, 0.05), default=0.1, places=(14.0,))


def test_contact_forces_hold_the_segment() -> None:
    """Reference: analytic, 550.7 N upwards at 14 m with lever arms of 4 and 5 m."""
    forces = stress.contact_forces(build_boom(friction_case()))
    assert {x: side for x, (side, _) in forces.items()} == {9.0: -1, 10.0: 1}
    assert forces[10.0][1] == pytest.approx(5.0 * 550.7)
    assert forces[9.0][1] == pytest.approx(4.0 * 550.7)


@pytest.mark.slow
def test_the_contact_has_no_stress_of_its_own_and_a_patch_has() -> None:
    """Reference: analytic away from contacts, where refinement doubles a point's stress."""
    found = stress.study(silent, STRESS)
    assert all(verification.holds for verification in found.verifications)
    beam = next(
        verification for verification in found.verifications if "top at 14 m" in verification.what
    )
    assert beam.error < 2.0e-3
    near = {
        row["quantity"]: [row[f"{size:g} m"] for size in STRESS.meshes]
        for row in found.data["stress"]
    }
    for x in (9, 10):
        triangle, patch = (near[f"largest {what} at {x} m (MPa)"] for what in ("triangle", "patch"))
        assert 1.2 < triangle[2] / triangle[1] < 1.7
        assert patch[2] == pytest.approx(patch[1], rel=0.03)


SURFACE_CONTACT = surface_contact.Sizes(
    mesh=0.5, duration=0.3, peak=0.9, penalties=(1.0, 10.0), points=((8, 4),), pads=((0.1, 0.06),)
)


@pytest.mark.slow
def test_a_surface_is_softer_than_webs_on_webs() -> None:
    """Reference: the order of compliances."""
    found = surface_contact.study(silent, SURFACE_CONTACT)
    rubbed = "first tip peak\nwith friction (mm)"
    peaks = {row["contact"]: row[rubbed] for row in found.data["surface"]}
    assert peaks["near webs"] == pytest.approx(177.5, rel=0.01)
    assert 1.05 * peaks["near webs"] < peaks["surface, 8 x 4 points"]
    assert 1.15 * peaks["near webs"] < peaks["pads of 0.1 m x 0.06 m"]
    softer, stiffer = (peaks[f"surface, 8 x 4 points, {part} of the penalty"] for part in (1, 10))
    assert softer == pytest.approx(peaks["surface, 8 x 4 points"], rel=1.0e-9)
    assert peaks["near webs"] < stiffer < softer


def test_forces_by_hand_are_in_balance() -> None:
    """Reference: analytic, the sum of all forces and of their moments about the origin."""
    tail, head = design_results.station_forces()
    assert tail + head == pytest.approx(55.07 * 10.0)
    assert tail * 9.0 + head * 10.0 == pytest.approx(55.07 * 10.0 * 14.0)
    foot, far = design_results.support_forces()
    assert foot + far + 831.6 + tail + head == pytest.approx(0.0, abs=1e-9)
    moments = far * 2.0 + 831.6 * 5.0 + tail * 9.0 + head * 10.0
    assert moments == pytest.approx(0.0, abs=1e-9)

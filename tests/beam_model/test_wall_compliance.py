# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compliance of walls under pads: frames in closed form, stiffeners, a finer mesh."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model import wall_compliance
from protractile.beam_model.wall_compliance import PressedArea
from protractile.geometry.boom import Collar, Diaphragm, Material, Segment
from protractile.geometry.box import BoxSection

SIDE, WALL, LENGTH = 0.3, 6.0e-3, 2.0
STEEL = Material(2.1e11, 0.3, 7850.0)


def tube(material: Material = STEEL, **stiffeners: object) -> Segment:
    """Return a square tube with a wall of 6 mm."""
    section = BoxSection(SIDE, SIDE, WALL, WALL)
    plain = Segment.of_section("tube", 0.0, LENGTH, material, section)
    return replace(plain, **stiffeners)


def pad(start: float = 0.0, end: float = 0.1, side: int = 1) -> PressedArea:
    """Return a pair of pads, 60 mm wide, 10 mm beside the corners."""
    half = 0.5 * SIDE - 0.010
    return PressedArea(start, end, "z", side, ((half - 0.06, half), (-half, 0.06 - half)))


def test_a_tube_under_pressure_on_two_walls_bends_as_a_frame() -> None:
    """Reference: analytic, a frame of equal members: θ = p a³/48 D at a joint, and the mean
    deflection p a⁴/720 D + θ a/6.
    """
    span = ((-0.5 * SIDE, 0.5 * SIDE),)
    walls = PressedArea(0.0, LENGTH, "z", 1, span), PressedArea(0.0, LENGTH, "z", -1, span)
    compliance = wall_compliance.wall_compliance(tube(Material(2.1e11, 0.0, 7850.0)), walls)
    pressure, rigidity = 1.0 / (SIDE * LENGTH), 2.1e11 * WALL**3 / 12.0
    expected = 7.0 / 1440.0 * pressure * SIDE**4 / rigidity
    assert compliance.sum(axis=1) == pytest.approx(expected, rel=1.0e-3)


def test_elements_are_fine_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: other mesh, with a third of the element length. The default is within 1 %."""
    areas = pad(side=1), pad(side=-1)
    default = wall_compliance.wall_compliance(tube(), areas)
    monkeypatch.setattr(wall_compliance, "_LENGTH", 0.07)
    monkeypatch.setattr(wall_compliance, "_GROWTH", 1.3)
    # The undecorated function, since the cached result belongs to the default mesh.
    fine = wall_compliance.wall_compliance.__wrapped__(tube(), areas)
    np.testing.assert_allclose(default, fine, atol=0.01 * fine[0, 0])
    assert (np.diag(default) < np.diag(fine)).all()  # conforming elements are too stiff


def test_collars_stiffen_by_the_cube_of_the_thickness() -> None:
    """Reference: analytic, rigidity of a plate of twice the thickness."""
    plain = wall_compliance.wall_compliance(tube(), (pad(),))
    doubled = tube(collars=(Collar((0.0, LENGTH), WALL),))
    assert wall_compliance.wall_compliance(doubled, (pad(),)) == pytest.approx(plain / 8.0)


def test_diaphragm_prevents_wall_deflection() -> None:
    """Reference: analytic bounds: 0 at a diaphragm, unchanged at the far end."""
    plain = float(wall_compliance.wall_compliance(tube(), (pad(),))[0, 0])
    there, beyond = (
        float(
            wall_compliance.wall_compliance(tube(diaphragms=(Diaphragm(x, WALL),)), (pad(),))[0, 0]
        )
        for x in (0.05, 1.5)
    )
    assert there < 0.15 * plain
    assert beyond == pytest.approx(plain, rel=1.0e-12)


def test_an_end_is_softer_than_the_middle_of_a_tube() -> None:
    """Reference: analytic bounds of a beam on an elastic foundation, 1 and 4 (Hetényi 1946)."""
    end, middle = (
        float(wall_compliance.wall_compliance(tube(), (pad(x, x + 0.1),))[0, 0]) for x in (0.0, 1.0)
    )
    assert 1.2 < end / middle < 4.0


def test_pad_flush_with_the_segment_end_tolerates_round_off() -> None:
    """Reference: the pad that ends exactly at the end of the segment."""
    exact, rounded = (
        wall_compliance.wall_compliance(tube(), (pad(LENGTH - 0.1, end),))
        for end in (LENGTH, np.nextafter(LENGTH, 0.0))
    )
    assert rounded == pytest.approx(exact, rel=1e-9)


def test_a_symmetric_section_has_a_symmetric_compliance() -> None:
    """Reference: analytic, by the symmetry of a box; one pad is on one side of the middle."""
    width = 0.211
    box = Segment.of_section("box", 0.0, LENGTH, STEEL, BoxSection(0.29, width, WALL, WALL))
    near, far = 0.5 * width - 0.007, 0.5 * width - 0.057
    left, right = (
        PressedArea(0.0, 0.1, "z", 1, (tuple(sorted((side * near, side * far))),))
        for side in (-1.0, 1.0)
    )
    one, other = np.diag(wall_compliance.wall_compliance(box, (left, right)))
    assert one == pytest.approx(other, rel=1e-10)

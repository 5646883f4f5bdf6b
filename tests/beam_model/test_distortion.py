# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distortion of sections under pads: beams on elastic foundation, ends, collars, folds of 180°."""

import numpy as np
import pytest

from protractile.beam_model.distortion import Press, _frame, distortion_compliance
from protractile.beam_model.hermite import sum_of_products
from protractile.geometry.boom import Collar, Diaphragm, Segment
from protractile.geometry.box import BoxSection
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.profiles import hexagon
from protractile.geometry.section import Section
from protractile.geometry.support import Support
from tests.shell_model.booms import STEEL

SIDE, WALL, LENGTH = 0.3, 3.0e-3, 20.0
BOX = BoxSection(SIDE, SIDE, WALL, WALL)
HEXAGON = hexagon(0.50, 0.45, 0.25, 0.006, 0.006, 0.006)


def segment(section: Section = BOX, **changes: object) -> Segment:
    return Segment.of_section("tube", 0.0, LENGTH, STEEL, section, **changes)


def corners(x: float, high: float = 0.5, section: Section = BOX, side: int = 1) -> Press:
    """Return a vertical force on the upper corners, a fraction ``high`` of it on the right one."""
    face = section.face("z", side)
    parts = (1.0 - high, face.low, face.low), (high, face.high, face.high)
    return Press(x, "z", 1 if side > 0 else -1, parts)


def compliance(one: Segment, *presses: Press) -> float:
    return float(distortion_compliance(one, presses)[0, 0])


def racking() -> float:
    """Return the compliance λ/2k in m/N of a long square tube under a force on one corner.

    Plates displaced by ±a along their tangents rotate by 2a/b: k = 4 · 12 D/b (2/b)². The corners
    move along x by b a′/2: E I = E t b³/3.
    """
    rigidity = STEEL.youngs_modulus * WALL**3 / (12.0 * (1.0 - STEEL.poissons_ratio**2))
    foundation = 192.0 * rigidity / SIDE**3
    bending = STEEL.youngs_modulus * WALL * SIDE**3 / 3.0
    return float((foundation / (4.0 * bending)) ** 0.25 / (2.0 * foundation))


def test_a_box_racks_as_a_beam_on_an_elastic_foundation() -> None:
    """Reference: analytic, λ/2k in the middle and 2λ/k at an end (Hetényi 1946). The twist of the
    plates, which they neglect, makes the tube stiffer by 0.5 and 1 %.
    """
    found = [compliance(segment(), corners(x, 1.0)) for x in (0.5 * LENGTH, 0.0, LENGTH)]
    assert found == pytest.approx(racking() * np.array([1.0, 4.0, 4.0]), rel=0.012)
    assert found[0] < racking()


def test_symmetric_forces_do_not_distort_a_box() -> None:
    """Reference: analytic. Both corners carry half of the force along the webs."""
    assert not distortion_compliance(segment(), (corners(1.0), corners(1.0, side=-1))).any()


def test_three_plates_keep_their_shape() -> None:
    """Reference: analytic, n − 3 modes."""
    three = PolygonSection(((-0.2, 0.0), (0.2, 0.0), (0.0, 0.3)), (WALL, WALL, WALL))
    bottom = Press(0.0, "z", -1, ((1.0, -0.1, 0.1),))
    assert distortion_compliance(segment(three), (bottom,)) == pytest.approx(0.0, abs=0.0)


def test_a_collar_stiffens_frame_and_plates() -> None:
    """Reference: analytic, 8 k and 2 E I of plates of twice the thickness."""
    middle = corners(0.5 * LENGTH, 1.0)
    doubled = segment(collars=(Collar((0.0, LENGTH), WALL),))
    expected = compliance(segment(), middle) * 4.0**0.25 / 8.0
    assert compliance(doubled, middle) == pytest.approx(expected, rel=0.01)
    short = segment(collars=(Collar((9.7, 10.3), WALL),))
    assert compliance(doubled, middle) < compliance(short, middle) < compliance(segment(), middle)


def test_diaphragms_and_rigid_supports_keep_the_shape() -> None:
    """Reference: by construction at the diaphragm and the support; the free end far away."""
    plain = compliance(segment(), corners(0.0, 1.0))
    closed = segment(diaphragms=(Diaphragm(0.0, WALL),))
    assert compliance(closed, corners(0.0, 1.0)) == 0.0
    assert compliance(closed, corners(LENGTH, 1.0)) == pytest.approx(plain, rel=1e-9)
    ends = [
        compliance(segment(supports=(Support(0.0, *how),)), corners(0.3, 1.0))
        for how in (("clamped",), ("pinned",), ("pinned", 1.0e9))
    ]
    assert 0.0 < ends[0] < ends[1] < ends[2]


def test_a_corner_on_a_flat_plate_changes_nothing() -> None:
    """Reference: analytic, the hexagon without an additional corner in the middle of its top."""
    flat = HEXAGON.plates
    places = [plate.start for plate in flat]
    top = next(n for n, plate in enumerate(flat) if plate.name == "top")
    more = [*places[: top + 1], flat[top].midpoint, *places[top + 1 :]]
    seven = PolygonSection(tuple(more), (0.006,) * 7)
    pressed = corners(3.0, section=HEXAGON, side=-1)
    expected = compliance(segment(HEXAGON), pressed)
    assert compliance(segment(seven), pressed) == pytest.approx(expected, rel=5.0e-3)


def test_elements_are_fine_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: other mesh, with a quarter of the element length."""
    pressed = corners(0.0, section=HEXAGON), corners(1.3, section=HEXAGON, side=-1)
    default = distortion_compliance(segment(HEXAGON), pressed)
    monkeypatch.setattr("protractile.beam_model.distortion._LENGTH", 0.125)
    fine = distortion_compliance.__wrapped__(segment(HEXAGON), pressed)
    np.testing.assert_allclose(default, fine, rtol=1.0e-3)


def test_kronecker_products_of_free_unknowns_are_summed() -> None:
    """Reference: another implementation (`numpy.kron`) of the dense matrices."""
    rng = np.random.default_rng(1)
    shape = np.array([[1.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    lefts, rights = rng.normal(size=(2, 3, 3)) * shape, rng.normal(size=(2, 4, 4))
    free = np.arange(12) % 5 > 0
    found = sum_of_products([*lefts], [*rights], free).toarray()
    whole = sum(np.kron(left, right) for left, right in zip(lefts, rights, strict=True))
    assert found == pytest.approx(whole[free][:, free], abs=1e-14)


def test_a_frame_is_computed_once() -> None:
    """Reference: the number of computed frames. Forces at other x act on the same frame."""
    _frame.cache_clear()
    for x in (4.0, 5.0):
        distortion_compliance(segment(BoxSection(SIDE, SIDE, WALL, 0.9 * WALL)), (corners(x, 1.0),))
    assert _frame.cache_info().misses == 1

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Calibration of beams, and compliance of walls and distortion of sections under pads."""

from dataclasses import replace

import numpy as np
import pytest

from protractile.beam_model import wall_compliance
from protractile.beam_model.calibration import (
    effective_stiffness,
    elastic_compliance,
    residual_compliance,
    with_springs,
    with_stiffness,
)
from protractile.beam_model.distortion import Press, distortion_compliance
from protractile.beam_model.finite_element import finite_element_segment
from protractile.beam_model.wall_compliance import PressedArea
from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.reduction import condense
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Collar, Diaphragm, Material, Segment, Support
from protractile.geometry.box import BoxSection
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.probe_responses import PROBE_FREQUENCY, ProbedMotion, ProbeResponses
from protractile.geometry.profiles import hexagon
from protractile.geometry.section import Section
from tests.booms import ARM, STEEL
from tests.modal import modal_system

MODES = 60


def system(num_modes: int = MODES) -> GapSystem:
    """Return a system with one rigid mode, elastic modes of ascending frequency, and two rows."""
    random = np.random.default_rng(3)
    rows = random.normal(size=(4, MODES))[:, :num_modes]
    omega = np.concatenate([[0.0], 20.0 * np.arange(1, MODES) ** 1.5])[:num_modes]
    laws = [PowerContact(1e7, 1.0).with_clearance(0.01)] * 2
    rubbing = {"friction_rows": rows[2:3], "frictions": [DryFriction(0.2, 0, 100.0, ())]}
    return modal_system(omega**2, rows[3], rows[:2], laws, tip=rows[2], **rubbing)


def test_condensed_system_has_the_same_slow_response() -> None:
    """Reference: analytic, C(σ) = B (Ω² + σ)⁻¹ Bᵀ of the whole system, at 0 and 20 Hz."""
    whole = system()
    few, shapes = condense(whole, 20)
    np.testing.assert_allclose(shapes.T @ shapes, np.eye(20), atol=1e-12)
    np.testing.assert_allclose(few.frequencies[:12], whole.frequencies[:12], rtol=1e-12, atol=1e-9)
    np.testing.assert_allclose(elastic_compliance(few), elastic_compliance(whole), rtol=1e-9)
    # The truncated modes alone miss by far more.
    shift = (2.0 * np.pi * 20.0) ** 2
    found, expected, cut = (
        (rows := np.vstack([one.rows, one.load])) / (one.omega2 + shift) @ rows.T
        for one in (few, whole, system(20))
    )
    assert np.abs(found - expected).max() < 1e-3 * np.abs(cut - expected).max()


def test_excited_modes_are_kept_before_slower_unexcited_modes() -> None:
    """Reference: analytic, the order of b²/ω⁴ after the slowest eighth of 24 modes."""
    whole = system()
    signs = np.sign(np.vstack([whole.rows, whole.friction_rows, whole.load]))
    signs[:, 1::2] = 0.0
    few, _ = condense(replace(whole, rows=signs[:2], friction_rows=signs[2:3], load=signs[3]), 24)
    expected = whole.frequencies[np.r_[0, 1, 2, 4:30:2]]
    np.testing.assert_allclose(few.frequencies[:16], expected, rtol=1e-12, atol=1e-9)


def test_rigid_motions_remain_in_small_condensed_systems() -> None:
    """Reference: analytic, the compliance of the whole system; its rigid mode is the last one."""
    rows, laws = np.random.default_rng(4).normal(size=(24, MODES)), 12 * list(system().laws)
    several = {"rows": rows, "laws": laws, "station_of_row": np.arange(24) % 2}
    whole = replace(system(), omega2=system().omega2[::-1], **several)
    few, _ = condense(whole, 24)
    assert few.omega2.min() == 0.0
    np.testing.assert_allclose(elastic_compliance(few), elastic_compliance(whole), rtol=1e-8)


PLACES = (0.0, 1.0, 10.0)


def probed(segment: Segment) -> ProbeResponses:
    """Return the responses of the beam with finer elements."""
    found: dict[ProbedMotion, Array] = {}
    model = finite_element_segment(segment, 0.2, PLACES, "timoshenko", True)
    for motion, component in model.components.items():
        ends = () if motion == "twist" else (PLACES[0], PLACES[-1])
        probes = np.array([*map(component.at, PLACES), *(component.at(x, 1) for x in ends)])
        sigma = (2.0 * np.pi * PROBE_FREQUENCY) ** 2
        found[motion] = probes @ np.linalg.solve(
            component.stiffness + sigma * component.mass, probes.T
        )
    return ProbeResponses(PLACES, found)


@pytest.mark.parametrize("supports", [(), (Support(0.0, "clamped"),)])
def test_a_beam_finds_its_own_stiffness(supports: tuple[Support, ...]) -> None:
    """Reference: analytic. Initial stiffnesses are off by 3 %; the beam gives the true ones."""
    segment = Segment.of_section("box", 0.0, 10.0, STEEL, ARM, supports=supports)
    lateral, shears = segment.lateral, (segment.shear_stiffness, segment.turned().shear_stiffness)
    turned = replace(
        lateral,
        second_moment_of_area=0.97 * lateral.second_moment_of_area,
        torsion_constant=0.9 * lateral.torsion_constant,
    )
    true = replace(
        segment,
        second_moment_of_area=1.03 * segment.second_moment_of_area,
        shear_stiffnesses=(0.8 * shears[0], 1.2 * shears[1]),
        lateral=turned,
    )
    found = effective_stiffness(segment, probed(true))
    # What weighs so that the stiffness stays near the plates' moves it by less than this.
    bending = true.bending_stiffness, true.turned().bending_stiffness
    assert found.bending == pytest.approx(bending, rel=2e-4)
    assert found.shear == pytest.approx(true.shear_stiffnesses, rel=5e-3)
    torsion = STEEL.shear_modulus * turned.torsion_constant
    assert found.torsion == pytest.approx(torsion, rel=2e-4)
    bare = replace(lateral, rotary_inertia=0.0, polar_inertia=0.0)
    taken = with_stiffness(replace(segment, rotary_inertia=0.0, lateral=bare), found)
    assert taken.bending_stiffness == pytest.approx(found.bending[0], rel=1e-12)
    assert taken.turned().shear_stiffness == pytest.approx(found.shear[1], rel=1e-12)
    assert taken.rotary_inertia == segment.rotary_inertia
    assert taken.lateral.rotary_inertia == lateral.rotary_inertia
    assert taken.lateral.polar_inertia == lateral.polar_inertia


def test_springs_add_the_compliance_of_the_fine_model() -> None:
    """Reference: analytic, the static compliance of the fine model."""
    fine, coarse = system(), system(12)
    residual = residual_compliance(coarse, fine)
    sprung = with_springs(coarse, residual)
    assert np.linalg.norm(residual) > 5e-4 * np.linalg.norm(elastic_compliance(fine))
    np.testing.assert_allclose(elastic_compliance(sprung), elastic_compliance(fine), rtol=1e-10)
    # Nothing else feels them.
    assert not sprung.load[12:].any()
    assert not sprung.observers["tip"].row[12:].any()


def test_negative_residual_compliance_is_left_out() -> None:
    """Reference: analytic. For orthogonal g and h, D = g gᵀ − h hᵀ has the positive part g gᵀ."""
    coarse = system(12)
    g, h = np.array([1.0, 1.0, 1.0]) * 1e-9, np.array([1.0, -1.0, 0.0]) * 1e-10
    residual = np.outer(g, g) - np.outer(h, h)
    equal = residual / np.sqrt(np.outer(np.diag(residual), np.diag(residual)))
    assert np.linalg.eigvalsh(equal)[0] < -1e-3
    sprung = with_springs(coarse, residual)
    assert sprung.num_modes == 13
    spring = np.concatenate([sprung.rows[:, 12], sprung.friction_rows[:, 12]]) / sprung.omega[12]
    # To the part of h in g: both are as large in the first two places.
    np.testing.assert_allclose(np.outer(spring, spring), np.outer(g, g), rtol=0.02)


SIDE, WALL, LENGTH = 0.3, 6.0e-3, 2.0


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
    """Reference: analytic, a frame: θ = p a³/48 D at a joint, the mean p a⁴/720 D + θ a/6."""
    span = ((-0.5 * SIDE, 0.5 * SIDE),)
    walls = PressedArea(0.0, LENGTH, "z", 1, span), PressedArea(0.0, LENGTH, "z", -1, span)
    compliance = wall_compliance.wall_compliance(tube(Material(2.1e11, 0.0, 7850.0)), walls)
    pressure, rigidity = 1.0 / (SIDE * LENGTH), 2.1e11 * WALL**3 / 12.0
    expected = 7.0 / 1440.0 * pressure * SIDE**4 / rigidity
    assert compliance.sum(axis=1) == pytest.approx(expected, rel=1.0e-3)


def test_stiffeners_and_ends_of_tubes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: analytic. Collars make walls 8 times as rigid, diaphragms prevent deflection, an
    end is 1 to 4 times as soft as the middle (Hetényi 1946), and pads of a pair yield alike.
    """

    def soft(pressed: PressedArea, **stiffeners: object) -> float:
        return float(wall_compliance.wall_compliance(tube(**stiffeners), (pressed,))[0, 0])

    plain = soft(pad())
    assert soft(pad(), collars=(Collar((0.0, LENGTH), WALL),)) == pytest.approx(plain / 8.0)
    assert soft(pad(), diaphragms=(Diaphragm(0.05, WALL),)) < 0.15 * plain
    assert soft(pad(), diaphragms=(Diaphragm(1.5, WALL),)) == pytest.approx(plain, rel=1.0e-12)
    assert 1.2 < plain / soft(pad(1.0, 1.1)) < 4.0
    flush = [soft(pad(LENGTH - 0.1, end)) for end in (LENGTH, np.nextafter(LENGTH, 0.0))]
    assert flush[1] == pytest.approx(flush[0], rel=1e-9)
    # A taper is there what a tube of its section is.
    tail, head, middle = (BoxSection(size, 0.5 * size, WALL, WALL) for size in (0.4, 0.2, 0.35))
    assert soft(pad(0.45, 0.55), section=tail, head_section=head) == pytest.approx(
        soft(pad(0.45, 0.55), section=middle), rel=1e-12
    )
    near, far = 0.5 * SIDE - 0.007, 0.5 * SIDE - 0.057
    left, right = (
        PressedArea(0.0, 0.1, "z", 1, (tuple(sorted((side * near, side * far))),))
        for side in (-1.0, 1.0)
    )
    assert soft(left) == pytest.approx(soft(right), rel=1e-10)
    # With a third of the element length; conforming elements are too stiff.
    areas = pad(side=1), pad(side=-1)
    default = wall_compliance.wall_compliance(tube(), areas)
    monkeypatch.setattr(wall_compliance, "_LENGTH", 0.07)
    monkeypatch.setattr(wall_compliance, "_GROWTH", 1.3)
    # The undecorated function, since the cached result belongs to the default mesh.
    fine = wall_compliance.wall_compliance.__wrapped__(tube(), areas)
    np.testing.assert_allclose(default, fine, atol=0.01 * fine[0, 0])
    assert (np.diag(default) < np.diag(fine)).all()


THIN, LONG = 3.0e-3, 20.0
SQUARE, HEXAGON = BoxSection(SIDE, SIDE, THIN, THIN), hexagon(0.50, 0.45, 0.25, *(0.006,) * 3)


def corners(x: float, section: Section = SQUARE, side: int = 1, high: float = 1.0) -> Press:
    """Return a vertical force on the corners of a side, a part ``high`` of it on the right one."""
    face = section.face("z", side)
    parts = (1.0 - high, face.low, face.low), (high, face.high, face.high)
    return Press(x, "z", side, parts)


def racking(pressed: Press | float, section: Section = SQUARE, **changes: object) -> float:
    """Return the compliance of a long tube in m/N under a press, or a force at x on a corner."""
    segment = Segment.of_section("tube", 0.0, LONG, STEEL, section, **changes)
    press = pressed if isinstance(pressed, Press) else corners(pressed)
    return float(distortion_compliance(segment, (press,))[0, 0])


def test_a_box_racks_as_a_beam_on_an_elastic_foundation() -> None:
    """Reference: analytic, λ/2k in the middle and 2λ/k at an end (Hetényi 1946). Plates displaced
    by ±a along their tangents rotate by 2a/b: k = 4 · 12 D/b (2/b)². The corners move along x by
    b a′/2: E I = E t b³/3. The twist of the plates, which they neglect, makes the tube stiffer by
    0.5 and 1 %.
    """
    rigidity = STEEL.youngs_modulus * THIN**3 / (12.0 * (1.0 - STEEL.poissons_ratio**2))
    foundation = 192.0 * rigidity / SIDE**3
    bending = STEEL.youngs_modulus * THIN * SIDE**3 / 3.0
    expected = (foundation / (4.0 * bending)) ** 0.25 / (2.0 * foundation)
    found = [racking(x) for x in (0.5 * LONG, 0.0, LONG)]
    assert found == pytest.approx(expected * np.array([1.0, 4.0, 4.0]), rel=0.012)
    assert found[0] < expected
    # Collars double both plates: 8 k and 2 E I.
    doubled = racking(0.5 * LONG, collars=(Collar((0.0, LONG), THIN),))
    assert doubled == pytest.approx(found[0] * 4.0**0.25 / 8.0, rel=0.01)
    assert doubled < racking(0.5 * LONG, collars=(Collar((9.7, 10.3), THIN),)) < found[0]
    # Diaphragms and rigid supports keep the shape, also under forces along the webs.
    closed = {"diaphragms": (Diaphragm(0.0, THIN),)}
    assert racking(0.0, **closed) == 0.0
    assert racking(LONG, **closed) == pytest.approx(found[2], rel=1e-9)
    held = ("clamped",), ("pinned",), ("pinned", 1.0e9)
    ends = [racking(0.3, supports=(Support(0.0, *how),)) for how in held]
    assert 0.0 < ends[0] < ends[1] < ends[2]
    assert racking(corners(1.0, high=0.5)) == 0.0
    three = PolygonSection(((-0.2, 0.0), (0.2, 0.0), (0.0, 0.3)), (THIN,) * 3)
    assert racking(Press(0.0, "z", -1, ((1.0, -0.1, 0.1),)), three) == 0.0


def test_a_corner_on_a_flat_plate_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: analytic, the hexagon without it; another mesh of a quarter of the length, also of
    a flat box, whose elements are as long as its height asks.
    """
    places = [plate.start for plate in HEXAGON.plates]
    top = next(n for n, plate in enumerate(HEXAGON.plates) if plate.name == "top")
    places.insert(top + 1, HEXAGON.plates[top].midpoint)
    pressed = corners(1.3, HEXAGON, side=-1)
    default = racking(pressed, HEXAGON)
    seven = PolygonSection(tuple(places), (0.006,) * 7)
    assert racking(pressed, seven) == pytest.approx(default, rel=5.0e-3)
    flat = BoxSection(0.1, 0.4, THIN, THIN)
    defaults = default, racking(corners(1.3, flat), flat)
    monkeypatch.setattr("protractile.beam_model.distortion._LENGTH", 0.125)
    for found, section, press, near in (
        (defaults[0], HEXAGON, pressed, 1.0e-3), (defaults[1], flat, corners(1.3, flat), 1.0e-6),
    ):  # fmt: skip
        segment = Segment.of_section("tube", 0.0, LONG, STEEL, section)
        fine = distortion_compliance.__wrapped__(segment, (press,))
        assert found == pytest.approx(fine[0, 0], rel=near)

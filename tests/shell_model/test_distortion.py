# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distortion of sections at contacts: the estimate of beams against shells."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from protractile.beam_model.calibration import residual_compliance
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.statics import static_state
from protractile.beam_model.wall_compliance import contact_compliance, station_compliance
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.excitation import Step
from protractile.dynamics.gap_system import GapSystem
from protractile.geometry.boom import Boom, Collar, Joint, Pad, Segment, Support
from protractile.geometry.load import Load
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import EACH_SIDE
from protractile.geometry.segment import PointMass
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import reduce_boom
from studies.polygon_distortion import CASES, Case, of_beam, of_shell
from tests.shell_model.booms import LATERAL_LAW, LAW, STEEL, boom_in_space
from tests.touching import touching

HEXAGONS = CASES["hexagons, pads on corners"]


def shell_of(boom: Boom, size: float) -> GapSystem:
    return reduce_boom(boom, ShellOptions(size), MPI.COMM_WORLD).system.gather_loads()


@pytest.mark.slow
def test_a_boom_of_hexagons_with_pads_on_corners_is_as_soft_as_its_shell() -> None:
    """Reference: other code, a shell of edges of 50 mm: −444.7 mm, 0.7828 Hz. With rigid sections
    the tip is at −265 mm, with 1.04 Hz.
    """
    weights = [9.81 * STEEL.density * one.area for one in (HEXAGONS.outer, HEXAGONS.inner)]
    outer = Segment.of_section(
        "outer",
        0.0,
        8.7,
        STEEL,
        HEXAGONS.outer,
        load=-weights[0],
        supports=(Support(0.0, "clamped"),),
    )
    inner = Segment.of_section(
        "inner", 7.1, 15.8, STEEL, HEXAGONS.inner, load=-weights[1], masses=(PointMass(15.8, 6e3),)
    )
    pad = Pad(0.25, 0.07, bears="corner")
    law = PowerContact(stiffness=1.9e9 * 0.25 * 0.07 / 0.02, exponent=1.0)
    joint = Joint(0, 1, (7.1, 8.7), 0.004, contact=law, pad=pad)
    boom = Boom((outer, inner), (joint,), (Load(1, "z", -9.81 * 6e3, 15.8, Step()),))
    state, shell = static_state(boom), shell_of(boom, 0.1)
    assert state.tip == pytest.approx(-0.4447, rel=0.02)
    hertz = closed_contact_modes(state.system, state.position)[0][0] / (2.0 * np.pi)
    assert hertz == pytest.approx(0.7828, rel=0.02)
    rest = equilibrium_at(shell, 0.0)
    assert state.tip == pytest.approx(shell.observers["tip"].row @ rest, rel=0.03)
    assert static_state(boom, walls=0.0).tip == pytest.approx(-0.265, rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("bears", ["corner", "wall"])
def test_an_octagonal_mast_distorts_in_both_planes(bears: str) -> None:
    """Reference: other code, a shell: −86 and 16 mm with pads on corners. Rigid sections give −64
    and 35 mm: the distortion under vertical forces closes lateral play.
    """
    sections = (
        octagon(0.5, 0.5, 0.14, 0.005, 0.005, 0.005),
        octagon(0.44, 0.44, 0.125, *3 * [0.004]),
    )
    weights = [9.81 * STEEL.density * one.area for one in sections]
    clamp = (Support(0.0, "clamped"),)
    outer = Segment.of_section(
        "outer", 0.0, 6.0, STEEL, sections[0], load=-weights[0], supports=clamp
    )
    inner = Segment.of_section("inner", 4.9, 10.9, STEEL, sections[1], load=-weights[1])
    law = PowerContact(stiffness=1.9e9 * 0.15 * 0.05 / 0.02, exponent=1.0)
    pad = Pad(0.15, 0.05, bears="corner" if bears == "corner" else "wall")
    joint = Joint(
        0, 1, (4.9, 6.0), 0.004, lateral_play=0.004, contact=law, lateral_contact=law, pad=pad
    )
    loads = Load(1, "z", -9.81 * 300.0, 10.9, Step()), Load(1, "y", 1500.0, 10.9, Step())
    boom = Boom((outer, inner), (joint,), loads)
    state, shell = static_state(boom), shell_of(boom, 0.1)
    rest = equilibrium_at(shell, 0.0)
    rigid = static_state(boom, walls=0.0)
    for name in ("tip", "tip_lateral"):
        reference = float(shell.observers[name].row @ rest)
        assert state.system.observers[name].row @ state.position == pytest.approx(
            reference, rel=0.1
        ), name
        undistorted = float(rigid.system.observers[name].row @ rigid.position)
        assert abs(undistorted - reference) > 0.2 * abs(reference)


def taper_inner(boom: Boom) -> Boom:
    inner, head = boom.segments[1], hexagon(0.37, 0.25, 0.16, 0.007, 0.009, 0.006)
    tapered = Segment.of_section(
        "inner", inner.start, inner.end, STEEL, inner.section, head_section=head
    )
    return replace(boom, segments=(boom.segments[0], tapered))


def with_collar_at_head(boom: Boom) -> Boom:
    collared = replace(boom.segments[0], collars=(Collar((7.7, 8.0), 0.008),))
    return replace(boom, segments=(collared, boom.segments[1]))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("case", "change"),
    [
        (
            Case(
                u_section(0.50, 0.34, 0.15, 3, top=0.008, bottom=0.006, web=0.006),
                u_section(0.44, 0.28, 0.12, 3, top=0.006, bottom=0.005, web=0.005),
                Pad(0.2, 0.04, bears="corner"),
            ),
            lambda boom: boom,
        ),
        (HEXAGONS, taper_inner),
        (HEXAGONS, with_collar_at_head),
    ],
    ids=["folded bottom", "taper", "collar"],
)
def test_other_sections_distort_as_their_shells(case: Case, change: Callable[[Boom], Boom]) -> None:
    """Reference: other code, a shell. Rigid sections make the tip at least a quarter too stiff."""
    boom = change(case.boom)
    shell, beam = of_shell(boom, 0.1), of_beam(boom)
    assert beam.stations == pytest.approx(shell.stations, rel=0.08)
    assert beam.tip == pytest.approx(shell.tip, rel=0.03)
    assert abs(of_beam(boom, 0.0).tip) < 0.75 * abs(shell.tip)


@pytest.mark.slow
def test_a_box_racks_under_forces_on_single_corners_as_its_shell() -> None:
    """Reference: other code, a shell. Equal forces on both corners of a side rack no box."""
    boom = touching(boom_in_space(), LAW, LATERAL_LAW)
    elements = finite_element_segments(boom, 0.25, "timoshenko", True)
    shell = shell_of(boom, 0.15)
    contacts = slice(len(shell.laws))
    residual = residual_compliance(gap_system(boom, elements, EACH_SIDE), shell)
    expected = np.diag(residual[contacts, contacts])
    assert np.diag(contact_compliance(boom)) == pytest.approx(expected, rel=0.06)
    closed = station_compliance(boom, np.full(len(expected), 1e9))
    pads = len(expected) / len(closed.places)
    np.testing.assert_allclose(
        closed.compliance, 1e-9 / pads * np.eye(len(closed.places)), atol=1e-15
    )

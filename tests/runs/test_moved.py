# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a model has gone through, beside what it is at rest."""

from pathlib import Path

import numpy as np
import pytest

from beam_model.finite_element import finite_element_segments
from beam_model.lines import lines
from beam_model.segment_model import gap_system
from dynamics.excitation import Step
from geometry.axial import Thrust, with_compression
from geometry.boom import Boom, Load, Material, Segment, Support
from geometry.profiles import hexagon
from geometry.section import BoxSection
from runs.pipeline.design_results import ModelDesignResults
from runs.pipeline.section_forces import section_forces
from runs.pipeline.strength import Fibres, outer_corners
from tests.runs.case_texts import read_case
from tests.runs.summaries import answers_of

CASE = """
title = "A cantilever, loaded suddenly"
time = {{ duration = 0.5, output_step = 1e-3 }}

[material]
youngs_modulus = 2.1e11
poissons_ratio = 0.3
density = 7850.0
yield_strength = 3e8

[[segment]]
name = "arm"
span = [0.0, 10.0]
supports = [{{ x = 0.0, kind = "clamped" }}]
section = {{ height = 0.40, width = 0.30, flange = 0.008, web = 0.006 }}
load = -1000.0

[[model]]
name = "one"
{model}
"""


# An arm of 6 m with another in it, in space.
SIDEWAYS = CASE.replace("[0.0, 10.0]", "[0.0, 6.0]").replace(
    "load = -1000.0",
    """load = -1000.0
lateral_load = 500.0

[[segment]]
name = "inner"
span = [5.0, 10.0]
section = {{ height = 0.35, width = 0.26, flange = 0.008, web = 0.006 }}
load = -1000.0
lateral_load = 500.0

[[joint]]
outer = "arm"
inner = "inner"
stations = ["tail", "head"]
play = 0.004
lateral_play = 0.004
stiffness = 1e8
exponent = 1.0
""",
)


def answers(model: str, folder: Path, case: str = CASE) -> ModelDesignResults:
    return answers_of(read_case(folder, case.format(model=model))).models["one"]


def test_sudden_load_doubles_the_static_results(tmp_path: Path) -> None:
    """Reference: analytic. A boom of one coordinate swings around its rest from zero: everything
    is twice what it is at rest, at half a period, which the output step meets within 1e-5.
    """
    series = 'kind = "kantorovich"\nterms = [1]\nbase = "complete"'
    found = answers(series, tmp_path)
    assert found.motion is not None
    assert {peak.what for peak in found.motion.peaks} == {"deflection", "bending moment"}
    for peak in found.motion.peaks:
        assert peak.factor == pytest.approx(2.0, rel=2e-4)
        assert peak.time * found.modes[0].frequency % 1.0 == pytest.approx(0.5, abs=0.01)
    (fibre,) = found.motion.fibres
    assert fibre.at_rest is not None
    assert abs(fibre.stress) == pytest.approx(2.0 * fibre.at_rest, rel=2e-4)
    (envelope,) = found.motion.envelopes
    np.testing.assert_allclose(envelope.low["deflection"][-1], 2.0 * found.static[0].tip, rtol=2e-4)
    assert envelope.high["deflection"][-1] == pytest.approx(0.0, abs=1e-12)


def test_stress_and_reactions_at_rest_are_those_of_hand(tmp_path: Path) -> None:
    """Reference: by hand. 1000 N/m on 10 m: 10 kN and 50 kN m at the wall, σ = M c/J with
    c = (0.40 + 0.008)/2 m.
    """
    beam = 'kind = "finite-element"\ntheory = "timoshenko"\nelement_length = 0.25'
    found = answers(beam, tmp_path)
    assert found.motion is not None
    still = {peak.what: peak.at_rest for peak in found.motion.peaks}
    assert still["reaction"] == pytest.approx(1e4, rel=1e-6)
    assert still["moment at the support"] == pytest.approx(5e4, rel=1e-3)
    assert still["bending moment"] == pytest.approx(5e4, rel=2e-4)
    box = BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
    (fibre,) = found.motion.fibres
    assert fibre.at_rest == pytest.approx(5e4 * 0.204 / box.second_moment_of_area, rel=2e-4)
    assert (fibre.x, abs(fibre.z)) == (0.0, pytest.approx(0.204))
    assert fibre.utilisation == pytest.approx(abs(fibre.stress) / 3e8)
    assert found.motion.walls == []


def test_lateral_reactions_are_reported(tmp_path: Path) -> None:
    """Reference: by hand. On 6 and 5 m 1000 N/m across and 500 N/m from the side: 11 and 5.5 kN,
    1000 (6 · 3 + 5 · 7.5) N m and half of that at the wall, no torque.
    """
    beam = 'kind = "finite-element"\ntheory = "timoshenko"\nelement_length = 0.25'
    found = answers(beam, tmp_path, SIDEWAYS)
    assert found.motion is not None
    wall = {p.what: p.at_rest for p in found.motion.peaks if "arm" in p.where}
    assert wall["reaction"] == pytest.approx(1.1e4, rel=1e-6)
    assert wall["lateral reaction"] == pytest.approx(5.5e3, rel=1e-6)
    assert wall["moment at the support"] == pytest.approx(5.55e4, rel=1e-3)
    assert wall["lateral moment at the support"] == pytest.approx(2.775e4, rel=1e-3)
    assert wall["lateral bending moment"] == pytest.approx(2.775e4, rel=1e-3)
    assert wall["torque at the support"] == pytest.approx(0.0, abs=1e-3)


def test_outer_corners_lie_on_the_outer_surfaces() -> None:
    """Reference: by hand. Half a thickness beyond the mid-lines of a box; of a hexagon no more
    than that.
    """
    y, z = outer_corners(BoxSection(height=0.4, width=0.3, flange=0.008, web=0.006))
    np.testing.assert_allclose(np.abs(y), 0.153)
    np.testing.assert_allclose(np.abs(z), 0.204)
    six = hexagon(0.4, 0.3, flat=0.2, top=0.006, bottom=0.006, web=0.006)
    y, z = outer_corners(six)
    assert np.abs(z).max() == pytest.approx(0.203)
    assert 0.15 < np.abs(y).max() < 0.153


def test_fibres_of_a_taper_are_those_of_the_local_section() -> None:
    """Reference: by hand, −P/A and M z/J of boxes of 0.4, 0.3 and 0.2 m under 10 kN and 1 N."""
    tail, head = (BoxSection(height, 0.2, 0.01, 0.008) for height in (0.4, 0.2))
    steel = Material(2.1e11, 0.3, 7850.0)
    clamp = Support(0.0, "clamped")
    arm = Segment.of_section("arm", 0.0, 8.0, steel, tail, head_section=head, supports=(clamp,))
    (arm,) = with_compression([arm], [], [Thrust(0, 8.0, 1e4)])
    boom = Boom((arm,), (), (Load(0, "z", -1.0, 8.0, Step()),))
    models = finite_element_segments(boom, 0.5, "euler-bernoulli", rotary_inertia=False)
    system = gap_system(boom, models).gather_loads()
    (line,) = lines(boom, models)
    fibres = Fibres.of(arm, line)
    assert fibres is not None
    state = system.static_response(system.load)
    for x, height in ((4.0, 0.3), (2.0, 0.35)):
        box, at = BoxSection(height, 0.2, 0.01, 0.008), int(np.argmax(line.x == x))
        assert fibres.of_normal[at] == pytest.approx(1.0 / box.area, rel=1e-12)
        top = int(fibres.z[:, at].argmax())
        assert fibres.z[top, at] == pytest.approx(0.5 * height + 0.005, rel=1e-12)
        bending = (8.0 - x) * (0.5 * height + 0.005) / box.second_moment_of_area
        forces = section_forces(boom, 0, line, state, np.zeros(()))
        found = fibres.stress(top, forces)[at] + 1e4 / box.area
        # Second order adds to the moment of the load.
        assert found == pytest.approx(bending, rel=0.02)

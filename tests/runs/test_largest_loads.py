# SPDX-License-Identifier: LGPL-3.0-or-later
"""Loads of a case, and statics, stresses and utilisations of the boom under them."""

from pathlib import Path

import pytest

from runs.case.build import build_boom
from runs.case.checked_case import CheckedCase
from runs.case.conversion import convert_to_si
from runs.check import print_check
from runs.pipeline.largest_loads import (
    StaticBeam,
    StaticExtreme,
    overload_cautions,
    static_table,
)
from runs.pipeline.load_table import load_table
from runs.pipeline.statics import boom_with_play
from tests.runs.case_texts import box, joint, read_case
from tests.runs.summaries import printed

# Depth of outer fibres and second moment of area of the boxes below.
ARM, FLY = (0.40, 0.30, 0.008, 0.006), (0.36, 0.26, 0.006, 0.005)
PAD = "pad = { length = 0.2, width = 0.05, allowable_pressure = 1e6 }"
RAMP = '[[load]]\nsegment = "fly"\nx = "head"\nmagnitude = -2000.0\nramp = 0.1\n'
SINE = '[[load]]\nsegment = "arm"\nx = 6.0\nmagnitude = 500.0\nfrequency = 2.0\n'


def boom_of(loads: str, of_joint: str = PAD, more: str = "") -> str:
    """Return a case of two boxes with pads, clamped at the base."""
    held = 'supports = [{ x = 0.0, kind = "clamped" }]'
    return (
        'title = "Two boxes"\n[time]\nduration = 1.0\n'
        "[material]\nyoungs_modulus = 2.1e11\npoissons_ratio = 0.3\ndensity = 7850.0\n"
        "yield_strength = 3e8\n"
        + box("arm", (0.0, 8.0), ARM, held)
        + box("fly", (6.0, 14.0), FLY)
        + joint("fly", "arm", 0.004, (6.0, 8.0), of_joint)
        + loads
        + '\n[[model]]\nname = "beam"\nkind = "finite-element"\ntheory = "timoshenko"\n'
        + more
    )


def extremes_of(folder: Path, text: str) -> dict[str, StaticExtreme]:
    case = read_case(folder, text)
    found = StaticBeam.of(case, boom_with_play(case, build_boom(case))).extremes(case.system)
    return {one.what: one for one in found}


def test_stresses_and_pads_under_a_ramp(tmp_path: Path) -> None:
    """Reference: analytic, lever rule between the middles of pads and M z/J of the boxes."""
    case = read_case(tmp_path, boom_of(RAMP))
    found = extremes_of(tmp_path, boom_of(RAMP))
    assert [*found] == [
        "tip", "stress, arm at 0 m", "stress, fly at 7.9 m", "pad at 6 m",
        "pad at 8 m",
    ]  # fmt: skip
    for segment, sizes, lever in zip(
        build_boom(case).segments, (ARM, FLY), (14.0, 6.1), strict=True
    ):
        one = next(one for what, one in found.items() if segment.name in what)
        fibre = 0.5 * (sizes[0] + sizes[2])
        stress = 2000.0 * lever * fibre / segment.second_moment_of_area
        assert one.largest == pytest.approx(stress, rel=1e-6)
        assert one.utilisation is not None
        assert one.utilisation.value == pytest.approx(stress / 3e8, rel=1e-6)
        assert (one.initial, one.time) == (pytest.approx(0.0, abs=1.0), 0.1)
    for x, lever in ((6, 6.1), (8, 7.9)):
        one = found[f"pad at {x} m"]
        # Two pads of 0.2 m x 0.05 m share the force of a side.
        pressure = 0.5 * 2000.0 * lever / 1.8 / 0.01
        assert one.largest == pytest.approx(pressure, rel=1e-6)
        assert one.utilisation is not None
        assert one.utilisation.value == pytest.approx(pressure / 1e6, rel=1e-6)


def test_a_uniform_load_bends_between_nodes(tmp_path: Path) -> None:
    """Reference: analytic, q l²/2 at the clamp and at the head's pad."""
    loads = '[[load]]\nsegment = "fly"\nmagnitude = -300.0\n'
    found = extremes_of(tmp_path, boom_of(loads))
    (segment,) = (one for one in build_boom(read_case(tmp_path, boom_of(loads))).segments[1:])
    stress = 300.0 * 6.1**2 / 2.0 * 0.183 / segment.second_moment_of_area
    # Within the error q h²/12 of elements of 0.4 m.
    assert found["stress, fly at 7.9 m"].largest == pytest.approx(stress, rel=1e-3)


def test_largest_values_of_a_sine_and_a_ramp(tmp_path: Path) -> None:
    """Reference: analytic. The sine is largest at a quarter of its period and pulls the arm back
    at three quarters, where the moments of both loads add up.
    """
    found = extremes_of(tmp_path, boom_of(RAMP + SINE))
    arm = found["stress, arm at 0 m"]
    inertia = build_boom(read_case(tmp_path, boom_of(RAMP))).segments[0].second_moment_of_area
    assert arm.time == pytest.approx(0.375)
    moment = 2000.0 * 14.0 + 500.0 * 6.0
    assert arm.largest == pytest.approx(moment * 0.204 / inertia, rel=1e-6)


def test_overloads_are_cautions(tmp_path: Path) -> None:
    """Reference: exact messages, with pressures of the lever rule over 0.1 MPa."""
    text = boom_of(RAMP.replace("ramp = 0.1\n", ""), PAD.replace("1e6", "1e5"))
    found = [*extremes_of(tmp_path, text).values()]
    far = StaticExtreme("tip", "tip", "m", -0.1, -1.4, 0.25)
    boom = build_boom(read_case(tmp_path, text))
    assert overload_cautions([far, *found[1:]], boom) == [
        "caution: under the loads of t = 0.25 s the tip rests at -1.4 m, "
        f"{140.0 / boom.length:.2g} % of the boom's length and more than 5 %: small displacements "
        "do not hold; check units and loads",
        "caution: at rest under the loads of t = 0 s the utilisation is 339 % at pad, fly segment, "
        "x = 6 m: exceeds the allowable pressure",
        "caution: at rest under the loads of t = 0 s the utilisation is 439 % at pad, fly segment, "
        "x = 8 m: exceeds the allowable pressure",
    ]


def test_loads_are_listed_with_their_largest_values(tmp_path: Path) -> None:
    """Reference: the numbers of the case; the weight of its masses by hand."""
    loads = (
        RAMP + SINE + '[[load]]\nsegment = "fly"\nfrom = 7.0\nto = 9.0\nmagnitude = -100.0\n'
        "table = [[0.0, 0.0], [0.5, -2.0], [1.5, 9.0]]\n"
        '[[load]]\nsegment = "fly"\nx = 9.0\nmagnitude = 50.0\nmoment = true\nreleased = true\n'
        "[payload]\nmass = 100.0\n[gravity]\nangle = 30.0\n"
        "[[base]]\nacceleration = 0.5\nramp = 2.0\n[[axial]]\nforce = 3e3\n"
    )
    case = read_case(tmp_path, boom_of(loads).replace("supports", "load = -20.0\nsupports"))
    boom = build_boom(case)
    mass = (
        7850.0 * 8.0 * (2.0 * (0.30 * 0.008 + 0.40 * 0.006 + 0.26 * 0.006 + 0.36 * 0.005)) + 100.0
    )
    weight = 9.80665 * mass
    assert load_table(case, boom).rows == [
        ("gravity", "all masses", "z", "constant", f"−{weight * 0.75**0.5:.0f} N", ""),
        ("gravity", "all masses", "to the base", "constant", f"{0.5 * weight:.0f} N", ""),
        ("segment[1].load", "arm", "z", "constant", "−20 N/m", ""),
        ("load[1]", "fly at 14 m", "z", "ramp of 0.1 s", "−2000 N", "0.1"),
        ("load[2]", "arm at 6 m", "z", "sine of 2 Hz", "500 N", "0.125"),
        ("load[3]", "fly, 7–9 m", "z", "3 values", "−350 N/m", "1"),
        ("load[4]", "fly at 9 m", "z, moment", "until t = 0", "50 N m", ""),
        ("base[1]", "all masses", "z", "ramp of 2 s", "0.25 m/s²", "1"),
        ("axial[1]", "fly at 14 m", "to the base", "constant", "3000 N", ""),
    ]


def test_a_payload_weighs_alone_without_gravity(tmp_path: Path) -> None:
    """Reference: by hand, 100 kg times 9.80665 m/s²."""
    case = read_case(tmp_path, boom_of("[payload]\nmass = 100.0\n"))
    row = ("payload", "fly at 14 m", "z", "constant", "−980.7 N", "")
    assert load_table(case, build_boom(case)).rows == [row]


def test_tables_are_in_the_units_of_the_case(tmp_path: Path) -> None:
    """Reference: the same boom in SI units."""
    case = convert_to_si(
        read_case(tmp_path, boom_of(RAMP)).model_copy(update={"shown_units": "mm-t-s"})
    )
    boom = boom_with_play(case, build_boom(case))
    assert load_table(case, boom).rows == [
        ("load[1]", "fly at 14000 mm", "z", "ramp of 0.1 s", "−2000 N", "0.1")
    ]
    table = static_table(case, boom, StaticBeam.of(case, boom).extremes(case.system))
    rows = {row[0]: row for row in table.rows}
    assert rows["pad at 6000 mm"][1:] == ("0 MPa", "0.339 MPa", "0.1", "33.9")
    assert rows["tip"][2].endswith(" mm")


def test_statics_name_their_model_and_fit_a_terminal(tmp_path: Path) -> None:
    """Reference: exact text at 80 columns."""
    text = boom_of(RAMP + SINE)
    shown = printed(print_check, CheckedCase(read_case(tmp_path, text)), width=80)
    assert max(map(len, shown.splitlines())) <= 80
    assert "time of   utilisation" in shown
    assert "Static results at t = 0 and under the maximum loads" in shown
    assert (
        "Estimate by a Timoshenko beam, with the compliance of walls under pads.\n"
        "Stresses are outer-fibre stresses. Contact forces act on the outer segment, \n"
        "upwards where positive."
    ) in shown

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wrong objects as arguments from Python: one line that names the argument."""

from collections.abc import Callable
from typing import Any

import pytest

import protractile as pt

STEEL = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
BOX = pt.BoxSection(height=0.4, width=0.3, flange=0.01, web=0.01)
ARM = pt.Segment.of_section("arm", 0.0, 8.0, STEEL, BOX, supports=(pt.Support(0.0, "clamped"),))
BOOM = pt.Boom([ARM])
HEXAGON = {"height": 0.36, "width": 0.26, "top": 0.006, "bottom": 0.006, "web": 0.006}
COARSE = pt.load_case(pt.CASES / "coarse.toml")
NO_CASE = "case: case: must be a Case, such as load_case returns, got {!r}"
NO_NAMES = "case: models: must be a list of names, got 'beam'"


def stop_of(segment: Any) -> pt.Boom:
    law = pt.PowerContact(1e6, exponent=1.0)
    return pt.Boom([ARM], stops=[pt.Stop(segment, 8.0, play=0.1, contact=law)])


@pytest.mark.parametrize("other", ["x", None])
@pytest.mark.parametrize("call", [pt.change, pt.check, pt.run_case, pt.frequencies])
def test_a_case_is_needed(call: Callable[[Any], object], other: object) -> None:
    """Reference: exact words."""
    with pytest.raises(pt.BadInput) as error:
        call(other)
    assert str(error.value) == NO_CASE.format(other)


@pytest.mark.parametrize(
    ("call", "line"),
    [
        (lambda: pt.sweep("x", {"time.duration": [1.0]}), NO_CASE.format("x")),
        (lambda: pt.sweep(COARSE, {"time.duration": [1.0]}, "beam"), NO_NAMES),
        (lambda: pt.sweep(COARSE, "time.duration=1"),
         "case: vary: must be a dictionary of keys and lists of numbers, got 'time.duration=1'"),
        (lambda: pt.run_case(COARSE, "beam"), NO_NAMES),
        (lambda: pt.frequencies(COARSE, models="beam"), NO_NAMES),
        (lambda: pt.load_case(None),
         "case: source: must be a path or a dictionary, got None"),
        (lambda: pt.tables("x"), "results: results: must be Results, got 'x'"),
        (lambda: pt.Boom(None), "segments: must be a list or a tuple, got None"),
        (lambda: pt.Boom([ARM], joints="arm"), "joints: must be a list or a tuple, got 'arm'"),
        (lambda: stop_of(3), "stops[0].segment: 3 is no segment; give 'arm'"),
        (lambda: stop_of(None), "stops[0].segment: None is no segment; give 'arm'"),
        (lambda: pt.Segment.of_section("arm", 0.0, 8.0, "steel", BOX),
         "Segment.material: must be a Material, got 'steel'"),
        (lambda: pt.Segment.of_section("arm", 0.0, 8.0, STEEL, None),
         "Segment.section: must be a section such as a BoxSection, got None"),
        (lambda: pt.hexagon(flat="0.1", **HEXAGON),
         "hexagon.flat: must be a finite number, got '0.1'"),
        (lambda: pt.octagon(chamfer=None, **HEXAGON),
         "octagon.chamfer: must be a finite number, got None"),
        (lambda: pt.u_section(radius="r", facets=3, **HEXAGON),
         "u_section.radius: must be a finite number, got 'r'"),
        (lambda: pt.closed_polygon(None, [0.01]), "corners must be a sequence, got None"),
        (lambda: pt.BoxSection(None, 0.3, 0.01, 0.01),
         "height must be a positive number of m, got None"),
        (lambda: pt.with_weight("x"), "with_weight.boom: must be a Boom, got 'x'"),
        (lambda: pt.with_weight(BOOM, angle=[30.0]),
         "with_weight.angle: must be a finite number, got [30.0]"),
        (lambda: pt.with_weight(BOOM, acceleration=-1.0),
         "GravityTable.acceleration: must be a number not less than 0, got -1.0"),
        (lambda: pt.Ramp("1"), "duration must be finite and positive, got 1 s"),
        (lambda: pt.PiecewiseLinear(None, [1.0]),
         "times and values must be finite numbers in two sequences"),
        (lambda: pt.TableContact("x", (1.0,)),
         "depths and forces must be sequences of finite numbers"),
    ],
)  # fmt: skip
def test_another_object_is_refused(call: Callable[[], object], line: str) -> None:
    """Reference: exact words."""
    with pytest.raises((pt.BadInput, ValueError)) as error:
        call()
    assert str(error.value) == line


@pytest.mark.parametrize(
    ("change", "line"),
    [
        ({"name": ()}, r"the motion has no output \(\); it has tip, "),
        ({"name": "mast"}, "the motion has no output 'mast'; it has tip, "),
        ({"other": None}, "other must be a Trajectory, got None"),
        ({"until": "end"}, "until must be after the first time, got 'end' s"),
    ],
)
def test_motions_are_compared_by_an_output(change: dict[str, Any], line: str) -> None:
    """Reference: exact words."""
    motion = pt.BeamElements(BOOM).simulate(0.01)
    with pytest.raises(ValueError, match=line):
        motion.compare(**{"other": motion, **change})

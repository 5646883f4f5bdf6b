# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments by length at extensions of their joints, with all attached parts."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from protractile.cases import change
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.sweep.points import plan
from tests.beam_model.exact import bonded_frequencies
from tests.runs.case_texts import COARSE, STEEL, box, edited, elements, read_case, refusal, table
from tests.system.run_folder import protractile

LAW = {"stations": ["tail", "head"], "play": 0.006, "stiffness": 1e9, "exponent": 1.0}
HEAD = ["tail", {"head": 0.1}]
CRANE = f"""
title = "A boom of three"
time = {{ duration = 0.1 }}
start = {{ velocity = {{ fly = {{ turn = 0.01, x = "tail" }} }} }}
{STEEL}
{box("base", 10.0, (0.50, 0.32, 0.008, 0.006))}
supports = ["tail", {{ x = {{ tail = 2.0 }}, stiffness = 1e8 }}]
collars = [{{ span = [{{ head = 0.5 }}, "head"], thickness = 0.01 }}]
{box("middle", 9.5, (0.46, 0.28, 0.006, 0.005), "load = -500.0")}
masses = [{{ x = {{ head = 0.25 }}, mass = 40.0 }}]
{box("fly", 9.0, (0.42, 0.25, 0.005, 0.004), "load = -300.0")}
{table("[[joint]]", outer="base", inner="middle", extension=8.0, **LAW | {"stations": HEAD})}
{table("[[joint]]", outer="middle", inner="fly", extension=7.5, **LAW)}
{table("[[load]]", segment="fly", **{"from": {"head": 4.0}}, to="head", magnitude=-100.0)}
{table("[[load]]", segment="fly", x="head", magnitude=-2000.0)}
{table("[[stop]]", segment="middle", x={"tail": 1.0}, play=0.5, stiffness=1e7)}
{table("[[observe]]", name="seat", segment="fly", x={"head": 1.0})}
{elements("beam")}
"""

PAPER = (
    COARSE.replace("span = [0.0, 10.0]", "length = 10.0")
    .replace("span = [9.0, 19.0]", "length = 10.0")
    .replace("stations = [9.0, 10.0]", 'stations = ["tail", "head"]\nextension = 9.0')
)

# The same, its numbers worked out by hand: the ends of base, middle and fly are 10, 18 and 25.5 m.
BY_HAND = (
    ("length = 10.0", "span = [0.0, 10.0]"), ('["tail", { x = { tail = 2.0 }', "[0.0, { x = 2.0"),
    ('[{ head = 0.5 }, "head"]', "[9.5, 10.0]"), ("length = 9.5", "span = [8.5, 18.0]"),
    ("{ head = 0.25 }", "17.75"), ("length = 9.0", "span = [16.5, 25.5]"),
    ("extension = 8.0\n", ""), ("extension = 7.5\n", ""),
    ('["tail", { head = 0.1 }]', "[8.5, 9.9]"), ('["tail", "head"]', "[16.5, 18.0]"),
    ('x = "head"', "x = 25.5"), ("{ head = 4.0 }", "21.5"), ('to = "head"', "to = 25.5"),
    ("{ tail = 1.0 }", "9.5"), ("{ head = 1.0 }", "24.5"), ('x = "tail"', "x = 16.5"),
)  # fmt: skip


pytestmark = pytest.mark.usefixtures("here")


case_of = partial(read_case, Path())


def test_a_boom_by_lengths_is_the_same_boom_also_when_it_is_written() -> None:
    """Reference: the boom with positions by hand, to the last bit."""
    case = case_of(CRANE)
    assert build_boom(case) == build_boom(case_of(edited(CRANE, *BY_HAND)))
    assert case_of(toml.dumps(case)) == case


@pytest.mark.parametrize(("extension", "tip"), [(1.0, 12.0), (4.0, 18.0), (8.5, 27.0)])
def test_one_key_draws_all_segments_out(extension: float, tip: float) -> None:
    """Reference: analytic, lengths, extensions and overlaps. Distances from ends stay constant."""
    boom = build_boom(change(case_of(CRANE), **{"joint.extension": extension}))
    base, middle, fly = boom.segments
    assert boom.tip == pytest.approx(tip, rel=1e-15)
    assert [boom.overlap(joint) for joint in boom.joints] == [
        pytest.approx((middle.start, 10.0)), pytest.approx((fly.start, middle.end))
    ]  # fmt: skip
    assert 10.0 - middle.start == pytest.approx(9.5 - extension)
    assert middle.end - fly.start == pytest.approx(9.0 - extension)
    assert boom.joints[0].stations == pytest.approx((middle.start, 9.9))
    assert middle.end - middle.masses[0].x == pytest.approx(0.25)
    assert boom.observations[0].x == pytest.approx(tip - 1.0)
    assert base.start == 0.0


@pytest.mark.parametrize(
    ("relative", "wrong", "line"),
    [
        ("length = 9.5", "length = 9.5\nspan = [8.5, 18.0]",
         "segment[2].length: span is given; leave one of them out"),
        ("length = 9.5", "",
         "segment[2].span: missing; it is the x of its two ends in m, in ascending order; or give "
         "length"),
        ("length = 9.5", "span = [8.5, 18.0]",
         "joint[1].extension: 'middle' has a span, which says how far it is out; give it by its "
         "length, or leave extension out"),
        ("extension = 7.5\n", "",
         "segment[3].length: nothing says where 'fly' is; give an extension to the joint in which "
         "it slides, or a span to the segment"),
        ("length = 9.5", "length = 19.0",
         "joint[1].extension: must be at least 9 m and below 19 m, so that 'middle' begins in "
         "'base', got 8 m"),
        ('inner = "fly"', 'inner = "middle"',
         "joint[2].inner: must be another segment than the outer one"),
        ('outer = "base"\ninner = "middle"', 'outer = "base"\ninner = "fly"',
         "joint[2].extension: 'fly' has its place by joint[1].extension; leave one of them out"),
        ('["tail", { head = 0.1 }]', '["tail", { head = 1.6 }]',
         "joint[1].stations: 8.4 m lies outside the overlap of 'base' and 'middle'; it must be "
         "between 8.5 and 10 m"),
    ],
)  # fmt: skip
def test_a_contradiction_is_one_line(relative: str, wrong: str, line: str) -> None:
    assert refusal(Path(), edited(CRANE, (relative, wrong))) == line


def test_frequencies_over_the_extension_are_one_command() -> None:
    """Reference: analytic, frequencies of the bonded boom, which play does not increase."""
    case_of(PAPER)
    command = "frequencies", "case.toml", "--vary", "joint.extension=5:9:3", "--out", "out"
    assert protractile(*command, "--models", "beam-fe,beam-fe-bonded") == 0
    assert {path.name for path in Path("out").glob("freq*")} == {
        "frequencies.csv", "frequencies.nc"
    }  # fmt: skip
    with xr.open_dataset("out/frequencies.nc", engine="scipy") as data:
        found = data["frequency"].load()
    for point in plan("case.toml", ["joint.extension=5:9:3"], None, None).points:
        there = found.sel({"joint.extension": point.values[0]})
        exact = bonded_frequencies(build_boom(point.case), 50.0)[:3]
        for model in ("beam-fe", "beam-fe-bonded"):
            assert there.sel(joints="bonded", model=model).values == pytest.approx(exact, rel=1e-4)
        pressed = there.sel(joints="in contact")
        assert (pressed.sel(model="beam-fe") < there.sel(joints="bonded", model="beam-fe")).all()
        assert pressed.sel(model="beam-fe-bonded").isnull().all()
    assert (np.diff(found.sel(mode=1, joints="bonded").values, axis=0) < 0.0).all()

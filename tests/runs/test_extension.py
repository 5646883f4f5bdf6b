# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments by length, shapes of sections, and booms without loads."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from protractile.cases import change
from protractile.geometry.boom import Boom, Collar, Diaphragm, Segment
from protractile.geometry.box import BoxSection
from protractile.geometry.profiles import hexagon, octagon, u_section
from protractile.geometry.section import Section
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import load
from protractile.runs.pipeline.models import build
from protractile.runs.sweep.points import plan
from tests.beam_model.exact import bonded_frequencies
from tests.runs.case_texts import (
    COARSE,
    STEEL,
    box,
    edited,
    elements,
    read_case,
    refusal,
    refused,
    table,
)
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


# The two segments' numbers as beams.
GIVEN = (
    "mass_per_length = 83.16\nsecond_moment_of_area = 3.7986e-4\nrotary_inertia = 3.48\n"
    "height_to_width = 1.5\n",
    "mass_per_length = 55.07\nsecond_moment_of_area = 2.1829e-4\nrotary_inertia = 1.68\n",
)
BOXES = (
    "{ height = 0.50, width = 0.32, flange = 0.008, web = 0.006 }",
    "{ height = 0.46, width = 0.28, flange = 0.006, web = 0.005 }",
)


def written(sections: Sequence[str]) -> str:
    edits = [(g, f"section = {s}\n") for g, s in zip(GIVEN, sections, strict=True)]
    Path("case.toml").write_text(edited(COARSE, *edits), encoding="utf-8")
    return "case.toml"


def polygon(height: float, width: float, walls: Sequence[float]) -> str:
    corners = [[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]]
    return f"{{ shape = 'polygon', corners = {corners}, thicknesses = {list(walls)} }}"


def boom_of(sections: Sequence[str]) -> Boom:
    return build_boom(load(written(sections)))


@pytest.mark.parametrize(
    ("table", "section"),
    [
        ("{ shape = 'hexagon', height = 0.6, width = 0.5, flat = 0.3, top = 0.008, bottom = 0.007, "
         "web = 0.006 }", hexagon(0.6, 0.5, 0.3, 0.008, 0.007, 0.006)),
        ("{ shape = 'octagon', height = 0.6, width = 0.5, chamfer = 0.08, top = 0.008, bottom = "
         "0.007, web = 0.006 }", octagon(0.6, 0.5, 0.08, 0.008, 0.007, 0.006)),
        ("{ shape = 'U', height = 0.6, width = 0.5, radius = 0.1, top = 0.008, bottom = 0.007, web "
         "= 0.006 }", u_section(0.6, 0.5, 0.1, 3, 0.008, 0.007, 0.006)),
        ("{ shape = 'U', height = 0.6, width = 0.5, radius = 0.1, facets = 1, top = 0.008, bottom "
         "= 0.007, web = 0.006 }", u_section(0.6, 0.5, 0.1, 1, 0.008, 0.007, 0.006)),
        (polygon(0.6, 0.5, (0.01, 0.006, 0.008, 0.006)),
         BoxSection(0.6, 0.5, 0.008, 0.006, bottom_flange=0.01)),
    ],
    ids=["hexagon", "octagon", "U", "U with one facet", "polygon"],
)  # fmt: skip
def test_a_table_is_its_section(table: str, section: Section) -> None:
    """Reference: other code, the section made in Python."""
    outer, _ = boom_of([table, BOXES[1]]).segments
    assert outer.section == section
    assert outer.mass_per_length == 7850.0 * section.area
    assert outer.second_moment_of_area == section.second_moment_of_area


def _numbers(name: str) -> dict[str, np.ndarray]:
    case = load("case.toml")
    (model,) = (model for model in case.models if model.name == name)
    system = build(case, build_boom(case), model).system
    return {
        "omega2": system.omega2, "load": np.abs(system.load), "rows": np.abs(system.rows),
        "tip": np.abs(system.observers["tip"].row),
    }  # fmt: skip


@pytest.mark.parametrize("name", ["kantorovich-5", "timoshenko"])
def test_a_box_written_as_a_polygon_has_the_numbers_of_the_box(name: str) -> None:
    """Reference: other code, the box's formulas."""
    written(BOXES)
    box = _numbers(name)
    outer, inner = 2 * (0.008, 0.006), 2 * (0.006, 0.005)
    written([polygon(0.50, 0.32, outer), polygon(0.46, 0.28, inner)])
    for key, found in _numbers(name).items():
        largest = np.abs(box[key]).max()
        assert found == pytest.approx(box[key], rel=1e-9, abs=1e-9 * largest), key


def test_check_prints_it(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: analytic. A hole of 0.492 x 0.314 m around an outside of 0.466 x 0.285 m."""
    table = (
        "{ shape = 'octagon', height = 0.5, width = 0.32, chamfer = 0.004, top = 0.008, "
        "bottom = 0.008, web = 0.006 }"
    )
    assert protractile("check", "--all", written([table, BOXES[1]])) == 0
    shown = capsys.readouterr().out
    for part in ("500 × 320", "t 8 / 6", "26.0 in height", "29.0 in width"):
        assert part in shown


def _tapering(head: str, own: str = "", inner: str = BOXES[1]) -> str:
    outer = "{ height = 0.6, width = 0.5, flange = 0.008, web = 0.006 }"
    return written([f"{outer}\nhead_section = {head}{own}", inner])


def test_a_segment_tapers_to_its_head() -> None:
    """Reference: other code, the segment made in Python of both sections."""
    case = load(_tapering("{ height = 0.52, width = 0.45, flange = 0.006, web = 0.006 }"))
    outer, _ = build_boom(case).segments
    tail, head = BoxSection(0.6, 0.5, 0.008, 0.006), BoxSection(0.52, 0.45, 0.006, 0.006)
    made = Segment.of_section(
        "outer", outer.start, outer.end, outer.material, tail, head_section=head
    )
    assert (outer.section, outer.head_section) == (tail, head)
    assert outer.mass_per_length == pytest.approx(made.mass_per_length, rel=1e-12)
    assert outer.second_moment_of_area == made.second_moment_of_area
    assert outer.section_at(outer.end).size("z") == pytest.approx(0.52, rel=1e-12)


@pytest.mark.parametrize(
    ("head", "own", "message"),
    [
        ("{ shape = 'octagon', height = 0.5, width = 0.3, chamfer = 0.1, top = 0.01, bottom = "
         "0.01, web = 0.01 }", "", "segment[1].head_section: has other shapes than the one at the "
         "tail; a segment tapers between sections of one kind"),
        ("{ height = 0.52, width = 0.45, flange = 0.006, web = 0.006 }",
         "\ntorsion_constant = 1e-3", "segment[1].torsion_constant: of a segment that tapers it "
         "follows from the sections; leave it out"),
    ],
)  # fmt: skip
def test_no_other_head_is_one(head: str, own: str, message: str) -> None:
    """Reference: exact message."""
    with refused(f"case.toml: {message}"):
        load(_tapering(head, own))


STIFFENED = COARSE.replace(
    "supports = [0.0, 2.0]",
    "supports = [0.0, 2.0]\ncollars = [{ span = [9.7, 10.0], thickness = 0.01 }]\n"
    "diaphragms = [{ x = 0.0, thickness = 0.006 }]",
    1,
).replace("load = 55.07\n", "load = 55.07\ndiaphragms = [{ x = 9.0, thickness = 0.008 }]\n", 1)


@pytest.fixture
def stiffened(here: Path) -> str:
    Path("case.toml").write_text(STIFFENED, encoding="utf-8")
    return "case.toml"


def test_stiffeners_change_no_number_of_the_beams(stiffened: str) -> None:
    """Reference: the case without them."""
    outer, inner = build_boom(load(stiffened)).segments
    assert outer.collars == (Collar((9.7, 10.0), 0.01),)
    assert outer.diaphragms == (Diaphragm(0.0, 0.006),)
    assert (inner.collars, inner.diaphragms) == ((), (Diaphragm(9.0, 0.008),))
    Path("plain.toml").write_text(COARSE, encoding="utf-8")
    plain = build_boom(load("plain.toml")).segments
    assert (replace(outer, collars=(), diaphragms=()), replace(inner, diaphragms=())) == plain


def test_check_prints_them(stiffened: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: analytic masses, of 2 (0.4889 + 0.3259) x 0.3 x 0.01 m³ and of the outlines'."""
    assert protractile("check", "--all", stiffened) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["collar", "outer", "9.7–10", "10", "38.4"] in rows
    assert ["diaphragm", "outer", "0", "6", "7.5"] in rows
    assert ["diaphragm", "inner", "9", "8", "7.88"] in rows

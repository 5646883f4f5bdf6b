# SPDX-License-Identifier: LGPL-3.0-or-later
"""Segments by length, sections, weights, materials and axial forces of a case."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

import protractile as pt
from protractile.geometry.section import Section
from protractile.geometry.typography import number
from protractile.runs.case import toml
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import load
from protractile.runs.report.model_tables import buckling_table
from protractile.runs.sweep.points import plan
from tests.beam_model.exact import bonded_frequencies
from tests.runs.case_texts import (
    CLAMPED,
    COARSE,
    STEEL,
    box,
    edited,
    elements,
    joint,
    read_case,
    refusal,
    refused,
    table,
)
from tests.runs.summaries import printed_check
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


@pytest.mark.parametrize(("extension", "tip"), [(1.0, 12.0), (8.5, 27.0)])
def test_one_key_draws_all_segments_out(extension: float, tip: float) -> None:
    """Reference: analytic, lengths, extensions and overlaps. Distances from ends stay constant."""
    boom = build_boom(pt.change(case_of(CRANE), **{"joint.extension": extension}))
    _, middle, fly = boom.segments
    assert boom.tip == pytest.approx(tip, rel=1e-15)
    assert boom.overlap(boom.joints[1]) == pytest.approx((fly.start, middle.end))
    assert 10.0 - middle.start == pytest.approx(9.5 - extension)
    assert middle.end - fly.start == pytest.approx(9.0 - extension)
    assert boom.joints[0].stations == pytest.approx((middle.start, 9.9))
    assert middle.end - middle.masses[0].x == pytest.approx(0.25)
    assert boom.observations[0].x == pytest.approx(tip - 1.0)


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
         "length, or leave extension or stroke out"),
        ("extension = 8.0", "extension = 8.0\nstroke = 7.0",
         "joint[1].extension: stroke is given; leave one of them out"),
        ("extension = 7.5\n", "",
         "segment[3].length: nothing says where 'fly' is; give an extension to the joint in which "
         "it slides, or a span to the segment"),
        ('inner = "fly"', 'inner = "middle"',
         "joint[2].inner: must be another segment than the outer one"),
        ('outer = "base"\ninner = "middle"', 'outer = "base"\ninner = "fly"',
         "joint[2].extension: 'fly' has its place by joint[1].extension; leave one of them out"),
    ],
)  # fmt: skip
def test_a_contradiction_is_one_line(relative: str, wrong: str, line: str) -> None:
    assert refusal(Path(), edited(CRANE, (relative, wrong))) == line


def test_frequencies_over_the_extension_are_one_command() -> None:
    """Reference: analytic, frequencies of the bonded boom, which play does not increase."""
    case_of(PAPER)
    vary, models = "joint.extension=5:9:3", ["beam-fe", "beam-fe-bonded"]
    command = "frequencies", "case.toml", "--vary", vary, "--out", "out", "--models"
    assert protractile(*command, ",".join(models)) == 0
    assert Path("out/frequencies.csv").exists()
    with xr.open_dataset("out/frequencies.nc", engine="scipy") as data:
        found = data["frequency"].load()
    for point in plan("case.toml", [vary], None, None).points:
        there = found.sel({"joint.extension": point.values[0]})
        exact = bonded_frequencies(build_boom(point.case), 50.0)[:3]
        for model in models:
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


@pytest.mark.parametrize(
    ("table", "section"),
    [
        ("{ shape = 'hexagon', height = 0.6, width = 0.5, flat = 0.3, top = 0.008, bottom = 0.007, "
         "web = 0.006 }", pt.hexagon(0.6, 0.5, 0.3, 0.008, 0.007, 0.006)),
        ("{ shape = 'octagon', height = 0.6, width = 0.5, chamfer = 0.08, top = 0.008, bottom = "
         "0.007, web = 0.006 }", pt.octagon(0.6, 0.5, 0.08, 0.008, 0.007, 0.006)),
        ("{ shape = 'U', height = 0.6, width = 0.5, radius = 0.1, top = 0.008, bottom = 0.007, web "
         "= 0.006 }", pt.u_section(0.6, 0.5, 0.1, 3, 0.008, 0.007, 0.006)),
        (polygon(0.6, 0.5, (0.01, 0.006, 0.008, 0.006)),
         pt.BoxSection(0.6, 0.5, 0.008, 0.006, bottom_flange=0.01)),
    ],
    ids=["hexagon", "octagon", "U", "polygon"],
)  # fmt: skip
def test_a_table_is_its_section(table: str, section: Section) -> None:
    """Reference: other code, the section made in Python."""
    outer, _ = build_boom(load(written([table, BOXES[1]]))).segments
    assert outer.section == section
    assert outer.mass_per_length == 7850.0 * section.area
    assert outer.second_moment_of_area == section.second_moment_of_area
    assert outer.rotary_inertia == 7850.0 * section.second_moment_of_area


def _tapering(head: str, own: str = "") -> str:
    outer = "{ height = 0.6, width = 0.5, flange = 0.008, web = 0.006 }"
    return written([f"{outer}\nhead_section = {head}{own}", BOXES[1]])


def test_a_segment_tapers_to_its_head() -> None:
    """Reference: other code, the segment made in Python of both sections."""
    case = load(_tapering("{ height = 0.52, width = 0.45, flange = 0.006, web = 0.006 }"))
    outer, _ = build_boom(case).segments
    tail, head = pt.BoxSection(0.6, 0.5, 0.008, 0.006), pt.BoxSection(0.52, 0.45, 0.006, 0.006)
    made = pt.Segment.of_section(
        "outer", outer.start, outer.end, outer.material, tail, head_section=head
    )
    assert (outer.section, outer.head_section) == (tail, head)
    assert outer.mass_per_length == pytest.approx(made.mass_per_length, rel=1e-12)
    assert outer.second_moment_of_area == made.second_moment_of_area
    assert outer.section_at(outer.end).size("z") == pytest.approx(0.52, rel=1e-12)


def test_torsion_of_a_tapering_segment_follows_from_its_sections() -> None:
    """Reference: exact message."""
    head = "{ height = 0.52, width = 0.45, flange = 0.006, web = 0.006 }"
    line = "segment[1].torsion_constant: of a segment that tapers it follows from the sections"
    with refused(f"case.toml: {line}; leave it out"):
        load(_tapering(head, "\ntorsion_constant = 1e-3"))


STIFFENED = COARSE.replace(
    "supports = [0.0, 2.0]",
    "supports = [0.0, 2.0]\ncollars = [{ span = [9.7, 10.0], thickness = 0.01 }]\n"
    "diaphragms = [{ x = 0.0, thickness = 0.006 }]",
    1,
).replace("load = 55.07\n", "load = 55.07\ndiaphragms = [{ x = 9.0, thickness = 0.008 }]\n", 1)


def test_stiffeners_change_no_number_of_the_beams(capsys: pytest.CaptureFixture[str]) -> None:
    """Reference: the case without them; masses of 2 (0.4889 + 0.3259) x 0.3 x 0.01 m³ and so on."""
    outer, inner = build_boom(case_of(STIFFENED)).segments
    assert protractile("check", "--all", "case.toml") == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["collar", "outer", "9.7–10", "10", "38.4"] in rows
    assert ["diaphragm", "outer", "0", "6", "7.5"] in rows
    assert ["diaphragm", "inner", "9", "8", "7.88"] in rows
    plain = build_boom(case_of(COARSE)).segments
    assert (replace(outer, collars=(), diaphragms=()), replace(inner, diaphragms=())) == plain


MAST_AND_FLY = f"""
title = "Lift"
[time]
duration = 0.05
{STEEL}
{box("mast", (0.0, 8.0), (0.40, 0.30, 0.008, 0.006), CLAMPED)}
{box("fly", (6.0, 14.0), (0.36, 0.26, 0.006, 0.005))}
{joint("fly", "mast", 0.01, (6.0, 8.0))}
{table("[[load]]", segment="fly", x=14.0, magnitude=-600.0)}
{elements("beam", theory="euler-bernoulli")}
"""
BONDED = elements("bonded", theory="euler-bernoulli", bonded=True)
G, ROPE = 0.5 * 9.80665, "[rope]\nfalls = 2\n[payload]\nmass = "
FORCE = '[[axial]]\nforce = 5e3\nsegment = "fly"\nx = 10.0\n'
MAST = pt.BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
FLY = pt.BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005)
LIGHT, LIGHTER = 7850.0 * MAST.area, 7850.0 * FLY.area


@pytest.mark.parametrize(
    ("text", "of_mast", "of_fly"),
    [
        ("[gravity]\nangle = 30.0\n[payload]\nmass = 300.0\n",
         [G * (5.0 * LIGHT + 8.0 * LIGHTER + 300.0), G * LIGHT],
         [G * (7.0 * LIGHTER + 300.0), G * (LIGHTER + 300.0)]),
        # The carried weight over the number of falls presses from the tip to the base.
        (f"{ROPE}600.0\ngravity = 5.0\n", [1500.0, 0.0], [1500.0, 1500.0]),
        (f"{ROPE}100.0\n[gravity]\n", [100.0 * G, 0.0], [100.0 * G, 100.0 * G]),
        # A hoisted load hangs from the tip.
        ("[gravity]\nangle = 30.0\n[hoist]\nmass = 300.0\nstiffness = 1e6\nhanging = true\n",
         [G * (5.0 * LIGHT + 8.0 * LIGHTER + 300.0), G * LIGHT],
         [G * (7.0 * LIGHTER + 300.0), G * (LIGHTER + 300.0)]),
        # A force may act anywhere, and pass at a pin.
        (FORCE, [5e3, 0.0], [5e3, 0.0]),
        (f"locked_at = 8.0\n{FORCE}", [5e3, 5e3], [0.0, 0.0]),
    ],
)  # fmt: skip
def test_weights_ropes_and_forces_press_the_segments(
    tmp_path: Path, text: str, of_mast: list[float], of_fly: list[float]
) -> None:
    """Reference: analytic, outboard masses times g sin 30° = g/2, at 3, 7 and 7, 13 m."""
    case = read_case(tmp_path, edited(MAST_AND_FLY, ("[[load]]", f"{text}[[load]]")))
    mast, fly = build_boom(case).segments
    assert mast.compression(np.array([3.0, 7.0])) == pytest.approx(of_mast, rel=1e-9)
    assert fly.compression(np.array([7.0, 13.0])) == pytest.approx(of_fly, rel=1e-9)


def test_check_and_report_tell_the_buckling_factor(tmp_path: Path) -> None:
    """Reference: the summary of the run."""
    case = read_case(tmp_path, MAST_AND_FLY + "[[axial]]\nforce = 4e4\n" + BONDED)
    results = pt.run_case(case)
    factor = results.summary.models["bonded"].critical_factor
    shown = printed_check(case, 120)
    words = [line.replace("│", " ").split() for line in shown.splitlines()]
    assert ["mast", "−40", number(-0.04 / MAST.area, 4)] in words
    told = f"{factor:.4g}", f"{100.0 / factor:.3g}"
    assert all(text in shown for text in told)
    assert buckling_table(results).rows[1][1:3] == told


@pytest.mark.parametrize(
    ("text", "caution"),
    [
        ("[[axial]]\nforce = 3e5\n",
         "caution: in bonded the axial forces are 48.2 % of those under which the boom buckles, "
         "more than a third: deflections grow out of proportion"),
        ('[[load]]\nsegment = "fly"\nx = 14.0\nmagnitude = -1.2e5\n',
         "caution: {} the tip rests at -2.16 m, 15 % of the boom's length: small displacements "
         "make it about 2.6 % too large, and moments about 1.5 %; check units and loads"),
    ],
)  # fmt: skip
def test_cautions_in_check_and_report(tmp_path: Path, text: str, caution: str) -> None:
    """Reference: exact words; with play the tip rests lower by what the fly tilts."""
    case = read_case(tmp_path, (MAST_AND_FLY + text + BONDED).replace("= 0.05", "= 0.5"))
    start, _, _ = caution.format("in the beam estimate").partition("2.16")
    assert any(line.startswith(start) for line in printed_check(case).splitlines())
    assert caution.format("in bonded") in pt.run_case(case, models=["bonded"]).summary.cautions


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("[rope]\n[payload]\nmass = 100.0\n",
         "rope.falls: missing; it is the number of falls between head and hook; those of the table "
         "hoist unless given"),
        ("[payload]\nmass = 5.0\ngravity = 4.9\n[gravity]\nangle = 60.0\n",
         "payload.gravity: the table gravity is given, by which the payload weighs too; leave "
         "one of them out"),
    ],
)  # fmt: skip
def test_bad_weights_are_refused(tmp_path: Path, text: str, line: str) -> None:
    """Reference: exact words."""
    assert refusal(tmp_path, MAST_AND_FLY + text) == line


TAPERED = """section = { height = 0.7, width = 0.3, flange = 0.012, web = 0.012 }
head_section = { height = 0.5, width = 0.3, flange = 0.006, web = 0.006 }
"""
PRESSED = table("[[axial]]", force=3e5) + elements("beam", theory="euler-bernoulli")


@pytest.mark.slow
def test_tapered_boom_has_the_largest_stress_at_the_extension(tmp_path: Path) -> None:
    """Reference: by hand, 300 kN on four walls, at 9 m of 6.6 mm, nine tenths of the taper."""
    head, outer, inner, *_ = (pt.CASES / "drawn-out.toml").read_text("utf-8").split("[[segment]]\n")
    numbers = outer[outer.index("mass_per_length") : outer.index("load")]
    box = "section = { height = 0.45, width = 0.25, flange = 0.006, web = 0.006 }\n"
    own = inner[inner.index("mass_per_length") : inner.index("load")]
    parts = head, outer.replace(numbers, TAPERED), inner.replace(own, box).partition("[[model]]")[0]
    case = read_case(tmp_path, "[[segment]]\n".join(parts) + PRESSED)
    rows = [line.replace("│", " ").split() for line in printed_check(case, 120).splitlines()]
    stress = 300e3 / (2.0 * (0.3 + 0.52) * 6.6e-3) / 1e6
    assert ["outer", "−300", number(-stress, 4)] in rows


def test_a_segment_has_its_own_material(tmp_path: Path) -> None:
    """Reference: analytic, ρ A and E of a segment, by default with the material of the case."""
    own = "material = { youngs_modulus = 7e10, poissons_ratio = 0.33, density = 2700.0 }"
    text = edited(MAST_AND_FLY, (CLAMPED, f"{CLAMPED}\n{own}"))
    mast, fly = build_boom(read_case(tmp_path, text)).segments
    numbers = mast.mass_per_length, mast.bending_stiffness, mast.rotary_inertia
    second = MAST.second_moment_of_area
    assert numbers == pytest.approx((2700.0 * MAST.area, 7e10 * second, 2700.0 * second), rel=1e-12)
    assert fly.material.density == 7850.0
    case = read_case(tmp_path, edited(text, (STEEL, ""), ('"fly"\nspan', f'"fly"\n{own}\nspan')))
    assert build_boom(case).segments[0] == mast
    assert read_case(tmp_path, toml.dumps(case)) == case

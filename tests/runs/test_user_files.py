# SPDX-License-Identifier: LGPL-3.0-or-later
"""CSV files from other programs, refusal of special and oversized files, booms without loads."""

import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from protractile.geometry.units import Unit
from protractile.runs.case.build import build_boom
from protractile.runs.case.reading import load
from protractile.runs.case.schema import Case
from protractile.runs.case.user_files import MAX_BYTES, check_not_working_folder
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.inputs import series
from protractile.runs.folder.files import MANIFEST
from protractile.runs.pipeline.results import Results, prepare
from tests.runs.case_texts import (
    CLAMPED,
    COARSE,
    REST,
    STEEL,
    box,
    elements,
    joint,
    read_case,
    refusal,
    refused,
    table,
)
from tests.system.run_folder import protractile

GUST = '[[base]]\nacceleration = 1.0\nfile = "gust.csv"\n\n[[model]]'


pytestmark = pytest.mark.usefixtures("here")


def too_large(path: str) -> None:
    with open(path, "wb") as file:
        file.truncate(MAX_BYTES + 1)


@pytest.mark.parametrize(
    ("make", "why"), [(os.mkfifo, "not a regular file"), (too_large, "larger than 16 MB")]
)
def test_special_and_oversized_files_are_refused(make: Callable[[str], object], why: str) -> None:
    make("case.toml")
    with refused(f"case.toml: file: cannot be read ({why}); give a case file that can"):
        load("case.toml")


@pytest.mark.parametrize(
    ("make", "what"),
    [
        (lambda path: os.symlink("/dev/zero", path), "'gust.csv' cannot be read (not a regular"),
        (os.mkdir, "'gust.csv' cannot be read (Is a directory); "),
        (lambda path: os.symlink(path, path), "'gust.csv' cannot be read (Too many levels of "),
        (lambda path: Path(path).write_bytes(b"0,1\n1,\xff"), "'gust.csv' has no finite number in"),
        (lambda path: Path(path).write_bytes(b"0,1\n" * 100_001), "'gust.csv' has 100001 lines; "),
    ],
)
def test_a_history_s_file_is_read_with_same_care(make: Callable[[str], object], what: str) -> None:
    make("gust.csv")
    said = refusal(Path(), COARSE.replace("[[model]]", GUST, 1))
    assert said.startswith(f"base[1].file: {what}")


def test_nobody_s_folder_is_replaced_around_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "out"
    (folder / "figures").mkdir(parents=True)
    for name in (MANIFEST, "trajectories.nc"):
        (folder / name).touch()
    for inside in (folder, folder / "figures"):
        monkeypatch.chdir(inside)
        for other in (folder / "other", tmp_path / "other", tmp_path / "ou"):
            check_not_working_folder(other, "case.toml", "--out other")
        with refused(
            f"case.toml: --out {folder}: is where you are, and will be replaced; start from "
            "another folder"
        ):
            prepare(str(folder), "case.toml")


TABLE = ((0.0, 0.5), (0.25, -1500.0))


def text_of(csv: str, keys: str, heading: str = '[[load]]\nsegment = "inner"') -> str:
    """Write a file, and return a case with a table that reads it."""
    Path("gust.csv").write_text(csv, encoding="utf-8")
    table = f'{heading}\n{keys}\nfile = "gust.csv"'
    return COARSE.replace("[[model]]", f"{table}\n\n[[model]]", 1)


def case_of(*given: str) -> Case:
    return read_case(Path(), text_of(*given))


AT_TIP, FACTOR = "x = 19.0", "x = 19.0\nmagnitude = 1.0"
TWO = 'x = 19.0\ncolumns = ["t", "F"]'


@pytest.mark.parametrize(
    ("csv", "keys"),
    [
        ("0, 0.5\n0.25, -1500\n", FACTOR),
        ("0;0,5\n0,25;-1500\n", FACTOR),
        ("sep=;\n0;0,5;\n0,25;-1.5e3;\n", FACTOR),
        ('# of a sensor\n"time","factor"\n"0","0,5"\n"0,25","-1500"\n', "magnitude = 1.0"),
        ("t [ms]\tF [kN]\n0\t0.0005\n250\t-1.5\n", AT_TIP),
        ("Zeit (ms);Kraft (kN)\n0;0,0005\n250;-1,5\n", AT_TIP),
        ("t / s;F / kN\n0;0,0005\n0,25;-1,5\n", AT_TIP),
        ("time in s;wind load in N/mm\n0;0,0005\n0,25;-1,5\n", ""),
        ("t;M\nms;kNm\n0;0,0005\n250;-1,5\n", "x = 19.0\nmoment = true"),
        ("0 0.5\n0.25 -1500\n", FACTOR),
        ("t  [ms]   F [kN] # of a logger\n  0   0,0005\n250  -1,5\n", AT_TIP),
        ("t / s  F / kN\n0 5e-4\n0.25 -1.5\n", AT_TIP),
        ("t F v\ns kN m/s\n0 0.0005 30\n0.25 -1.5 31\n", TWO),
        # Thousandths with a decimal comma, and an empty last cell.
        ("t;F;u\ns;kN;m\n0;0,0005;\n0,250;-1,500;7\n", TWO),
        ("t [s],gust [%]\n0,50\n0.25,-150000\n", "magnitude = 1.0"),
        ("no,F (N),speed (km/h),t (s)\n1,0.5,30,0\n2,-1500,31,0.25\n", TWO.replace("F", "F (N)")),
    ],
)  # fmt: skip
def test_columns_are_read_in_their_units(csv: str, keys: str) -> None:
    """Reference: analytic, the same pairs in SI units."""
    (load,) = case_of(csv, keys).loads
    assert (load.file, load.columns, load.magnitude) == (None, None, 1.0)
    for pair, expected in zip(load.table, TABLE, strict=True):
        assert pair == pytest.approx(expected, rel=1e-15)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "cp1252"])
def test_files_are_read_as_spreadsheets_save_them(encoding: str) -> None:
    """Reference: analytic, the same pairs; the names and the unit have letters beyond ASCII."""
    csv = "Zeit (s);Erregung für Süd (m/s²)\r\n0;0,5\r\n0,25;-1500\r\n"
    keys = 'columns = ["Zeit", "Erregung für Süd"]'
    text = text_of("", keys, "[[base]]")
    Path("gust.csv").write_bytes(csv.encode(encoding))
    assert read_case(Path(), text).base[0].table == TABLE


@pytest.mark.parametrize(
    ("unit", "factor"), [("g", 9.80665), ("cm/s2", 0.01), ("mm/s²", 0.001), ("m/s^2", 1.0)]
)
def test_a_measured_quake_needs_no_acceleration(unit: str, factor: float) -> None:
    """Reference: analytic, the standard gravity 9.80665 m/s², times a given factor."""
    for keys, times in (("", 1.0), ("acceleration = -2.0", -2.0)):
        (base,) = case_of(f"t (s),a ({unit})\n0,0\n0.5,0.3\n", keys, "[[base]]").base
        assert base.acceleration * base.table[1][1] == pytest.approx(times * 0.3 * factor)


def test_a_contact_s_file_may_be_in_millimetres_and_kilonewtons() -> None:
    """Reference: analytic, the same pairs in SI units."""
    Path("pad.csv").write_text("F [kN];depth [mm]\n1,5;0,1\n4;0,2\n", encoding="utf-8")
    law = 'force_file = "pad.csv"\nforce_columns = ["depth", "F"]\n'
    text = COARSE.replace("stiffness = 1e13\nexponent = 2.0\n", law, 1)
    (joint,) = read_case(Path(), text).joints
    assert joint.force_table == ((1.0e-4, 1500.0), (2.0e-4, 4000.0))


PAIRS = "give a CSV file of two columns, time in s and factor; a heading may say other units"
OF_FORCE = "give N/m or another unit of the kind"
THOUSANDS = (
    "that may separate thousands; write numbers with a decimal mark only, such as 1500 or 1.5"
)
WHOLE_LINES = "give each line all columns, numbers without further commas"
OF_THREE = "t;F;v\n0;1;2\n1;1;2\n"


@pytest.mark.parametrize(
    ("csv", "columns", "line"),
    [
        (OF_THREE, "", "'gust.csv' has 3 columns in line 1; name two of them"),
        (OF_THREE, '["t", "G"]',
         "'gust.csv' has no column 'G' in line 1; give 't', 'F' or 'v'"),
        ("0;1\n1;1\n", '["t", "F"]',
         "'gust.csv' has no heading; leave the names of columns out"),
        ("t (s);F\n0;1,5\n1;1.234,5\n", "",
         f"'gust.csv' has no finite number in line 3, column 2; {PAIRS}"),
        ('t [s],F\n0,"0"\n0.1,"-1,500"\n0.2,"-999"\n', "",
         f"'gust.csv' has a comma in line 3, column 2 {THOUSANDS}"),
        ("t [s];F\n0;0\n0,1;-1.500\n", "",
         f"'gust.csv' has a point in line 3, column 2 {THOUSANDS}"),
        ("t,F,u\n1,0,-5,0,3,7\n2,0,-5,0,3,7\n", '["t", "F"]',
         f"'gust.csv' has 6 columns in line 2 and 3 in the heading; {WHOLE_LINES}"),
        ("t;F\n0;0\n0,1;0\n0,1;-1000\n", "",
         "'gust.csv' has a time in line 4 that repeats the one before; give each once"),
        ("t (s);F\n0;1,5\n1\n", "", f"'gust.csv' has 1 column in line 3; {PAIRS}"),
        ("t,F\n", "", f"'gust.csv' has fewer than two lines of numbers; {PAIRS}"),
        ("t (s);F (V)\n0;1\n1;1\n", "",
         f"'gust.csv' has a unit in line 1, column 2 that is no unit that is known; {OF_FORCE}"),
        ("t (s);F (kN)\n0;1\n1;1\n", "",
         f"'gust.csv' has a unit in line 1, column 2 that is another quantity; {OF_FORCE}"),
    ],
)  # fmt: skip
def test_bad_columns_are_refused(csv: str, columns: str, line: str) -> None:
    keys = f"magnitude = 1.0\ncolumns = {columns}" if columns else "magnitude = 1.0"
    assert complaint(csv, keys) == f"file: {line}"


def complaint(csv: str, keys: str) -> str:
    return refusal(Path(), text_of(csv, keys)).removeprefix("load[1].")


def test_factors_need_a_magnitude_and_columns_are_two_of_a_file() -> None:
    assert complaint("t (s);F\n0;1\n1;1\n", "").startswith("magnitude: missing; it is the load ")
    one = 'magnitude = 1.0\ncolumns = ["t"]'
    assert complaint("0;1\n1;1\n", one) == "columns: must be a list of two names, got ['t']"
    text = '[[load]]\nsegment = "inner"\nmagnitude = 1.0\ncolumns = ["t", "F"]\n\n[[model]]'
    assert refusal(Path(), COARSE.replace("[[model]]", text, 1)) == (
        "load[1].columns: there is no file whose columns these are; leave it out"
    )
    path = GUST.replace("gust", "a\\u0000b")
    assert refusal(Path(), COARSE.replace("[[model]]", path, 1)) == (
        "base[1].file: must be a line of printable characters, got 'a\\x00b.csv'"
    )


@pytest.mark.parametrize(
    ("times", "note"),
    [
        ((0.0, 0.6), None),
        ((0.1, 0.5), "lasts from 0.1 to 0.5 s, the run 0.6 s: its first value, 1, is held before; "
         "its last value, 2, is held afterwards"),
        ((-1.0, 60.0), "lasts from -1 to 60 s, the run 0.6 s: what is before t = 0 is left out; "
         "what comes after the run is left out"),
    ],
)  # fmt: skip
def test_end_of_a_series_gives_a_caution(times: tuple[float, float], note: str | None) -> None:
    case = case_of(f"{times[0]},1\n{times[1]},2\n", "magnitude = 1.0")
    assert case.time.duration == 0.6
    expected = [] if note is None else [f"note: the series of load[1] {note}"]
    assert [*series(Context(case, build_boom(case)))] == expected


@pytest.mark.parametrize(
    ("text", "factor", "dimension"),
    [
        ("N/m^1.5", 1.0, (-0.5, 1.0, -2.0)), ("N/mm^2", 1.0e6, (-1.0, 1.0, -2.0)),
        ("t/mm^3", 1.0e12, (-3.0, 1.0, 0.0)), ("N s/m²", 1.0, (-1.0, 1.0, -1.0)),
        ("kN·m", 1.0e3, (2.0, 1.0, -2.0)), ("1/s", 1.0, (0.0, 0.0, -1.0)),
        ("mm s⁻²", 1.0e-3, (1.0, 0.0, -2.0)), ("m/s**2", 1.0, (1.0, 0.0, -2.0)),
        ("-", 1.0, (0.0, 0.0, 0.0)), ("μm", 1.0e-6, (1.0, 0.0, 0.0)),
    ],
)  # fmt: skip
def test_units_are_products_of_powers(
    text: str, factor: float, dimension: tuple[float, float, float]
) -> None:
    """Reference: analytic, the definitions of the SI."""
    assert Unit.of(text) == Unit(factor, dimension)


@pytest.mark.parametrize("text", ["", "V", "kN/", "m/s^", "m^^2", "2m", "m^-", "N//m", "m^12345"])
def test_unknown_units_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="no unit"):
        Unit.of(text)


UNLOADED = f"""
title = "A boom that nothing loads"
time = {{ duration = 0.1, output_step = 1e-3 }}
{STEEL}
{table("[damping]", modal=0.01)}
{box("base", (0.0, 6.5), (0.300, 0.220, 0.006, 0.005), CLAMPED)}
{box("fly", (5.3, 11.3), (0.256, 0.180, 0.005, 0.004))}
{joint("fly", "base", 0.003, (5.3, 6.5))}
{elements("elements")}
{table("[[model]]", name="rigid", kind="rigid")}
{elements("bonded", bonded=True)}
"""


def load_text(**keys: object) -> str:
    return table("[[load]]", segment="fly", x="head", **keys)


# What is added, and whether the boom moves.
ADDED = {
    "at rest": (REST, False),
    "a load of nothing": (load_text(magnitude=0.0), False),
    "thrown": (table("[start]", velocity={"fly": 0.1}), True),
    "let go": (load_text(magnitude=-500.0, released=True), True),
}


@pytest.mark.slow
@pytest.mark.usefixtures("unprinted", "in_this_process")
@pytest.mark.parametrize("kind", ["at rest", "thrown", "let go"])
def test_a_boom_without_loads_is_run_and_reported(kind: str) -> None:
    """Reference: analytic. Without loads the boom is straight, and at rest unless thrown."""
    added, moves = ADDED[kind]
    Path("case.toml").write_text(UNLOADED + added, encoding="utf-8")
    assert protractile("check", "case.toml") == 0
    assert protractile("run", "case.toml", "--no-pictures", "--out", "out") == 0
    results = Results.load(Path("out"))
    rests = results.curves.where(model="elements", state="rest", play=True)
    ends = [curve.values["deflection"] for curve in rests.where(segment=rests[-1].segment)]
    assert not ends[-1].any()
    assert any(end.any() for end in ends) == (kind == "let go")
    assert bool(np.abs(results.trajectories["tip"].values).max() > 1e-3) == moves
    assert not Path("out/figures").exists()
    assert protractile("report", "--figures", "out") == 0
    assert Path("out/figures/at-rest.png").exists() == (kind == "let go")
    assert Path("out/figures/envelopes.png").exists() == moves


def test_members_need_a_load_or_a_play_to_change(capsys: pytest.CaptureFixture[str]) -> None:
    ensemble = "[ensemble]\nmembers = 4\n"
    line = (
        "ensemble.vary: no load acts from t = 0 on, of which members change a part; give vary = "
        "'clearance', or leave the ensemble out"
    )
    for added, _ in ADDED.values():
        assert refusal(Path(), f"{UNLOADED}{added}{ensemble}") == line
    Path("plain.toml").write_text(UNLOADED, encoding="utf-8")
    assert protractile("run", "--members", "4", "plain.toml") == 2
    assert capsys.readouterr().err == f"protractile: plain.toml: {line}\n"
    text = UNLOADED.replace("play = 0.003", "play = 0.0")
    assert refusal(Path(), f'{text}{ensemble}vary = "clearance"\n') == (
        "ensemble.vary: there is no play, of which members change a part; give vary = 'load', or "
        "leave the ensemble out"
    )

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Collars and diaphragms of a case."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from geometry.boom import Boom, BoomError, Collar, Diaphragm
from runs.case.build import build_boom
from runs.case.reading import load
from tests.runs.coarse_case import COARSE
from tests.shell_model.booms import three_segments
from tests.system.run_folder import protractile

STIFFENED = COARSE.replace(
    "supports = [0.0, 2.0]",
    "supports = [0.0, 2.0]\ncollars = [{ span = [9.7, 10.0], thickness = 0.01 }]\n"
    "diaphragms = [{ x = 0.0, thickness = 0.006 }]",
    1,
).replace("load = 55.07\n", "load = 55.07\ndiaphragms = [{ x = 9.0, thickness = 0.008 }]\n", 1)


@pytest.fixture
def stiffened(here: Path) -> str:
    """Return a case file of the coarse case with stiffeners."""
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
    assert protractile("check", stiffened) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert ["collar", "outer", "9.7–10", "10", "38.4"] in rows
    assert ["diaphragm", "outer", "0", "6", "7.5"] in rows
    assert ["diaphragm", "inner", "9", "8", "7.88"] in rows


@pytest.mark.parametrize(("outer", "x", "inner"), [(0, 9.0, "inner"), (1, 15.5, "third")])
def test_diaphragm_inside_an_overlap_is_refused(outer: int, x: float, inner: str) -> None:
    """It is also refused at the tail of the inner segment."""
    boom = three_segments()
    segments = list(boom.segments)
    segments[outer] = replace(segments[outer], diaphragms=(Diaphragm(x, 0.008),))
    message = (
        f"segments[{outer}].diaphragms[0].x: {inner!r} slides inside "
        f"{segments[outer].name!r} at {x:g} m, and no plate can close the box there; it must be "
        f"below {segments[outer + 1].start:g} m"
    )
    with pytest.raises(BoomError, match=f"^{re.escape(message)}$"):
        Boom(tuple(segments), boom.joints)

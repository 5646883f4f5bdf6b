# SPDX-License-Identifier: LGPL-3.0-or-later
"""What check prints of axial forces."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

from rich.console import Console

from runs import CASES
from runs.case.declared import Declared
from runs.case.reading import load
from runs.pipeline.inferred import print_axial_forces

TAPERED = """section = { height = 0.7, width = 0.3, flange = 0.012, web = 0.012 }
head_section = { height = 0.5, width = 0.3, flange = 0.006, web = 0.006 }
"""
PRESSED = '[[axial]]\nforce = 3e5\n\n[[model]]\nname = "beam"\nkind = "finite-element"\n'


def test_a_tapered_boom_is_pressed_most_where_it_is_drawn_to(tmp_path: Path) -> None:
    """Reference: by hand. The tail comes to 9 m, nine tenths of the way from 12 to 6 mm and from
    0.7 to 0.5 m, where 300 kN press four walls of 6.6 mm; at the start, at 5 m, of 9 mm."""
    head, outer, inner, *_ = (CASES / "drawn-out.toml").read_text("utf-8").split("[[segment]]\n")
    numbers = outer[outer.index("mass_per_length") : outer.index("load")]
    box = "section = { height = 0.45, width = 0.25, flange = 0.006, web = 0.006 }\n"
    own = inner[inner.index("mass_per_length") : inner.index("load")]
    parts = head, outer.replace(numbers, TAPERED), inner.replace(own, box).partition("[[model]]")[0]
    path, printed = tmp_path / "case.toml", StringIO()
    path.write_text("[[segment]]\n".join(parts) + PRESSED, encoding="utf-8")
    print_axial_forces(Declared(load(str(path))), Console(file=printed, width=120))
    rows = [line.replace("│", " ").split() for line in printed.getvalue().splitlines()]
    stress = 300e3 / (2.0 * (0.3 + 0.52) * 6.6e-3) / 1e6
    assert ["outer", "300", f"{stress:.4g}"] in rows

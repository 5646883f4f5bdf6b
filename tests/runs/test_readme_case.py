# SPDX-License-Identifier: LGPL-3.0-or-later
"""The boom that the README shows is one."""

from pathlib import Path

from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.pipeline.proportions import proportion_cautions

README = Path(__file__).parents[2] / "README.md"


def test_the_boom_of_the_readme_has_no_slip(tmp_path: Path) -> None:
    section = README.read_text("utf-8").split("## Your own boom\n")[1].split("\n## ")[0]
    path = tmp_path / "lift.toml"
    path.write_text(section.split("```toml\n")[1].split("```")[0], encoding="utf-8")
    case = case_file.load(str(path))
    boom = build_boom(case)
    assert proportion_cautions(case, boom) == []
    assert boom.tip == 11.3

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The guide of the measured boom: its commands, its numbers and its twin."""

import re
import tomllib
from pathlib import Path

import pytest
from typer.testing import CliRunner

import protractile as pt
from protractile.runs import cli
from protractile.runs.measured.identify import parse
from tests.docs.conftest import DOCS, toml_blocks

PAGE = (DOCS / "how-to" / "measured.md").read_text("utf-8")
EXAMPLES = DOCS.parent / "examples"
# What the readings were made with.
TWIN = {"joint.play": 0.0042, "damping.modal": 0.017, "payload.mass": 112.0}


@pytest.mark.slow
def test_the_guide_finds_the_twin(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Reference: by construction, within two standard errors; the numbers of the page."""
    monkeypatch.chdir(EXAMPLES)
    (options,) = re.findall(r"protractile identify measured-boom.toml ((?:.*\\\n)+.*)\n", PAGE)
    unknown = dict(parse(text, "") for text in re.findall(r"--unknown (\S+)", options))
    assert unknown.keys() == TWIN.keys()
    tables = tomllib.loads(Path("measured-boom.toml").read_text("utf-8"))
    case = pt.load_case(tables)
    assert not pt.compare(case).agrees
    alone = pt.identify(case, unknown, starts=1)
    assert alone.found.determined.tolist() == [False, True, True]
    assert alone.after.agrees
    name, left = alone.helpful[0]
    assert (name, f"{left[0]:.0%}") == ("free travel", "4%")
    (travel,) = tomllib.loads(toml_blocks("how-to/measured.md")[1])["measured"]
    tables["measured"].append(travel)
    frame = pt.identify(pt.load_case(tables), unknown, starts=1).frame
    assert frame["determined"].all()
    for key, value in TWIN.items():
        assert abs(frame.loc[key, "value"] - value) < 2.0 * frame.loc[key, "error"]
    play, damping, mass = (
        f"{factor * row.value:.{digits}f} ± {factor * row.error:.{digits}f}"
        for row, factor, digits in zip(
            frame.itertuples(), (1e3, 100.0, 1.0), (2, 2, 1), strict=True
        )
    )
    assert f"the play is {play} mm" in PAGE
    assert f"The damping is {damping} %" in PAGE
    assert f"{mass} kg" in PAGE


@pytest.mark.slow
@pytest.mark.usefixtures("in_this_process", "unprinted")
def test_the_commands_write_their_folders(tmp_path: Path) -> None:
    """Reference: the guide, which names the files; the identified case is a case."""
    text = (EXAMPLES / "measured-boom.toml").read_text("utf-8")
    text = text.replace("duration = 2.0", "duration = 0.5").replace('"meas', f'"{EXAMPLES}/meas')
    case = tmp_path / "short.toml"
    case.write_text(text, "utf-8")
    run = CliRunner().invoke
    compared = run(cli.app, ["compare", str(case), "--out", str(tmp_path / "compared")])
    assert compared.exit_code == 0, compared.output
    assert "Model and readings" in compared.output
    assert {path.name for path in (tmp_path / "compared").rglob("*")} >= {
        "report.html", "comparison.csv", "channel-1.png", "channel-2.png", "channel-3.png",
    }  # fmt: skip
    folder = tmp_path / "identified"
    options = ["--unknown", "payload.mass=50:200", "--starts", "1", "--samples", "4", "--profile"]
    found = run(cli.app, ["identify", str(case), *options, "--out", str(folder)])
    assert found.exit_code == 0, found.output
    assert "What else to measure" in (folder / "report.html").read_text("utf-8")
    assert {path.name for path in folder.rglob("*")} >= {
        "report.html", "unknowns.csv", "identified.toml", "profile-1.png", "sampling.csv",
    }  # fmt: skip
    payload = pt.load_case(folder / "identified.toml").payload
    assert payload is not None
    assert payload.mass == pytest.approx(112.0, abs=3.0)

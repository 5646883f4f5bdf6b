# SPDX-License-Identifier: LGPL-3.0-or-later
"""A run for reading: one HTML file that needs nothing else, and the tables of the terminal."""

from __future__ import annotations

import base64
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from runs import theme, toml
from runs.figures import Figure
from runs.questions import tied
from runs.results import Results
from runs.verdicts import Verdict

NONE = "–"

_MEDIA = {".png": "image/png", ".gif": "image/gif"}
_MARKS = {"reproduced": "✓", "contradicted": "✗", "undecided": "?"}
_STYLES = {"reproduced": "green", "contradicted": "bold red", "undecided": "yellow"}


@dataclass(frozen=True, slots=True)
class ModelRow:
    """One model's line in the tables, as text; ``NONE`` where it has no such number.

    ``color`` is that of its curves in the figures, ``seconds`` the wall time of all stages,
    ``stages`` those of each.
    """

    name: str
    color: str
    kind: str
    degrees_of_freedom: str
    modes: str
    step: str
    first_contact: str
    tip_peak: str
    tip_peak_time: str
    peak_force: str
    energy_residual: str
    seconds: str
    stages: str
    reduction_errors: str


def render(results: Results, figures: Sequence[Figure], snapshots: Sequence[Path]) -> str:
    """The report as HTML: every picture inside, no script, no resource from elsewhere.

    Args:
        results: one run.
        figures: on disk.
        snapshots: PNG and GIF files on disk.
    """
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"data_uri": _data_uri, "caption": _snapshot_caption}
    judged: list[str] = [verdict.verdict for verdict in results.verdicts]
    return environment.get_template("report.html").render(
        title=results.case.title,
        duration=f"{results.case.time.duration:g}",
        counts={kind: judged.count(kind) for kind in _MARKS},
        marks=_MARKS,
        verdicts=[
            (v, _measured(v.measured, v), _measured(v.threshold, v)) for v in results.verdicts
        ],
        demanded=results.case.demand,
        models=_model_rows(results),
        figures=figures,
        snapshots=snapshots,
        skipped=results.summary.get("snapshots", {}).get("skipped"),
        versions={k: v for k, v in results.summary["versions"].items() if v is not None},
        case_hash=results.summary["case_hash"],
        case_text=toml.dumps(results.case),
    )


def print_table(results: Results, console: Console) -> None:
    """Print the table of the models and that of the verdicts."""
    models = Table(title=Text(results.case.title), title_justify="left", box=SIMPLE_HEAD)
    models.add_column("model", no_wrap=True)
    for heading in (
        "dofs",
        "first contact s",
        "first tip peak s",
        "mm",
        "energy residual",
        "wall s",
    ):
        models.add_column(heading, justify="right")
    for row in _model_rows(results):
        models.add_row(
            Text(row.name),
            row.degrees_of_freedom,
            row.first_contact,
            row.tip_peak_time,
            row.tip_peak,
            row.energy_residual,
            row.seconds,
        )
    console.print(models)
    for caution in results.cautions():
        console.print(caution, markup=False)
    if results.judges_the_paper:
        console.print(_verdict_table(results))


def _verdict_table(results: Results) -> Table:
    verdicts = Table(title="Statements of the paper", title_justify="left", box=SIMPLE_HEAD)
    verdicts.add_column("id")
    verdicts.add_column("verdict")
    verdicts.add_column("measured", justify="right")
    verdicts.add_column("threshold", justify="right")
    verdicts.add_column("statement", ratio=1)
    for verdict in results.verdicts:
        demanded = " (demanded)" if verdict.id in results.case.demand else ""
        verdicts.add_row(
            verdict.id,
            Text(f"{verdict.verdict}{demanded}", style=_STYLES[verdict.verdict]),
            number(verdict.measured),
            number(verdict.threshold),
            Text.assemble(verdict.statement, (f" ({verdict.unit})" if verdict.unit else "", "dim")),
        )
    return verdicts


def number(value: float | None, digits: int = 3) -> str:
    """A number for people, with so many significant digits; ``NONE`` for none."""
    if value is None or not math.isfinite(value):
        return NONE
    if value == 0.0 or 1.0e-3 <= abs(value) < 1.0e5:
        rounded = float(f"{value:.{digits}g}")
        return f"{rounded:.0f}" if abs(rounded) >= 10.0 ** (digits - 1) else f"{rounded:g}"
    return theme.scientific(value, digits)


def _measured(value: float | None, verdict: Verdict) -> str:
    """A verdict's number with its unit."""
    text = number(value)
    return f"{text} {verdict.unit}" if verdict.unit and text != NONE else text


def _model_rows(results: Results) -> list[ModelRow]:
    models: Mapping[str, Any] = results.summary["models"]
    play_free = [model.name for model in results.case.models if tied(model)]
    strokes = theme.strokes(list(models), play_free)
    return [_model_row(name, strokes[name].color, model) for name, model in models.items()]


def _model_row(name: str, color: str, model: Mapping[str, Any]) -> ModelRow:
    peak_time, peak = model["first_peak"]["tip"]
    return ModelRow(
        name=name,
        color=color,
        kind=model["kind"],
        degrees_of_freedom=str(model["degrees_of_freedom"]),
        modes=str(model["modes"]),
        step=number(_times(1.0e6, model["step"])),
        first_contact=_fixed(model["first_contact"], 4),
        tip_peak=_fixed(_times(1.0e3, peak), 1),
        tip_peak_time=_fixed(peak_time, 3),
        peak_force=number(_times(1.0e-3, model["peak_contact_force"])),
        energy_residual=number(model["energy_residual"], 1),
        seconds=_fixed(sum(model["seconds"].values()), 1),
        stages=", ".join(f"{stage} {time:.2f} s" for stage, time in model["seconds"].items()),
        reduction_errors=", ".join(
            f"{what.replace('_', ' ')} {number(error, 2)}"
            for what, error in model.get("reduction_errors", {}).items()
        ),
    )


def _times(factor: float, value: float | None) -> float | None:
    return None if value is None else factor * value


def _fixed(value: float | None, decimals: int) -> str:
    return NONE if value is None or not math.isfinite(value) else f"{value:.{decimals}f}"


def _data_uri(path: Path) -> str:
    picture = base64.b64encode(path.read_bytes()).decode("ascii")
    return f"data:{_MEDIA[path.suffix.lower()]};base64,{picture}"


def _snapshot_caption(path: Path) -> str:
    """``boom-first-contact.png`` as *Boom first contact*."""
    return path.stem.replace("-", " ").capitalize()

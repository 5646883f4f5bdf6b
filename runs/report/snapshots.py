# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is to be seen in each snapshot of a run."""

from __future__ import annotations

import re
from pathlib import Path

import xarray as xr

from runs.case.kinds.model import of_kind
from runs.case.kinds.shell import ShellTable
from runs.pipeline.results import Results
from runs.report.figure_context import MILLI, Figure
from shell_model.pictures.rendering import ANIMATED, ANIMATION, SHOWN, TITLES, telling_instants

# What an arrow stands for where there is more than one point to a station.
ON_SURFACES = (
    " The segments touch over surfaces: each arrow is the sum of the forces of the points nearest "
    "to its station."
)

# A time in s that a user has asked for.
_GIVEN = re.compile(r"[0-9.e+-]+s")
_NAME = re.compile(
    r"(?P<view>boom|overlap|stress)(?P<above>-above)?(-(?P<joint>\d+))?-(?P<when>.+)"
)


def describe(results: Results, path: Path) -> Figure:
    """A snapshot with a title and a caption.

    Args:
        results: of the run whose shell it shows.
        path: as :func:`shell_model.pictures.rendering.render_snapshots` names it, with the shell's
            name before it where the case has several.
    """
    lines = {m.name: m.contact_line for m in of_kind(ShellTable, results.case.models)}
    shells = list(lines)
    several = [shell for shell in shells if path.name.startswith(f"{shell}-")]
    model = max(several, key=len) if len(shells) > 1 and several else shells[0]
    forces = ON_SURFACES if lines[model] == "surface" else ""
    name = path.name.removeprefix(f"{model}-" if len(shells) > 1 else "")
    motion = results.trajectories.sel(model=model)
    if name == ANIMATION:
        return _animation(path, model, motion)
    seen = _NAME.fullmatch(name.removesuffix(path.suffix))
    assert seen is not None, f"{path.name} is not a snapshot's name"
    when, tip = _instant(seen["when"], motion)
    state = f"{when}{tip}"
    above = ", seen from above" if seen["above"] else ""
    if seen["view"] == "boom":
        coloured = "deflection sideways" if above else "deflection"
        supports = "" if above else "; black: supports"
        caption = (
            f"The boom of {model!r}{above}: {state}. Colour: {coloured}; grey: at rest{supports}. "
            "Displacements and play are magnified by the factor above the picture."
        )
        return Figure(path, f"Boom{above}: {when}", caption)
    which = f" of joint {seen['joint']}" if seen["joint"] else ""
    if seen["view"] == "stress":
        caption = (
            f"Von Mises stresses of {model!r}{above}: {state}. Above: the whole boom; below: the "
            f"overlap{which}, cut open. Each triangle has the larger value of its two faces; the "
            "few beyond the end of the scale have its darkest colour. Displacements and play are "
            f"magnified by the factors above the picture.{forces}"
        )
        return Figure(path, f"Stress at the overlap{which}{above}: {when}", caption)
    caption = (
        f"The overlap{which} of {model!r}{above}, cut open: {state}. Blue: outer segment; orange: "
        "inner one; arrows: forces of the inner one on the outer one. Displacements and play are "
        f"magnified by the factor above the picture.{forces}"
    )
    return Figure(path, f"Overlap{which}{above}: {when}", caption)


def _animation(path: Path, model: str, motion: xr.Dataset) -> Figure:
    last = min(ANIMATED, float(motion["time"].values[-1]))
    caption = (
        f"The first {last:g} s of {model!r}, in {SHOWN:g} s. Colours and magnification as in the "
        "pictures of the boom."
    )
    return Figure(path, f"Boom in motion, first {last:g} s", caption)


def _instant(name: str, motion: xr.Dataset) -> tuple[str, str]:
    """What happens when, and where the tip is then; the name alone where the run has no such."""
    event = TITLES.get(name, name.replace("-", " "))
    instants = telling_instants(motion)
    if name in instants:
        time, when = instants[name], f"{event} at {instants[name]:.3f} s"
    elif _GIVEN.fullmatch(name):
        time = float(name.removesuffix("s"))
        when = f"{time:.3f} s"
    else:
        return event, ""
    tip = float(motion["tip"].sel(time=time, method="nearest"))
    return when, f", the tip at {MILLI * tip:+.1f} mm"

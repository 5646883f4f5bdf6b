# SPDX-License-Identifier: LGPL-3.0-or-later
"""Snapshots of a run: rendered, and what is to be seen in each."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import xarray as xr

from geometry.typography import signed
from runs.case.kinds.model import of_kind
from runs.case.kinds.shell import ShellTable
from runs.folder.files import beside
from runs.pipeline.results import FIELDS, Results
from runs.pipeline.summary import Snapshots
from runs.report.figure_context import MILLI, Figure
from shell_model.pictures.rendering import (
    ANIMATED,
    ANIMATION,
    SHOWN,
    TITLES,
    render_snapshots,
    telling_instants,
)

SNAPSHOTS = "snapshots"

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


def draw_snapshots(
    results: Results,
    shells: Mapping[str, xr.Dataset],
    folder: Path,
    times: Sequence[float] | None = None,
) -> list[str]:
    """Render the deformed shells of a run, and note it in the summary.

    Args:
        results: of the run.
        shells: fields by the name of their file, ``[SHELL-]fields.nc``.
        folder: of the run; pictures of other instants stay in it.
        times: in s; the telling ones unless given.

    Returns:
        The names of the pictures.

    Raises:
        RenderingUnavailable: no picture can be made here.
    """
    written = []
    pictures = folder / SNAPSHOTS
    with beside(pictures) as easel:
        for file, fields in sorted(shells.items()):
            model = fields.attrs["model"]
            prefix = file.removesuffix(FIELDS)
            for drawn in render_snapshots(fields, results.trajectories, model, easel, times):
                pictures.mkdir(exist_ok=True)
                written.append(drawn.replace(pictures / f"{prefix}{drawn.name}").name)
    earlier = results.summary.snapshots.written
    results.summary.snapshots = Snapshots(
        written=list(dict.fromkeys([*earlier, *written])), skipped=None
    )
    return written


def describe(results: Results, folder: Path) -> list[Figure]:
    """The snapshots of a run's folder, each with a title and a caption."""
    return [
        describe_one(results, folder / SNAPSHOTS / name)
        for name in results.summary.snapshots.written
    ]


def describe_one(results: Results, path: Path) -> Figure:
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
    above = ", seen from above" if seen["above"] else ""
    if above:
        motion = motion.assign(tip=motion["tip_lateral"])
    when, tip = _instant(seen["when"], motion)
    state = f"{when}{tip}" + (" to the side" if above and tip else "")
    if seen["view"] == "boom":
        coloured = "amount of deflection" + (" sideways" if above else "")
        supports = "" if above else "; black: supports"
        caption = (
            f"The boom of {model!r}{above}: {state}. Colour: {coloured}; grey: unloaded{supports}. "
            "Displacements and play are magnified by the factor above the picture."
        )
        return Figure(path, f"Boom{above}: {when}", caption)
    which = f" of joint {seen['joint']}" if seen["joint"] else ""
    if seen["view"] == "stress":
        caption = (
            f"Von Mises stresses of {model!r}{above}: {state}. Above: the whole boom; below: the "
            f"overlap{which}, cut open. The larger value of both faces, the mean of the triangles "
            "around a point of a wall; the few beyond the end of the scale have its darkest "
            "colour. Displacements and play are magnified by the factors above the picture."
            f"{forces}"
        )
        return Figure(path, f"Stress at the overlap{which}{above}: {when}", caption)
    caption = (
        f"The overlap{which} of {model!r}{above}, cut open: {state}. Blue: outer segment; orange: "
        "inner one; arrows: forces of the inner one on the outer one. Play, and what moves beside "
        "the outer segment, are magnified by the factor above the picture; a peak is what a blow "
        f"reaches, for microseconds.{forces}"
    )
    return Figure(path, f"Overlap{which}{above}: {when}", caption)


def _animation(path: Path, model: str, motion: xr.Dataset) -> Figure:
    last = min(ANIMATED, float(motion["time"].values[-1]))
    caption = (
        f"The first {last:g} s of {model!r} in slow motion, in {SHOWN:g} s. Colours and "
        "magnification as in the pictures of the boom."
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
    return when, f", the tip at {signed(f'{MILLI * tip:+.1f}')} mm"

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Snapshots of a run: rendered, and what is to be seen in each."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import xarray as xr

from geometry.typography import TO_MILLI, signed
from runs.case.kinds.model import of_kind
from runs.case.kinds.shell import Shell
from runs.case.messages import BadInput
from runs.pipeline.results import FIELDS, Results, read_fields
from runs.pipeline.summary import Snapshots
from runs.process.workers import workers
from runs.report.figure_context import Figure
from shell_model.pictures import opengl
from shell_model.pictures.rendering import (
    ANIMATED,
    ANIMATION,
    SHOWN,
    TITLES,
    render_files,
    render_film,
    render_stills,
    telling_instants,
)

SNAPSHOTS = "snapshots"
# What is drawn of each shell, at a time.
RENDERED = render_stills, render_film

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


def shells_in(folder: Path) -> list[Path]:
    """The fields of all shells in a run's folder.

    Raises:
        BadInput: there are none, or some that are damaged, or another version's.
    """
    shells = list(folder.glob(f"*{FIELDS}"))
    for path in shells:
        read_fields(path)
    if not shells:
        raise BadInput(str(folder), FIELDS, "missing; give the folder of a run with a shell")
    return shells


@contextmanager
def drawing(
    results: Results,
    shells: Sequence[Path],
    trajectories: Path,
    folder: Path,
    times: Sequence[float] | None = None,
) -> Iterator[Callable[[], list[str]]]:
    """Render the deformed shells of a run in processes beside this one.

    Args:
        results: of the run.
        shells: files of fields, ``[SHELL-]fields.nc``.
        trajectories: file of all.
        folder: of the run; pictures of other instants stay in it.
        times: in s; the telling ones unless given.

    What it gives waits for the pictures, notes them in the summary, and gives their names. It
    raises RenderingUnavailable where no picture can be made.
    """
    if not shells:
        yield list
        return
    with TemporaryDirectory(dir=folder) as easel, workers(len(RENDERED), opengl.hush) as pool:
        first = pool.submit(opengl.first_picture)
        drawn = []
        for number, path in enumerate(sorted(shells)):
            place = Path(easel) / str(number)
            place.mkdir()
            for render in RENDERED:
                found = pool.submit(render_files, render, path, trajectories, place, times)
                drawn.append((path.name.removesuffix(FIELDS), found))

        def gather() -> list[str]:
            pictures = {
                f"{prefix}{picture.name}": picture
                for prefix, several in _finished(first, drawn)
                for picture in several
            }
            (folder / SNAPSHOTS).mkdir(exist_ok=True)
            for name, picture in pictures.items():
                picture.replace(folder / SNAPSHOTS / name)
            earlier = results.summary.snapshots.written
            results.summary.snapshots = Snapshots(
                written=list(dict.fromkeys([*earlier, *pictures])), skipped=None
            )
            return list(pictures)

        yield gather


def _finished(
    first: Future[None], drawn: Sequence[tuple[str, Future[list[Path]]]]
) -> list[tuple[str, list[Path]]]:
    """The pictures of each shell, when all are there."""
    try:
        first.result(opengl.PROBE_SECONDS)
        return [(prefix, pictures.result()) for prefix, pictures in drawn]
    except TimeoutError:
        raise opengl.too_late() from None
    except BrokenProcessPool:
        # Another process tells what it has died of.
        opengl.require_opengl()
        raise MemoryError("the system has killed the process that draws") from None
    except (ImportError, RuntimeError):
        opengl.require_opengl()
        raise


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
        path: as :func:`shell_model.pictures.rendering.render_stills` names it, with the shell's
            name before it where the case has several.
    """
    lines = {m.name: m.contact_line for m in of_kind(Shell, results.case.models)}
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
            "colour. Beside a line of contact all of these grow as the mesh refines; strength is "
            "judged by means over a patch of half a wall, which settle and stand in the tables. "
            "Displacements and play are magnified by the factors above the picture."
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
    return when, f", the tip at {signed(f'{TO_MILLI * tip:+.1f}')} mm"

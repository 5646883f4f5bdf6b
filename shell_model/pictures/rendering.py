# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of a run's shell: at which instants, in which files."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib import rc_context
from PIL import Image

from dynamics.trajectory import Trajectory
from shell_model.pictures.boom import BoomView, Instant, draw_boom
from shell_model.pictures.deformation import MovingShell
from shell_model.pictures.overlap import draw_overlap
from shell_model.pictures.stress import StressScale, draw_stress
from shell_model.pictures.theme import LETTERS

# The animation: seconds of the run, number of pictures, seconds on the screen, part of a sheet.
ANIMATION = "motion.gif"
ANIMATED, FRAMES, SHOWN, SMALL = 2.5, 50, 5.0, 0.6

TITLES = {
    "first-peak": "first peak of the tip",
    "largest-deflection": "largest deflection of the tip",
    "largest-force": "largest contact force",
    "first-contact": "first contact",
}

# What happens at one station, of a joint or a stop.
AT_A_STATION = ("largest-force", "first-contact")


Times = Sequence[float] | None
Render = Callable[[Sequence[MovingShell], Path, Times], list[Path]]


def render_files(
    render: Render, fields: Path, trajectories: Path, folder: Path, times: Times = None
) -> list[Path]:
    """What is drawn of netCDF files, ``model`` being the attribute of the fields."""
    shell, motion = (xr.load_dataset(path, engine="scipy") for path in (fields, trajectories))
    return render(MovingShell.views(shell, motion.sel(model=shell.attrs["model"])), folder, times)


def render_stills(views: Sequence[MovingShell], folder: Path, times: Times = None) -> list[Path]:
    """Draw a shell at some instants.

    Args:
        views: of its motion, see :meth:`MovingShell.views`.
        folder: gets ``boom-WHEN.png``, ``overlap-WHEN.png`` and ``stress-WHEN.png`` of each
            instant (from the second joint on ``overlap-2-WHEN.png``), those of a boom in space
            seen from above too (``boom-above-WHEN.png``).
        times: in s; those of :func:`telling_instants` unless given.

    Returns:
        The files.

    Raises:
        ValueError: a time lies outside the run.
    """
    begin, end = _ends(views[0])
    when = _when(views[0].motion, times)
    for t in when.values():
        if not begin <= t <= end:
            raise ValueError(f"time must be between {begin:g} and {end:g} s, got {t:g}")
    drawn: dict[str, Image.Image] = {}
    with rc_context(LETTERS):
        scale = StressScale.of(views[0], _instants(views, when))
        for seen in views:
            above = "-above" if seen.from_above else ""
            when = _when(seen.motion, times)
            instants = _instants(views, when)
            view = BoomView.of(seen, [*instants, *_film(seen)])
            for name, picture in zip(when, draw_boom(seen, instants, view, end), strict=True):
                drawn[f"boom{above}-{name}.png"] = picture
            for number, overlap in enumerate(seen.overlaps, start=1):
                if seen.slides(overlap):
                    # Its stations do not stay where these pictures look.
                    continue
                joint = above if number == 1 else f"{above}-{number}"
                pictures = {
                    "overlap": draw_overlap(seen, instants, overlap),
                    "stress": draw_stress(seen, instants, scale, overlap),
                }
                for kind, several in pictures.items():
                    for name, picture in zip(when, several, strict=True):
                        drawn[f"{kind}{joint}-{name}.png"] = picture
    for name, picture in drawn.items():
        picture.save(folder / name)
    return [folder / name for name in drawn]


def render_film(views: Sequence[MovingShell], folder: Path, times: Times = None) -> list[Path]:
    """Draw the first motion of a shell, magnified as in :func:`render_stills`: ``motion.gif``."""
    shell = views[0]
    film, (begin, _) = _film(shell), _ends(shell)
    with rc_context(LETTERS):
        view = BoomView.of(shell, [*_instants(views, _when(shell.motion, times)), *film])
        last = film[-1].time
        slow = SHOWN / (last - begin) if last > begin else 1.0
        pace = f"; {slow:.3g} times slower than it is" if slow > 1.0 else ""
        _save_animation(list(draw_boom(shell, film, view, last, pace, SMALL)), folder / ANIMATION)
    return [folder / ANIMATION]


def _ends(shell: MovingShell) -> tuple[float, float]:
    """Of its motion in s."""
    begin, end = shell.motion["time"].values[[0, -1]]
    return float(begin), float(end)


def _film(shell: MovingShell) -> list[Instant]:
    begin, end = _ends(shell)
    return [Instant(float(t)) for t in np.linspace(begin, min(end, begin + ANIMATED), FRAMES)]


# Instants nearer to one another than this part of the run look the same.
SAME = 0.02


def _when(motion: xr.Dataset, times: Sequence[float] | None) -> dict[str, float]:
    """Times in s by the names that their files have."""
    return telling_instants(motion) if times is None else {f"{t:g}s": t for t in times}


def _instants(views: Sequence[MovingShell], when: Mapping[str, float]) -> list[Instant]:
    return [
        Instant(t, TITLES.get(name, "") + (where_pressed(views, t) if name in AT_A_STATION else ""))
        for name, t in when.items()
    ]


def telling_instants(motion: xr.Dataset) -> dict[str, float]:
    """Times in s of a model's trajectories that are worth a look, by what happens then.

    ``first-peak`` of the tip, or ``largest-deflection`` where there is no peak; the
    ``largest-force`` of the run, at any station, unless that is at nearly the same time; the
    ``first-contact``, unless something is pressed from the start. Without contact there is the
    first alone.
    """
    time = np.asarray(motion["time"].values)
    peak, _ = Trajectory(motion, np.empty((time.size, 0))).first_peak()
    if np.isnan(peak):
        instants = {"largest-deflection": float(time[np.abs(motion["tip"].values).argmax()])}
    else:
        instants = {"first-peak": peak}
    force = np.abs(np.nan_to_num(motion["contact_force_peak"].values))
    if force.any():
        largest = float(time[force.max(axis=1).argmax()])
        if all(abs(largest - seen) > SAME * time[-1] for seen in instants.values()):
            instants["largest-force"] = largest
        if not force[0].any():
            instants["first-contact"] = float(time[force.any(axis=1).argmax()])
    return instants


def where_pressed(views: Sequence[MovingShell], time: float) -> str:
    """Where the force is largest at a time (s); nothing where there is but one such place."""
    shell = views[0]
    places = [
        (f"joint {number}{' sideways' if seen.from_above else ''}", overlap.stations)
        for seen in views
        for number, overlap in enumerate(seen.overlaps, start=1)
    ]
    if len(places) + len(shell.stops) < 2:
        return ""
    peaks = shell.motion["contact_force_peak"].sel(time=time, method="nearest").values
    hardest = int(np.abs(np.nan_to_num(peaks)).argmax())
    return f" ({next((place for place, stations in places if hardest in stations), 'a stop')})"


def _save_animation(pictures: Sequence[Image.Image], path: Path) -> None:
    # All in one, hence of one palette: colours would flicker otherwise.
    width, height = pictures[0].size
    column = Image.new("RGB", (width, height * len(pictures)))
    for row, picture in enumerate(pictures):
        column.paste(picture, (0, row * height))
    coarse = column.quantize(256, Image.Quantize.FASTOCTREE)
    first, *rest = (
        coarse.crop((0, row * height, width, (row + 1) * height)) for row in range(len(pictures))
    )
    first.save(
        path,
        save_all=True,
        append_images=rest,
        duration=round(1.0e3 * SHOWN / len(pictures)),
        loop=0,
    )

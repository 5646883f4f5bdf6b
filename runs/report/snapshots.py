# SPDX-License-Identifier: LGPL-3.0-or-later
"""Snapshots of the shells of a run: times, files and captions."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import xarray as xr
from matplotlib import rc_context
from PIL import Image

from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.typography import TO_MILLI, with_minus_signs
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.results import FIELDS, Results, read_fields
from protractile.runs.pipeline.summary import Snapshots
from protractile.runs.process import workers
from protractile.runs.process.bad_input import BadInput
from protractile.runs.report import opengl, theme
from protractile.runs.report.boom_pictures import BoomView, draw_boom
from protractile.runs.report.overlap_pictures import draw_overlap
from protractile.runs.report.scene import Instant, Scene
from protractile.runs.report.sheet import Snapshot

SNAPSHOTS = "snapshots"

# Animation: animated duration of the run in s, for a crane the whole run; number of frames;
# duration on the screen in s; size factor of the sheet.
ANIMATION = "motion.gif"
ANIMATED, FRAMES, SHOWN, SMALL = 2.5, 40, 5.0, 0.6

# Parts of captions: what a picture shows; meaning of an arrow if a station has several contact
# points.
BOOM = (
    "Colour: von Mises stress, to the 99th percentile of the film; grey: undeformed; symbols: "
    "supports, cylinders, masses and loads. Displacements and play are magnified by the factor "
    "above the picture."
)
OVERLAP = (
    "the overlap with the largest contact force, cut open. Blue: outer segment; orange: inner one; "
    "arrows: forces of the inner one on the outer one. The factor above the picture magnifies play "
    "and displacements relative to the outer segment."
)
ON_SURFACES = (
    " Contact is over surfaces: each arrow is the sum of the forces at the points nearest to its "
    "station."
)

Times = Sequence[float] | None


def render_motion(
    views: Sequence[Scene], folder: Path, times: Times = None, every_view: bool = False
) -> list[Snapshot]:
    """Draw a shell at times in s, by default at the first peak of the tip, and its film.

    The view is the one in which the tip moves most, with ``every_view`` also the other one. The
    files are ``boom-WHEN.png``, from above ``boom-above-WHEN.png``; of the overlap with the largest
    contact force ``overlap-WHEN.png``; without given times also ``motion.gif``.

    Raises:
        ValueError: a time lies outside the run.
    """
    begin, end = views[0].motion["time"].values[[0, -1]]
    for t in times or ():
        if not begin <= t <= end:
            raise ValueError(f"time must be between {begin:g} and {end:g} s, got {t:g}")
    # Stable: the view from the side is the first one of views with equal motions.
    main, *others = sorted(views, key=lambda view: -float(np.ptp(view.motion["tip"].values)))
    snapshots: list[Snapshot] = []
    with rc_context(theme.PAGE_RC):
        instants, film = _instants(main.motion, times), _film(main)
        view = BoomView.of(main, [*instants.values(), *film])
        snapshots += _draw_stills(view, instants, folder)
        for scene in others if every_view else ():
            instants = _instants(scene.motion, times)
            other = BoomView.of(scene, [*instants.values(), *_film(scene)])
            snapshots += _draw_stills(other, instants, folder)
        for name, instant in _instants(views[0].motion, times).items():
            if (overlap := draw_overlap(views, instant)) is not None:
                when, state = _describe(views[0], instant)
                caption = f"In {state}: {OVERLAP}{ON_SURFACES * views[0].surface_contact}"
                path = folder / f"overlap-{name}.png"
                overlap.save(path, compress_level=1)
                snapshots.append(Snapshot(path, f"Overlap: {when}", caption))
        if times is None:
            snapshots.append(_draw_film(view, film, folder / ANIMATION))
    return snapshots


def _draw_stills(
    view: BoomView, instants: Mapping[str, Instant], folder: Path
) -> Iterator[Snapshot]:
    """Draw a boom at instants, whose names are in the names of files, and yield the pictures."""
    above, seen = ("-above", ", seen from above") if view.scene.from_above else ("", "")
    end = float(view.scene.motion["time"].values[-1])
    pictures = draw_boom(view, [*instants.values()], end)
    for (name, instant), picture in zip(instants.items(), pictures, strict=True):
        path = folder / f"boom{above}-{name}.png"
        picture.save(path, compress_level=1)
        when, state = _describe(view.scene, instant)
        yield Snapshot(path, f"Boom{seen}: {when}", f"Boom in {state}. {BOOM}")


def _draw_film(view: BoomView, film: Sequence[Instant], path: Path) -> Snapshot:
    """Draw the first seconds of the motion of a shell."""
    begin, last = film[0].time, film[-1].time
    slow = SHOWN / (last - begin) if last > begin else 1.0
    pace = f"; {slow:.3g} times slower than real time" if slow > 1.0 else ""
    pictures = list(draw_boom(view, film, last, pace, SMALL))
    # All frames share a palette, since colours would flicker otherwise.
    some = np.concatenate([np.asarray(picture) for picture in pictures[:: len(pictures) // 5 or 1]])
    palette = Image.fromarray(some).quantize(256, Image.Quantize.FASTOCTREE)
    first, *rest = (
        picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures
    )
    pause = round(1.0e3 * SHOWN / len(pictures))
    first.save(path, save_all=True, append_images=rest, duration=pause, loop=0)
    caption = (
        f"Animation of the first {last:g} s of {view.scene.model!r}, shown in {SHOWN:g} s. "
        "Colours and magnification as in the pictures of the boom."
    )
    return Snapshot(path, f"Boom in motion, first {last:g} s", caption)


def _describe(scene: Scene, instant: Instant) -> tuple[str, str]:
    """Return two texts on a picture: its time, and the model at this time with its deflection."""
    deflection = float(scene.motion["tip"].sel(time=instant.time, method="nearest"))
    tip = (
        f"{'lateral ' * scene.from_above}tip {with_minus_signs(f'{TO_MILLI * deflection:+.1f}')} mm"
    )
    seen = ", seen from above" * scene.from_above
    time = f"{instant.time:.3f} s"
    if instant.title:
        return (
            f"{instant.title} at {time}",
            f"{scene.model!r}{seen}, at the {instant.title} ({time}, {tip})",
        )
    return time, f"{scene.model!r}{seen}, at {time} ({tip})"


def render_files(
    render: Callable[..., list[Snapshot]],
    files: tuple[Path, Path],
    case: Case,
    folder: Path,
    *settings: Any,
) -> list[Snapshot]:
    """Call a function that draws a shell from the files of its fields and of all trajectories."""
    shell, motion = (xr.load_dataset(path, engine="scipy") for path in files)
    views = Scene.views(shell, motion.sel(model=shell.attrs["model"]), case)
    return render(views, folder, *settings)


def _film(scene: Scene) -> list[Instant]:
    begin, end = scene.motion["time"].values[[0, -1]].tolist()
    last = end if scene.drives else min(end, begin + ANIMATED)
    return [Instant(t) for t in np.linspace(begin, last, FRAMES).tolist()]


def _instants(motion: xr.Dataset, times: Times) -> dict[str, Instant]:
    """Return the instants at times in s, or the characteristic one, by their names in files."""
    if times is not None:
        return {f"{t:g}s": Instant(t) for t in times}
    instant = characteristic_instant(motion)
    return {instant.title.removesuffix(" of the tip").replace(" ", "-"): instant}


def characteristic_instant(motion: xr.Dataset) -> Instant:
    """Return the instant of the first peak of the tip; without one, of its largest deflection."""
    time = np.asarray(motion["time"].values)
    peak, _ = Trajectory(motion, np.empty((time.size, 0))).first_peak()
    if np.isnan(peak):
        farthest = float(time[np.abs(motion["tip"].values).argmax()])
        return Instant(farthest, "largest deflection of the tip")
    return Instant(peak, "first peak of the tip")


def shell_files(folder: Path) -> list[Path]:
    """Return the files of the fields of all shells in the folder of a run.

    Raises:
        BadInput: files are missing, damaged, or written by another version.
    """
    shells = list(folder.glob(f"*{FIELDS}"))
    for path in shells:
        read_fields(path)
    if not shells:
        raise BadInput(str(folder), FIELDS, "missing; give the folder of a run with a shell")
    return shells


@contextmanager
def start_rendering(
    results: Results,
    shells: Sequence[Path],
    trajectories: Path,
    folder: Path,
    times: Times = None,
    helper: Executor | None = None,
    every_view: bool = False,
) -> Iterator[Callable[[], list[str]]]:
    """Start rendering in another process, and yield a function that collects the pictures.

    The function waits for the pictures, adds them to the summary, and returns their names. It
    raises RenderingUnavailable if rendering is impossible. Pictures of other times stay in the
    folder of the run; times and views are those of :func:`render_motion`. The helper is the process
    that renders, by default a new one.
    """
    if not shells:
        yield list
        return
    executor = workers.workers(1, opengl.silence_stderr) if helper is None else nullcontext(helper)
    with TemporaryDirectory(dir=folder) as temporary, executor as pool:
        first = pool.submit(opengl.render_test_picture)
        futures = []
        for number, path in enumerate(sorted(shells)):
            place = Path(temporary) / str(number)
            place.mkdir()
            drawn = results.case, place, times, every_view
            future = pool.submit(render_files, render_motion, (path, trajectories), *drawn)
            futures.append((path.name.removesuffix(FIELDS), future))

        def gather() -> list[str]:
            drawn, written = _collect_pictures(first, futures), {}
            (folder / SNAPSHOTS).mkdir(exist_ok=True)
            for prefix, several in drawn:
                for snapshot in several:
                    name = f"{prefix}{snapshot.path.name}"
                    snapshot.path.replace(folder / SNAPSHOTS / name)
                    written[name] = snapshot.title, snapshot.caption
            earlier = results.summary.snapshots.written
            results.summary.snapshots = Snapshots(written=earlier | written, skipped=None)
            return list(written)

        yield gather


def _collect_pictures(
    first: Future[None], futures: Sequence[tuple[str, Future[list[Snapshot]]]]
) -> list[tuple[str, list[Snapshot]]]:
    """Wait for all pictures, and return the pictures of each shell."""
    try:
        first.result(opengl.PROBE_SECONDS)
        return [(prefix, pictures.result()) for prefix, pictures in futures]
    except TimeoutError:
        raise opengl.timeout_error() from None
    except BrokenProcessPool:
        # This raises the reason why the other process ended.
        opengl.require_opengl()
        raise MemoryError("the system has killed the process that draws") from None
    except (ImportError, RuntimeError):
        opengl.require_opengl()
        raise


def describe(results: Results, folder: Path) -> list[Snapshot]:
    """Return the snapshots in the folder of a run, with titles and captions."""
    written = results.summary.snapshots.written.items()
    return [Snapshot(folder / SNAPSHOTS / name, *texts) for name, texts in written]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Snapshots of the shells of a run: times, files and captions."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib import rc_context
from PIL import Image

from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.typography import TO_MILLI, with_minus_signs
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.results import FIELDS, Results, read_fields
from protractile.runs.pipeline.summary import Snapshots
from protractile.runs.process import workers
from protractile.runs.process.bad_input import BadInput
from protractile.runs.report import opengl, theme
from protractile.runs.report.boom_pictures import BoomView, draw_boom, render_buckling
from protractile.runs.report.crane_position import CranePosition
from protractile.runs.report.overlap_pictures import draw_overlap
from protractile.runs.report.scene import Instant, Scene

SNAPSHOTS = "snapshots"

# Animation: animated duration of the run in s, for a crane the whole run; number of frames;
# duration on the screen in s; size factor of the sheet.
ANIMATION = "motion.gif"
ANIMATED, FRAMES, SHOWN, SMALL = 2.5, 50, 5.0, 0.6

# Meaning of an arrow if a station has several contact points.
ON_SURFACES = (
    " Contact is over surfaces: each arrow is the sum of the forces at the points nearest to its "
    "station."
)

# File name of a time that the user requests.
_GIVEN = re.compile(r"[0-9.e+-]+s")
_NAME = re.compile(r"(?P<view>boom|overlap)(?P<above>-above)?-(?P<when>.+)")
_BUCKLING = re.compile(r"buckling-(?P<segment>\d+)\.png")

Times = Sequence[float] | None


class Snapshot(NamedTuple):
    """Picture of a shell in the folder of a run."""

    path: Path  #: path of the PNG or GIF file
    title: str  #: title of one line
    caption: str  #: caption in sentences

    @property
    def name(self) -> str:
        """The file name without suffix."""
        return self.path.stem

    @property
    def anchor(self) -> str:
        """The target of links in the report."""
        return f"figure-{self.name}"


Render = Callable[[Sequence[Scene], Path, Times], list[Path]]


def render_stills(views: Sequence[Scene], folder: Path, times: Times = None) -> list[Path]:
    """Draw a shell at times in s, by default at the first peak of the tip.

    The files are ``boom-WHEN.png``, in 3-D also ``boom-above-WHEN.png``, and of the overlap with
    the largest contact force ``overlap-WHEN.png``.

    Raises:
        ValueError: a time lies outside the run.
    """
    begin, end = views[0].motion["time"].values[[0, -1]]
    for t in times or ():
        if not begin <= t <= end:
            raise ValueError(f"time must be between {begin:g} and {end:g} s, got {t:g}")
    paths: list[Path] = []
    with rc_context(theme.PAGE_RC):
        for seen in views:
            above = "-above" if seen.from_above else ""
            instants = _instants(seen.motion, times)
            view = BoomView.of(seen, [*instants.values(), *_film(seen)])
            pictures = draw_boom(view, [*instants.values()], end)
            for name, picture in zip(instants, pictures, strict=True):
                paths.append(folder / f"boom{above}-{name}.png")
                picture.save(paths[-1], compress_level=1)
        for name, instant in _instants(views[0].motion, times).items():
            if (overlap := draw_overlap(views, instant)) is not None:
                paths.append(folder / f"overlap-{name}.png")
                overlap.save(paths[-1], compress_level=1)
    return paths


def render_film(views: Sequence[Scene], folder: Path, times: Times = None) -> list[Path]:
    """Draw the first seconds of the motion of a shell as ``motion.gif``."""
    # The view is the one in which the tip moves most.
    scene = max(views, key=lambda view: float(np.ptp(view.motion["tip"].values)))
    film = _film(scene)
    with rc_context(theme.PAGE_RC):
        view = BoomView.of(scene, [*_instants(scene.motion, times).values(), *film])
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
    first.save(
        folder / ANIMATION,
        save_all=True,
        append_images=rest,
        duration=round(1.0e3 * SHOWN / len(pictures)),
        loop=0,
    )
    return [folder / ANIMATION]


# A function that draws the pictures of a shell.
RENDERED: Sequence[Render] = (render_stills, render_film, render_buckling)


def render_files(
    renders: Sequence[Render],
    fields: Path,
    trajectories: Path,
    case: Case,
    folder: Path,
    times: Times,
) -> list[Path]:
    """Draw the pictures of a shell from the files of its fields and of all trajectories."""
    shell, motion = (xr.load_dataset(path, engine="scipy") for path in (fields, trajectories))
    views = Scene.views(shell, motion.sel(model=shell.attrs["model"]), case)
    return [path for render in renders for path in render(views, folder, times)]


def _film(scene: Scene) -> list[Instant]:
    begin, end = scene.motion["time"].values[0], _film_end(scene.motion, scene.crane)
    times = np.linspace(begin, end, FRAMES)
    return [Instant(t) for t in times.tolist()]


def _film_end(motion: xr.Dataset, crane: CranePosition | None) -> float:
    """Return the last time in s of the film of a motion."""
    begin, end = motion["time"].values[[0, -1]].tolist()
    return float(end if crane else min(end, begin + ANIMATED))


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
) -> Iterator[Callable[[], list[str]]]:
    """Start rendering in another process, and yield a function that collects the pictures.

    The function waits for the pictures, adds them to the summary, and returns their names. It
    raises RenderingUnavailable if rendering is impossible. Pictures of other times stay in the
    folder of the run; times are in s, by default the characteristic ones. The helper is the process
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
            future = pool.submit(
                render_files, RENDERED, path, trajectories, results.case, place, times
            )
            futures.append((path.name.removesuffix(FIELDS), future))

        def gather() -> list[str]:
            pictures = {
                f"{prefix}{picture.name}": picture
                for prefix, several in _collect_pictures(first, futures)
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


def _collect_pictures(
    first: Future[None], futures: Sequence[tuple[str, Future[list[Path]]]]
) -> list[tuple[str, list[Path]]]:
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
    return [
        describe_one(results, folder / SNAPSHOTS / name)
        for name in results.summary.snapshots.written
    ]


def describe_one(results: Results, path: Path) -> Snapshot:
    """Return a snapshot with a title and a caption.

    The file name of the picture tells shell, kind and time.
    """
    lines = {m.name: m.contact_line for m in select_kind(Shell, results.case.models)}
    shells = list(lines)
    several = [shell for shell in shells if path.name.startswith(f"{shell}-")]
    model = max(several, key=len) if len(shells) > 1 and several else shells[0]
    name = path.name.removeprefix(f"{model}-" if len(shells) > 1 else "")
    motion = results.trajectories.sel(model=model)
    if name == ANIMATION:
        last = _film_end(motion, CranePosition.of(results.case, results.boom, motion))
        caption = (
            f"Animation of the first {last:g} s of {model!r}, shown in {SHOWN:g} s. "
            "Colours and magnification as in the pictures of the boom."
        )
        return Snapshot(path, f"Boom in motion, first {last:g} s", caption)
    if mode := _BUCKLING.fullmatch(name):
        segment = results.boom.segments[int(mode["segment"]) - 1].name
        caption = (
            f"The first buckling mode of the walls of {segment!r} in {model!r}, where they move "
            "most, in the static state with the largest tip deflection. The amplitude is arbitrary."
        )
        return Snapshot(path, f"Buckling of {segment}", caption)
    seen = _NAME.fullmatch(name.removesuffix(path.suffix))
    assert seen is not None, f"{path.name} is not a snapshot's name"
    above, aside = (", seen from above", "lateral ") if seen["above"] else ("", "")
    if above:
        motion = motion.assign(tip=motion["tip_lateral"])
    when, state = _instant(seen["when"], motion, "lateral tip" if above else "tip")
    state = f"{model!r}{above}, {state}"
    if seen["view"] == "overlap":
        caption = (
            f"In {state}: the overlap with the largest contact force, cut open. Blue: outer "
            "segment; orange: inner one; arrows: forces of the inner one on the outer one. The "
            "factor above the picture magnifies play and displacements relative to the outer "
            "segment."
        )
        if lines[model] == "surface":
            caption += ON_SURFACES
        return Snapshot(path, f"Overlap: {when}", caption)
    caption = (
        f"Boom in {state}. Colour: magnitude of {aside}deflection; grey: undeformed; "
        "symbols: supports, cylinders, masses and loads. Displacements and play are magnified "
        "by the factor above the picture."
    )
    return Snapshot(path, f"Boom{above}: {when}", caption)


def _instant(name: str, motion: xr.Dataset, tip_name: str) -> tuple[str, str]:
    """Return two texts on the instant of a picture: for its title, and with the tip's deflection.

    The name is that in the file name. The trajectory ``tip`` of the motion is the displayed
    deflection, whose name is ``tip_name``.
    """
    given = _GIVEN.fullmatch(name)
    time, title = (float(name[:-1]), "") if given else characteristic_instant(motion)
    deflection = float(motion["tip"].sel(time=time, method="nearest"))
    tip = f"{tip_name} {with_minus_signs(f'{TO_MILLI * deflection:+.1f}')} mm"
    if title:
        return f"{title} at {time:.3f} s", f"at the {title} ({time:.3f} s, {tip})"
    return f"{time:.3f} s", f"at {time:.3f} s ({tip})"

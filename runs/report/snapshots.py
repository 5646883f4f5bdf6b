# SPDX-License-Identifier: LGPL-3.0-or-later
"""Snapshots of the shells of a run: times, files and captions."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, nullcontext
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import xarray as xr
from matplotlib import rc_context
from PIL import Image

from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.typography import TO_MILLI, with_minus_signs
from protractile.runs.case.kinds.model import select_kind
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.messages import BadInput
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.results import FIELDS, Results, read_fields
from protractile.runs.pipeline.summary import Snapshots
from protractile.runs.process import workers
from protractile.runs.report import opengl, theme
from protractile.runs.report.boom_pictures import BoomView, draw_boom, render_buckling
from protractile.runs.report.crane_position import CranePosition
from protractile.runs.report.figure_context import Figure
from protractile.runs.report.overlap_pictures import StressScale, draw_overlap, draw_stress
from protractile.runs.report.scene import Instant, Scene

SNAPSHOTS = "snapshots"

# Animation: animated duration of the run in s, for a crane the whole run; number of frames;
# duration on the screen in s; size factor of the sheet.
ANIMATION = "motion.gif"
ANIMATED, FRAMES, SHOWN, SMALL = 2.5, 50, 5.0, 0.6

TITLES = {
    "first-peak": "first peak of the tip",
    "largest-deflection": "largest deflection of the tip",
    "largest-force": "largest contact force",
    "first-contact": "first contact",
}

# Events that happen at a station.
AT_A_STATION = {"largest-force", "first-contact"}

# Two times closer than this fraction of the run count as one.
SAME = 0.02

# Meaning of an arrow if a station has several contact points.
ON_SURFACES = (
    " Contact is over surfaces: each arrow is the sum of the forces at the points nearest to its "
    "station."
)

# File name of a time that the user requests.
_GIVEN = re.compile(r"[0-9.e+-]+s")
_NAME = re.compile(
    r"(?P<view>boom|overlap|stress)(?P<above>-above)?(-(?P<joint>\d+))?-(?P<when>.+)"
)
_BUCKLING = re.compile(r"buckling-(?P<segment>\d+)\.png")

Times = Sequence[float] | None
Render = Callable[[Sequence[Scene], Path, Times], list[Path]]


def render_stills(views: Sequence[Scene], folder: Path, times: Times = None) -> list[Path]:
    """Draw a shell at times in s, by default at the :func:`characteristic_instants`.

    The files are ``boom-WHEN.png``, ``overlap-WHEN.png`` (from the second joint on
    ``overlap-2-WHEN.png``), ``stress-WHEN.png``, in 3-D also ``boom-above-WHEN.png``.

    Raises:
        ValueError: a time lies outside the run.
    """
    begin, end = views[0].motion["time"].values[[0, -1]]
    when = _named_times(views[0].motion, times)
    for t in when.values():
        if not begin <= t <= end:
            raise ValueError(f"time must be between {begin:g} and {end:g} s, got {t:g}")
    paths: list[Path] = []
    with rc_context(theme.PAGE_RC):
        assert views[0].stress is not None
        scale = StressScale.of(views[0].stress, when.values())
        for seen in views:
            above = "-above" if seen.from_above else ""
            when = _named_times(seen.motion, times)
            instants = _instants(views, when)
            view = BoomView.of(seen, [*instants, *_film(seen)])
            pictures: dict[str, Iterable[Image.Image]] = {
                f"boom{above}": draw_boom(view, instants, end)
            }
            # The view does not follow the stations of a driven overlap.
            overlaps = {
                overlap.stations[0].number + 1: overlap
                for overlap in seen.overlaps
                if not seen.telescopes(overlap)
            }
            stresses = draw_stress(seen, instants, scale, overlaps.values())
            for number, overlap in overlaps.items():
                joint = above if number == 1 else f"{above}-{number}"
                pictures[f"overlap{joint}"] = draw_overlap(seen, instants, overlap)
                pictures[f"stress{joint}"] = next(stresses)
            for kind, several in pictures.items():
                for name, picture in zip(when, several, strict=True):
                    paths.append(folder / f"{kind}-{name}.png")
                    picture.save(paths[-1], compress_level=1)
    return paths


def render_film(views: Sequence[Scene], folder: Path, times: Times = None) -> list[Path]:
    """Draw the first seconds of the motion of a shell as ``motion.gif``."""
    # The view is the one in which the tip moves most.
    scene = max(views, key=lambda view: float(np.ptp(view.motion["tip"].values)))
    film = _film(scene)
    with rc_context(theme.PAGE_RC):
        view = BoomView.of(scene, [*_instants(views, _named_times(scene.motion, times)), *film])
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


def _named_times(motion: xr.Dataset, times: Times) -> dict[str, float]:
    """Return the times in s by their names in file names."""
    return characteristic_instants(motion) if times is None else {f"{t:g}s": t for t in times}


def _instants(views: Sequence[Scene], when: Mapping[str, float]) -> list[Instant]:
    places = {
        name: place_of_largest_force(views[0], when[name]) for name in AT_A_STATION & when.keys()
    }
    return [Instant(t, TITLES.get(name, "") + places.get(name, "")) for name, t in when.items()]


def characteristic_instants(motion: xr.Dataset) -> dict[str, float]:
    """Return the times in s of characteristic events of a motion, by event.

    The events are ``first-peak`` of the tip, or ``largest-deflection`` without a peak;
    ``largest-force`` at any station, unless it is at nearly the same time; ``first-contact``,
    unless a contact is closed from the start.
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
        if all(abs(largest - other) > SAME * time[-1] for other in instants.values()):
            instants["largest-force"] = largest
        if not force[0].any():
            instants["first-contact"] = float(time[force.any(axis=1).argmax()])
    return instants


def place_of_largest_force(scene: Scene, time: float) -> str:
    """Return the location of the largest force at a time in s as text.

    It is empty if there is one joint in one direction, or one stop.
    """
    stations = scene.boom.stations
    if len({(one.stop is None, one.number, one.direction) for one in stations}) < 2:
        return ""
    peaks = scene.motion["contact_force_peak"].sel(time=time, method="nearest").values
    station = stations[int(np.abs(np.nan_to_num(peaks)).argmax())]
    if station.joint is None:
        return " (a stop)"
    return f" (joint {station.number + 1}{', lateral' if station.direction == 'y' else ''})"


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


def describe(results: Results, folder: Path) -> list[Figure]:
    """Return the snapshots in the folder of a run, with titles and captions."""
    return [
        describe_one(results, folder / SNAPSHOTS / name)
        for name in results.summary.snapshots.written
    ]


def describe_one(results: Results, path: Path) -> Figure:
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
        return Figure(path, f"Boom in motion, first {last:g} s", caption)
    if mode := _BUCKLING.fullmatch(name):
        segment = results.boom.segments[int(mode["segment"]) - 1].name
        caption = (
            f"The first buckling mode of the walls of {segment!r} in {model!r}, where they move "
            "most, in the static state with the largest tip deflection. The amplitude is arbitrary."
        )
        return Figure(path, f"Buckling of {segment}", caption)
    seen = _NAME.fullmatch(name.removesuffix(path.suffix))
    assert seen is not None, f"{path.name} is not a snapshot's name"
    above, aside = (", seen from above", "lateral ") if seen["above"] else ("", "")
    if above:
        motion = motion.assign(tip=motion["tip_lateral"])
    when, state = _instant(seen["when"], motion, "lateral tip" if above else "tip")
    state = f"{model!r}{above}, {state}"
    which = f" of joint {seen['joint']}" if seen["joint"] else ""
    joint = results.case.joints[int(seen["joint"] or 1) - 1] if seen["view"] != "boom" else None
    pair = f"overlap of {joint.inner!r} in {joint.outer!r}" if joint else ""
    title, caption = {
        "boom": (
            "Boom",
            f"Boom in {state}. Colour: magnitude of {aside}deflection; grey: undeformed; "
            "symbols: supports, cylinders, masses and loads. Displacements and play are magnified "
            "by the factor above the picture.",
        ),
        "stress": (
            f"Stress at the overlap{which}",
            f"Von Mises stresses in {state}. Upper picture: whole boom; lower picture: "
            f"{pair}, cut open. Colours: the larger stress of both faces, averaged at nodes; the "
            "circle marks the maximum. These stresses grow with refinement beside a contact line: "
            "no design values, unlike the local plate stress in the tables. Values beyond the end "
            "of the scale have its darkest colour. The factors above the picture magnify "
            "displacements and play.",
        ),
        "overlap": (
            f"Overlap{which}",
            f"In {state}: {pair}, cut open. Blue: outer segment; orange: inner one; arrows: forces "
            "of the inner one on the outer one. The factor above the picture magnifies play and "
            "displacements relative to the outer segment.",
        ),
    }[seen["view"]]
    if lines[model] == "surface" and seen["view"] != "boom":
        caption += ON_SURFACES
    return Figure(path, f"{title}{above}: {when}", caption)


def _instant(name: str, motion: xr.Dataset, tip_name: str) -> tuple[str, str]:
    """Return two texts on the instant of a picture: for its title, and with the tip's deflection.

    The name is that in the file name. The trajectory ``tip`` of the motion is the displayed
    deflection, whose name is ``tip_name``.
    """
    event = TITLES.get(name, name.replace("-", " "))
    instants = characteristic_instants(motion)
    if name in instants:
        time = instants[name]
    elif _GIVEN.fullmatch(name):
        time = float(name.removesuffix("s"))
    else:
        return event, f"at the {event}"
    deflection = float(motion["tip"].sel(time=time, method="nearest"))
    tip = f"{tip_name} {with_minus_signs(f'{TO_MILLI * deflection:+.1f}')} mm"
    if name in instants:
        return f"{event} at {time:.3f} s", f"at the {event} ({time:.3f} s, {tip})"
    return f"{time:.3f} s", f"at {time:.3f} s ({tip})"

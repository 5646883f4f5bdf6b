# SPDX-License-Identifier: LGPL-3.0-or-later
"""Flipped bits in the cache and in the points of a sweep.

All files have equal numbers of flips, so that names and checksums are hit as often as numbers.
Results must be the same to the last bit, and a single notice must report that an entry was computed
again.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from logging.handlers import BufferingHandler
from pathlib import Path

import numpy as np
from mpi4py import MPI

from protractile.runs.case import reading as case_file
from protractile.runs.folder.cache import Cache
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.run import run_case
from protractile.runs.process.terminal import NOTICES
from protractile.runs.sweep import run as sweep
from protractile.runs.sweep.points import plan
from tests.system.run_folder import COARSE
from tests.torture.shared_cache import Row

_SEED = 20


def rows(folder: Path, tries: int = 100) -> Iterator[Row]:
    """Yield the results of flips, one by one; a breach is one that was accepted or not reported.

    Args:
        folder: an empty one to work in.
        tries: bits to flip in each place.
    """
    cache = Cache(folder / "cache")
    yield "a bit of the cache", *_flip(cache.folder, tries, lambda: _shell(cache))
    sweeping = folder / "sweep"
    sweep.prepare(sweeping, COARSE)
    yield "a bit of a point", *_flip(sweeping / sweep.POINTS, tries, lambda: _points(sweeping))


def _flip(entries: Path, tries: int, compute: Callable[[], bytes]) -> tuple[int, int, str]:
    undisturbed = compute()
    random = np.random.default_rng(_SEED)
    notices = BufferingHandler(10**9)
    NOTICES.addHandler(notices)
    wrong = silent = 0
    for _ in range(tries):
        path = random.choice(np.array(sorted(entries.glob("*.record"))))
        content = bytearray(path.read_bytes())
        bit = int(random.integers(8 * len(content)))
        content[bit // 8] ^= 1 << bit % 8
        path.write_bytes(content)
        notices.buffer.clear()
        wrong += compute() != undisturbed
        silent += len(notices.buffer) != 1
    NOTICES.removeHandler(notices)
    return tries, wrong + silent, f"{wrong} results differ, {silent} without a notice"


def _shell(cache: Cache) -> bytes:
    """Return a shell and its motion until shortly after its first contact, both stored."""
    case = case_file.select(case_file.load(COARSE), "", ["shell"], 1.0)
    short = case.model_copy(update={"time": case.time.model_copy(update={"duration": 0.15})})
    run = run_case(short, "", RunContext(MPI.COMM_SELF, cache=cache, motions=cache))
    left = run.results.trajectories, run.shells["shell"].fields
    return b"".join(bytes(data.to_netcdf(engine="scipy")) for data in left)


def _points(folder: Path) -> bytes:
    """Return the plan of three points of the fastest model."""
    planned = plan(COARSE, ["joint.play=0.006:0.014:3"], ["beam-fe-bonded"], None)
    with ThreadPoolExecutor(1) as pool:
        return repr(sweep.run_points(planned, folder, pool, lambda *_: None)).encode()

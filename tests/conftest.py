# SPDX-License-Identifier: LGPL-3.0-or-later
"""Common fixtures: the boom of Rusiński and Wyciślok (1997), caches, ranks."""

import gc
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from math import inf
from pathlib import Path

import pytest
from hypothesis import settings

# As in the Makefile; before numpy, whose threads would change bits and compete with workers.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import protractile.shell_model  # noqa: F401 # its import loads MPI before DOLFINx
from protractile.dynamics.contact import PowerContact
from protractile.geometry.boom import Boom, Joint, Material, Segment, Support
from protractile.geometry.box import infer_inner_section, infer_outer_section
from protractile.runs.folder.cache import VARIABLE
from protractile.runs.process import terminal
from protractile.runs.process.ranks import launcher
from tests.touching import in_space
from tests.unprinted import blank

# The same examples every time, however slow the machine.
settings.register_profile("protractile", deadline=None, derandomize=True)
settings.load_profile("protractile")


@pytest.fixture(autouse=True, scope="session")
def _cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keep shells in one cache of all workers, and tests from using or filling the user's."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(VARIABLE, str(folder / "cache"))
        yield


@pytest.fixture(autouse=True, scope="session")
def _loops() -> None:
    """Compile the time step and the schemes of 1997 in the first of several workers."""
    if os.environ.get("PYTEST_XDIST_WORKER") == "gw0":
        from protractile.dynamics.integrator import FixedStep
        from protractile.dynamics.motion import Motion
        from studies.numerics_1997.schemes import NEWMARK, integrate
        from tests.modal import oscillator

        motion = Motion(oscillator(), 1.0, 0.1)
        FixedStep(0.1)(motion)
        integrate(motion, NEWMARK, iterated=False)


def pytest_collection() -> None:
    """Look for no garbage while modules are imported, which takes as long as their import."""
    gc.disable()


def pytest_collection_finish() -> None:
    """Look for garbage among what tests make, and no more among the imported modules."""
    gc.freeze()
    gc.enable()


def pytest_collection_modifyitems(items: list[pytest.Function]) -> None:
    """Put slow files first, shells without motions before others, so that all workers stay busy."""
    slow = {item.path for item in items if item.get_closest_marker("slow")}
    items.sort(key=lambda item: (item.path not in slow, _moves(item)))


def _moves(item: pytest.Function) -> bool:
    return item.path.parent.name != "shell_model" or hasattr(item.module, "Motion")


@pytest.fixture(autouse=True)
def _no_hurry(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make the output of commands independent of the machine's speed."""
    monkeypatch.setattr(terminal, "EVERY", inf)


@pytest.fixture(scope="session")
def steel() -> Material:
    return Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)


@pytest.fixture(scope="session")
def paper_boom(steel: Material) -> Boom:
    """Return segments on 0 and 2 m, with a play of 14 mm at 9 and 10 m and the load q."""
    outer_box = infer_outer_section(83.16 / steel.density, 3.7986e-4, 494.5 / 302.7)
    outer = Segment(
        name="outer",
        start=0.0,
        end=10.0,
        material=steel,
        mass_per_length=83.16,
        second_moment_of_area=3.7986e-4,
        rotary_inertia=3.48,
        section=outer_box,
        load=83.16,
        supports=(Support(0.0), Support(2.0)),
    )
    inner = Segment(
        name="inner",
        start=9.0,
        end=19.0,
        material=steel,
        mass_per_length=55.07,
        second_moment_of_area=2.1829e-4,
        rotary_inertia=1.68,
        section=infer_inner_section(55.07 / steel.density, 2.1829e-4, outer_box, 7.0e-3),
        load=55.07,
    )
    joint = Joint(outer=0, inner=1, stations=(9.0, 10.0), play=0.014)
    return Boom((outer, inner), (joint,))


@pytest.fixture(scope="session")
def spatial_boom(paper_boom: Boom) -> Boom:
    """Return the same boom in space, with a lateral play of 10 mm and no lateral load."""

    (joint,) = paper_boom.joints
    return Boom(
        tuple(in_space(segment) for segment in paper_boom.segments),
        (replace(joint, lateral_play=0.01),),
    )


@pytest.fixture(scope="session")
def paper_law() -> PowerContact:
    """Return (4) with the paper's k, n and Δ."""
    return PowerContact(stiffness=1.0e13, exponent=2.0).with_clearance(7.0e-3)


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Return an empty folder in which the test works, so that messages are predictable."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Keep shells of other tests from calibrating the beam of the live page."""
    from protractile.runs.live import beam

    monkeypatch.setenv(VARIABLE, str(tmp_path / "cache"))
    monkeypatch.setattr(beam, "_LAST", {})


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points run where patches hold, and no process imports what this one has."""
    from tests import at_once

    monkeypatch.setattr("protractile.runs.process.workers.workers", at_once.workers)


@pytest.fixture
def few_figures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Draw only one figure per run, since figures take longer than motions of beams."""
    from protractile.runs.report import figures

    monkeypatch.setattr(figures, "FIGURES", figures.FIGURES[-1:])


@pytest.fixture
def unprinted(monkeypatch: pytest.MonkeyPatch) -> None:
    """Make figures without their layout and printing, which take most of the time."""
    from matplotlib.figure import Figure

    monkeypatch.setattr(Figure, "savefig", blank)


@pytest.fixture(scope="session")
def opengl() -> None:
    """Skip pictures where OpenGL does not work."""
    from protractile.runs.report.opengl import RenderingUnavailable, require_opengl

    try:
        require_opengl()
    except RenderingUnavailable as reason:
        pytest.skip(str(reason))


def ranks_in(folder: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Return a runner of Python programs on a number of ranks in a folder."""
    if shutil.which(launcher()) is None:
        pytest.skip(f"several ranks take {launcher()}, which is not installed")
    # A test worker that has entered MPI by itself must not pass its own rank on.
    outside = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_", "PMI"))}
    environment = {
        **outside,
        "PYTHONPATH": str(Path(__file__).parents[1]),
        "OMP_NUM_THREADS": "1",
        "OMPI_ALLOW_RUN_AS_ROOT": "1",
        "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
        "OMPI_MCA_rmaps_base_oversubscribe": "1",
        "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
        # Ranks wait by looking again and again: those that share a core, and yield it, take no
        # other core from the tests of other workers.
        "OMPI_MCA_mpi_yield_when_idle": "1",
        # A job that fails waits for nothing before it is killed.
        "OMPI_MCA_odls_base_sigkill_timeout": "0",
    }

    def run(ranks: int, program: str, *arguments: str) -> subprocess.CompletedProcess[str]:
        start = [launcher(), "-n", str(ranks), "--bind-to", "none"]
        with _on_one_core():
            return subprocess.run(
                [*start, sys.executable, "-c", program, *arguments],
                cwd=folder,
                env=environment,
                capture_output=True,
                text=True,
                timeout=300,
                check=False,
            )

    return run


@contextmanager
def _on_one_core() -> Iterator[None]:
    """Keep this thread, and the processes that it starts, on the core of the test worker."""
    worker = os.environ.get("PYTEST_XDIST_WORKER", "gw0").removeprefix("gw")
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {sorted(cores)[int(worker) % len(cores)]})
    try:
        yield
    finally:
        os.sched_setaffinity(0, cores)

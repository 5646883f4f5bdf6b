# SPDX-License-Identifier: LGPL-3.0-or-later
"""Start of MPI for cases with shells, and end of all ranks with an error message.

Functions that handle errors do not import, since a process without memory cannot import.
"""

from __future__ import annotations

import os
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryFile, gettempdir
from typing import TYPE_CHECKING

from protractile.runs.process import ending
from protractile.runs.process.bad_input import BadInput
from protractile.runs.process.terminal import message, shorten

if TYPE_CHECKING:
    from mpi4py import MPI

# Space in bytes that Open MPI needs in the temporary folder: 8.2 MB and a margin.
_ROOM_OF_MPI = 16_000_000


def enter_mpi(
    shell: int, file: str, without: str = "run the other models with --models"
) -> MPI.Intracomm | None:
    """Return the communicator of the ranks that share the shells.

    ``shell`` is the number of the first model of a case with a shell. Without one it is 0, and the
    result None.

    Raises:
        BadInput: FEniCSx or a library of gmsh is not installed.
    """
    if not shell:
        return None
    _check_temporary_folder(file)
    if ending.launched_rank() is None:
        os.environ.update(ending.SINGLE_PROCESS)
    try:
        world = _world(file)
        import_module("protractile.shell_model.boom_shell")
    except ImportError as error:
        raise BadInput(
            file,
            f"model[{shell}].kind",
            f"a shell needs FEniCSx, which cannot be imported ({error}); install it (pip install "
            f"'protractile[shell]', or Debian's python3-dolfinx), or {without}",
        ) from None
    except OSError as error:
        # The wheel of gmsh brings no library of X and OpenGL, which it loads.
        raise BadInput(
            file,
            f"model[{shell}].kind",
            f"a shell needs gmsh, which misses {str(error).partition(':')[0]}; install libgl1 "
            "libglu1-mesa libxft2 libxcursor1 libxinerama1, or a gmsh without X (pip install "
            "--force-reinstall -i https://gmsh.info/python-packages-dev-nox gmsh), or "
            f"{without}",
        ) from None
    return world


def single_rank(shell: int) -> MPI.Intracomm | None:
    """Return the communicator of this process, which a shell needs; None without one."""
    if not shell:
        return None
    from mpi4py import MPI

    return MPI.COMM_SELF


def launched_ranks(file: str) -> MPI.Intracomm | None:
    """Return the communicator of all ranks; None if a launcher did not start several.

    Raises:
        BadInput: a launcher started several ranks, and mpi4py is not installed.
    """
    if ending.launched_rank() is None:
        return None
    try:
        world = _world(file)
    except ImportError as error:
        raise BadInput(
            file, "mpirun", f"mpi4py cannot be imported ({error}); run without mpirun"
        ) from None
    return world if world.size > 1 else None


def launcher() -> str:
    """Return the program that starts ranks of this interpreter: the one beside it, else mpirun."""
    beside = Path(sys.executable).with_name("mpiexec")
    return str(beside) if beside.exists() else "mpirun"


def _world(file: str) -> MPI.Intracomm:
    """Return the communicator of all ranks.

    Raises:
        BadInput: the ranks were started by the launcher of another MPI.
        ImportError: mpi4py is not installed.
    """
    sizes = (os.environ.get(name, "") for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE"))
    started = next((int(size) for size in sizes if size.isdecimal()), 1)
    # pip's MPICH aborts under Open MPI. Other pairs start every rank as the only one.
    aborts = find_spec("dolfinx_solver") is not None and "PMIX_RANK" in os.environ
    if not aborts:
        from mpi4py import MPI

    if aborts or MPI.COMM_WORLD.size < started:
        raise BadInput(
            file, "mpirun", f"the ranks were started by another MPI; start them by {launcher()}"
        )
    return MPI.COMM_WORLD


def explain(error: Exception) -> tuple[str, int] | None:
    """Return message and exit status of an error that the user can correct; None for others."""
    # Without memory the loader of libraries raises an error of its own.
    if isinstance(error, MemoryError) or "failed to map segment" in str(error):
        return message(f"out of memory ({error}); make the models or the output smaller"), 3
    from protractile.dynamics.failure import NumericsError

    if isinstance(error, BadInput):
        return message(str(error)), 2
    if isinstance(error, NumericsError):
        return message(str(error)), 3
    # A usage error of typer, whose class is not public.
    if hasattr(error, "format_message"):
        return message(f"{error.format_message()} (protractile --help tells more)"), 2
    if isinstance(error, OSError):
        # Errors of some libraries lack the file or the reason.
        file = "output" if error.filename is None else shorten(str(error.filename))
        return message(f"{file}: file: cannot be used ({error.strerror or error})"), 2
    return None


@contextmanager
def end_all_ranks_on_error(comm: MPI.Comm | None) -> Iterator[None]:
    """End all ranks if one of them fails, since the others would wait for it."""
    try:
        yield
    except Exception as error:
        if comm is None or comm.size == 1:
            raise
        explanation = explain(error)
        ending.fail(*(explanation or (traceback.format_exc(), 1)), comm)


def _check_temporary_folder(file: str) -> None:
    """Check the space in the temporary folder; without space, MPI aborts with a long message.

    Raises:
        BadInput: the folder has too little space, or is not writable.
    """
    # Open MPI uses $TMPDIR without a check; Python may choose another folder.
    folder = os.environ.get("TMPDIR") or gettempdir()
    try:
        with TemporaryFile(dir=folder) as probe:
            os.posix_fallocate(probe.fileno(), 0, _ROOM_OF_MPI)
    except OSError as error:
        raise BadInput(
            file,
            "TMPDIR",
            f"a shell needs {_ROOM_OF_MPI / 1e6:.0f} MB in {shorten(folder)!r} ({error.strerror}); "
            "make room there, or set TMPDIR to another folder",
        ) from None

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Compilation of forms; tests/system/test_ranks.py has shells on several ranks."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("dolfinx", reason="forms are compiled by FFCx")

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
COMPILE = """
import os, signal
import ffcx.codegeneration.jit as compiler
from mpi4py import MPI
from dolfinx import fem, mesh
import ufl
from protractile.shell_model import compat
domain = mesh.create_unit_interval(MPI.COMM_SELF, 2)
if {killed}:
    compiler._compile_objects = lambda *_, **__: os.kill(os.getpid(), signal.SIGKILL)
one = fem.Constant(domain, 3.0)
print(fem.assemble_scalar(fem.form(one * ufl.dx(domain=domain))))
"""


def compile_form(
    folder: Path, killed: bool, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Compile and evaluate a form. Reference: analytic, the integral of 3 over a unit."""
    outside = {k: v for k, v in os.environ.items() if not k.startswith(("OMPI_", "PMIX_", "PMI"))}
    return subprocess.run(
        [sys.executable, "-c", COMPILE.format(killed=killed)],
        env=outside | {"PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(folder)} | environment,
        capture_output=True,
        text=True,
        check=False,
    )


def test_only_the_first_compilation_needs_a_compiler_even_if_one_was_killed(
    tmp_path: Path,
) -> None:
    """Reference: by construction. The last line names the compiler and the packages."""
    assert compile_form(tmp_path, True).returncode == -signal.SIGKILL
    assert list((tmp_path / "fenics" / "protractile").glob("*.c"))
    missing = compile_form(tmp_path, False, CC="/no/cc").stderr.splitlines()[-1]
    assert "/no/cc" in missing
    assert missing.endswith(
        "; the forms of a shell are compiled once, which needs a C compiler and Python's headers: "
        "apt install gcc python3-dev, or dnf install gcc python3-devel: 'CC'"
    )
    assert compile_form(tmp_path, False).stdout == "3.0\n"
    assert compile_form(tmp_path, False, CC="/no/cc").stdout == "3.0\n"


def test_a_closed_connection_does_not_end_the_process() -> None:
    """Reference: as Python starts, the signal is ignored; PETSc would abort all ranks."""
    status = Path("/proc/self/status").read_text(encoding="utf-8")
    ignored = int(status.partition("\nSigIgn:")[2].split()[0], 16)
    assert ignored & 1 << (signal.SIGPIPE - 1)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Programs for comparison in tests; `make other-codes` installs them.

They have an environment of their own, since DOLFINx needs another version of numpy.
"""

import subprocess
from pathlib import Path

import pytest

PYTHON = Path(__file__).parents[1] / "build" / "other-codes" / "bin" / "python"
INSTALLED = pytest.mark.skipif(
    not PYTHON.exists(),
    reason="OpenSees, sectionproperties and Exudyn are missing: make other-codes",
)


def run_elsewhere(*arguments: str, given: str = "", folder: Path | None = None) -> str:
    """Return the output of the other codes' Python, which cannot import this program.

    Args:
        arguments: arguments of the interpreter.
        given: its input.
        folder: its working directory.

    Raises:
        CalledProcessError: it fails.
    """
    return subprocess.run(
        [str(PYTHON), "-I", *arguments],
        input=given,
        capture_output=True,
        text=True,
        check=True,
        cwd=folder,
    ).stdout

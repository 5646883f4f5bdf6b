# SPDX-License-Identifier: LGPL-3.0-or-later
"""Time loops compile where neither the sources' folder nor the user's can be written."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
PROGRAM = """
from numba import config
import dynamics.kernels.modal_flow
print(config.CACHE_DIR)
"""


def test_a_read_only_home_and_installation(tmp_path: Path) -> None:
    """A file where a folder should be stops root, too."""
    shutil.copytree(
        ROOT / "dynamics", tmp_path / "dynamics", ignore=shutil.ignore_patterns("__pycache__")
    )
    (tmp_path / "dynamics" / "__pycache__").touch()
    (tmp_path / "tmp").mkdir()
    (tmp_path / "home").touch()
    answer = subprocess.run(
        [sys.executable, "-B", "-c", PROGRAM],
        cwd=tmp_path,
        env=os.environ
        | {
            "HOME": str(tmp_path / "home"),
            "XDG_CACHE_HOME": str(tmp_path / "home"),
            "TMPDIR": str(tmp_path / "tmp"),
            "PYTHONPATH": str(tmp_path),
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert (answer.returncode, answer.stderr) == (0, "")
    assert Path(answer.stdout.strip()).parent == tmp_path / "tmp"
    assert list((tmp_path / "tmp").iterdir()) == []

# SPDX-License-Identifier: LGPL-3.0-or-later
"""A skipped test fails in runs that must not skip tests."""

from pathlib import Path

import pytest

from tests.system.run_folder import python

MARKED = "import pytest\n@pytest.mark.skip(reason='no tool')\ndef test(): pass\n"
ASKED = "import pytest\ndef test(): pytest.skip('no tool')\n"
WHOLE = "import pytest\npytest.skip('no tool', allow_module_level=True)\n"
EXPECTED = "import pytest\n@pytest.mark.xfail\ndef test(): assert False\n"


def outcome(folder: Path, text: str, *arguments: str) -> tuple[int, str]:
    """Exit status and output of pytest on one file."""
    (folder / "test_it.py").write_text(text, encoding="utf-8")
    command = "-m", "pytest", "-p", "no:cacheprovider", *arguments, "test_it.py"
    done = python(*command, folder=folder)
    return done.returncode, done.stdout


@pytest.mark.parametrize("text", [MARKED, ASKED, WHOLE])
def test_a_skipped_test_fails_and_says_why(text: str, tmp_path: Path) -> None:
    """Reference: by hand; without the plugin it passes (5: no test is left)."""
    assert outcome(tmp_path, text)[0] in (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED)
    status, told = outcome(tmp_path, text, "-p", "tests.no_skips")
    assert status in (pytest.ExitCode.TESTS_FAILED, pytest.ExitCode.INTERRUPTED)
    assert "no tool" in told


def test_expected_failure_is_accepted(tmp_path: Path) -> None:
    assert outcome(tmp_path, EXPECTED, "-p", "tests.no_skips")[0] == pytest.ExitCode.OK

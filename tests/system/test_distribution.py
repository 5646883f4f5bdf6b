# SPDX-License-Identifier: LGPL-3.0-or-later
"""Content of an installation, equal versions in all files, and runs without skipped tests."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest

from tests.system.run_folder import python

ROOT = Path(__file__).parents[2]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def read(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def output(*command: str | Path, cwd: Path) -> str:
    """Run a program that does not find the checkout, and return its output."""
    keys = {"env": {**os.environ, "PYTHONPATH": ""}, "capture_output": True, "text": True}
    return subprocess.run(command, cwd=cwd, check=True, **keys).stdout


def build(kind: str, sources: Path, into: Path) -> Path:
    """Build a wheel or an sdist without the network, and return its file."""
    code = f"from setuptools import build_meta; print(build_meta.build_{kind}({str(into)!r}))"
    return into / output(sys.executable, "-c", code, cwd=sources).splitlines()[-1]


@pytest.mark.slow
def test_wheel_of_the_sdist_brings_all_files_and_the_command(tmp_path: Path) -> None:
    """Reference: by construction, the files under version control."""
    pytest.importorskip("setuptools", minversion="77", reason="setuptools builds wheels")
    if not (ROOT / ".git").exists():
        pytest.skip("git lists the files of a clone")
    tracked = output("git", "ls-files", "-z", cwd=ROOT).split("\0")[:-1]
    for name in tracked:
        copy = tmp_path / "clone" / name
        copy.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, copy, follow_symlinks=False)
    sdist = build("sdist", tmp_path / "clone", tmp_path / "sdist")
    shutil.unpack_archive(sdist, tmp_path / "unpacked")
    (sources,) = (tmp_path / "unpacked").iterdir()
    wheel = build("wheel", sources, tmp_path / "wheel")
    links = {path.name for path in (ROOT / "protractile").iterdir() if path.is_symlink()}
    of_links = {f"protractile/{name}" for name in tracked if name.split("/")[0] in links}
    own = {name for name in tracked if name.startswith("protractile/")}
    with zipfile.ZipFile(wheel) as archive:
        brought = {name for name in archive.namelist() if ".dist-info/" not in name}
    assert brought == of_links | own - {f"protractile/{name}" for name in links}

    home = tmp_path / "environment"
    venv.create(home)
    program = home / "bin" / "python"
    pip = sys.executable, "-m", "pip", "--python", program, "install", "--no-deps", "--no-index"
    output(*pip, wheel, cwd=tmp_path)
    (site,) = (home / "lib").glob("python*/site-packages")
    # Dependencies are those of this environment, whose own protractile is no folder in it.
    (site / "others.pth").write_text("\n".join(path for path in sys.path if "-packages" in path))
    assert output(program, "-c", "import protractile as p; print(p.__file__)", cwd=tmp_path) == (
        f"{site}/protractile/__init__.py\n"
    )
    assert "sweep" in output(home / "bin" / "protractile", "--help", cwd=tmp_path)


def test_version_equals_changelog_and_citation() -> None:
    version = re.sub(r"\.dev\d+$", "", PYPROJECT["project"]["version"])
    newest = re.search(r"^## \[(.+?)\]", read("CHANGELOG.md"), re.MULTILINE)
    cited = re.search(r"^version: (.+)$", read("CITATION.cff"), re.MULTILINE)
    assert newest[1] == cited[1] == version


@pytest.mark.parametrize(
    ("compiler", "libraries"), [("/no/cc", ""), (sys.executable, "libnone.so.1")]
)
def test_make_names_what_pip_cannot_install(compiler: str, libraries: str) -> None:
    """Reference: by construction. Any program stands for a compiler."""
    command = ["make", "--no-print-directory", "packages-pip", "DOLFINX=pip"]
    command += [f"PYTHON={sys.executable}", f"GMSH_NEEDS={libraries}"]
    made = subprocess.run(
        command, cwd=ROOT, env=os.environ | {"CC": compiler}, capture_output=True, text=True
    )
    assert made.returncode == 2
    assert made.stderr.splitlines()[0] == (
        f"no venv, C compiler, headers of {sys.executable} or libraries of gmsh; install them "
        "(apt install gcc python3-dev python3-venv libgl1 libglu1-mesa libxft2 libxcursor1 "
        "libxinerama1, or dnf install gcc python3-devel libglvnd-glx mesa-libGLU libXft "
        "libXcursor libXinerama); without root, a gmsh without X: make install GMSH_NEEDS= && "
        ".venv/bin/pip install --force-reinstall -i https://gmsh.info/python-packages-dev-nox "
        "gmsh"
    )


def test_a_skipped_test_fails_and_says_why(tmp_path: Path) -> None:
    """Reference: by hand; an expected failure is accepted."""
    each = """import pytest
@pytest.mark.skip(reason="by a mark")
def test_marked(): pass
def test_asked(): pytest.skip("by a call")
@pytest.mark.xfail
def test_expected(): assert False
"""
    (tmp_path / "test_each.py").write_text(each, encoding="utf-8")
    whole = 'import pytest\npytest.skip("all of it", allow_module_level=True)\n'
    (tmp_path / "test_whole.py").write_text(whole, encoding="utf-8")
    command = "-m", "pytest", "-p", "no:cacheprovider", "-p", "tests.no_skips"
    done = python(*command, "--continue-on-collection-errors", folder=tmp_path)
    assert done.returncode == pytest.ExitCode.TESTS_FAILED
    for told in ("by a mark", "by a call", "all of it", "1 failed, 1 xfailed, 2 errors"):
        assert told in done.stdout

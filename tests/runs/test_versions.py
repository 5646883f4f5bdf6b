# SPDX-License-Identifier: LGPL-3.0-or-later
"""What computed: no change of the sources goes unnoticed."""

from pathlib import Path

from runs.folder.versions import packages, program, sources


def test_every_module_counts_wherever_it_lies(tmp_path: Path) -> None:
    package = tmp_path / "package"
    deep = package / "inner" / "innermost"
    deep.mkdir(parents=True)
    for folder in (package, package / "inner", deep):
        (folder / "__init__.py").touch()
    (deep / "a.py").write_text("x = 1\n")
    found = [sources([package])]
    (deep / "a.py").write_text("x = 2\n")
    found.append(sources([package]))
    (deep / "a.py").rename(deep / "b.py")
    found.append(sources([package]))
    (deep / "b.py").rename(package / "b.py")
    found.append(sources([package]))
    assert len(set(found)) == 4


def test_results_are_no_source(tmp_path: Path) -> None:
    (tmp_path / "__init__.py").touch()
    before = sources([tmp_path])
    (tmp_path / "a.txt").touch()
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "a.py").touch()
    assert sources([tmp_path]) == before


def test_the_packages_are_found_by_themselves() -> None:
    names = {package.name for package in packages()}
    assert {"geometry", "dynamics", "beam_model", "shell_model", "runs"} <= names
    assert "tests" not in names
    assert program()["sources"] == sources(packages())

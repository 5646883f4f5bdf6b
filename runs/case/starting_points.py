# SPDX-License-Identifier: LGPL-3.0-or-later
"""Case files that a designer starts from: a kind of machine with the combinations of a standard."""

from __future__ import annotations

from pathlib import Path

from protractile.runs.process.bad_input import BadInput

_TEMPLATES = Path(__file__).parent / "templates"


def write_case(path: str, standard: str, kind: str) -> None:
    """Write a case file that runs, with a kind of machine and the combinations of a standard.

    Raises:
        BadInput: the file exists already, or cannot be written.
    """
    parts = [(_TEMPLATES / f"{name}.toml").read_text("utf-8") for name in (kind, standard)]
    try:
        with open(path, "x", encoding="utf-8") as file:
            file.write("".join(parts))
    except FileExistsError:
        raise BadInput(path, "file", "exists already; give another name") from None
    except OSError as error:
        raise BadInput(path, "file", f"cannot be written ({error.strerror})") from None

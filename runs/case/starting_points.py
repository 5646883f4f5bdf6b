# SPDX-License-Identifier: LGPL-3.0-or-later
"""Case files that a designer starts from: a kind of machine with the combinations of a standard."""

from __future__ import annotations

from enum import StrEnum
from pathlib import Path

from protractile.runs.process.bad_input import BadInput

_TEMPLATES = Path(__file__).parent / "templates"


class Standard(StrEnum):
    """Standards with load combinations."""

    EN13001 = "en13001"
    EN280 = "en280"


class Kind(StrEnum):
    """Kinds of machines."""

    CRANE = "crane"
    LIFT = "lift"


def write_case(path: str, standard: Standard, kind: Kind) -> None:
    """Write a case file that runs, whose numbers of standards are to be checked.

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

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command that exports a model. It imports its libraries when it runs."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import Annotated

import typer

from protractile.runs import options
from protractile.runs.process import ending, ranks
from protractile.runs.process.terminal import printable


def export(
    case: options.CaseFile,
    to: Annotated[str, typer.Option(metavar="opensees|calculix", help="The other program.")],
    model: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="A model of beam elements, or a shell for CalculiX.  \\[default: the last one]",
        ),
    ] = None,
    out: Annotated[
        str | None,
        typer.Option(metavar="FILE", help="Output file.  \\[default: CASE.py, CASE.inp]"),
    ] = None,
) -> int:
    """Write beam elements as a script for OpenSees, or a shell at rest as a deck for CalculiX."""
    from protractile.geometry.typography import choices
    from protractile.runs.case import reading
    from protractile.runs.folder.cache import Cache
    from protractile.runs.process.bad_input import BadInput

    suffixes = {"opensees": "py", "calculix": "inp"}
    if to not in suffixes:
        raise BadInput(case, "--to", f"must be {choices([*suffixes])}, got {to!r}")
    program = import_module(f"protractile.runs.export.{to}")
    checked = reading.load(case)
    selected = reading.select(checked, case, [program.select_model(checked, case, model).name])
    path = Path(out or f"{Path(case).stem}.{suffixes[to]}")
    comm = ranks.enter_mpi(selected.first_shell, case, "export another one with --model")
    if comm is None and ending.launched_rank():
        return 0
    program.write(selected, case, comm, path, Cache.of_user())
    print(printable(str(path)))
    return 0


COMMANDS = (export,)

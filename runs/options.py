# SPDX-License-Identifier: LGPL-3.0-or-later
"""Arguments and options that several commands share, and those of a sweep."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer


class Standard(StrEnum):
    """Standards with load combinations."""

    EN13001 = "en13001"
    EN280 = "en280"


class Kind(StrEnum):
    """Kinds of machines."""

    CRANE = "crane"
    LIFT = "lift"
    ARM = "arm"


CaseFile = Annotated[str, typer.Argument(metavar="CASE.toml", help="The case file.")]
OfStandard = Annotated[
    Standard, typer.Option("--standard", help="The standard of the load combinations.")
]
OfKind = Annotated[Kind, typer.Option("--kind", help="The kind of machine.")]
ModelNames = Annotated[str | None, typer.Option(metavar="NAME,...", help="Run only these models.")]
MeshSize = Annotated[
    float | None, typer.Option(metavar="M", help="Edge length of uniform shell meshes in m.")
]
Modes = Annotated[
    str | None,
    typer.Option(
        metavar="N|auto",
        help="Maximum number of coordinates of each shell segment; auto: as many as the "
        "tolerance requires.",
    ),
]
NoCache = Annotated[
    bool,
    typer.Option(
        "--no-cache", help="Repeat the model reduction of shells, without the user's cache."
    ),
]
Large = Annotated[
    bool, typer.Option("--large", help="Start a run that may take more than 4 GB or an hour.")
]
Vary = Annotated[
    list[str],
    typer.Option(
        metavar="KEY=VALUES",
        help="A key and its values: joint.play=0:0.02:11 (start, stop, count), "
        "segment[2].load=20,40,60. May be repeated; all combinations are run.",
    ),
]
SweepFolder = Annotated[
    str | None,
    typer.Option(metavar="DIR", help="Output folder.  \\[default: runs/out/CASE-sweep]"),
]
Picture = Annotated[
    str | None, typer.Option(metavar="FILE.png", help="Draw the boom into this file.")
]
Folder = Annotated[str, typer.Argument(metavar="DIR", help="The folder of a run.")]
Against = Annotated[
    str | None,
    typer.Option(metavar="MODEL", help="Print the differences of the other models from this one."),
]
Until = Annotated[
    str | None,
    typer.Option(
        metavar="QUANTITY<NUMBER",
        help="Find by bisection the value of the key, to 0.1 %, at which a quantity of "
        "sweep.csv reaches a limit in the unit of the case: 'tip<0.9', 'first_frequency>1.2'.",
    ),
]
Sensitivity = Annotated[
    bool,
    typer.Option(
        "--sensitivity",
        help="Change each number of the case by 1 %, in place of --vary, and print how much "
        "results of a beam change.",
    ),
]
Samples = Annotated[
    int | None,
    typer.Option(
        metavar="N",
        help="Sample the numbers of the case that have a mean and an sd at N quasi-random "
        "points, and print mean, deviation and quantiles of the results of a beam.",
    ),
]


def split_names(models: str | None) -> list[str] | None:
    """Return the names in an option ``--models``; None without the option."""
    return None if models is None else [name.strip() for name in models.split(",")]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The command that serves the live page. It imports its libraries when it runs."""

from __future__ import annotations

from typing import Annotated

import typer

from protractile.runs import options
from protractile.runs.process import ending


def live(
    case: options.CaseFile,
    no_browser: Annotated[
        bool, typer.Option("--no-browser", help="Print the address of the page without opening it.")
    ] = False,
) -> None:
    """Serve a page of a case: change its numbers, and see the results of its beam at once."""
    if not ending.launched_rank():
        from protractile.runs.live.server import serve

        serve(case, browser=not no_browser)


COMMANDS = (live,)

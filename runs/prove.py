# SPDX-License-Identifier: LGPL-3.0-or-later
"""Output of ``prove``: static results of combinations, proofs, and a line for each failed proof."""

from __future__ import annotations

from rich.console import Console

from runs.case.kinds.model import BuildContext
from runs.case.kinds.shell import Shell
from runs.case.schema import Case
from runs.pipeline.combinations import combination_states, combination_tables
from runs.pipeline.combined_shells import shell_states
from runs.pipeline.proofs import proof_table, prove
from runs.process.terminal import message, say, shorten
from runs.report.tables import print_text


def print_proofs(
    case: Case, file: str, console: Console, shell: tuple[Shell, BuildContext] | None = None
) -> int:
    """Print the proofs of a checked case; return 1 if a proof fails, otherwise 0.

    Args:
        case: the case.
        file: its file, for messages.
        console: console for the tables; lines on proofs that fail go to stderr.
        shell: shell to use in place of beam elements, and its build context; all ranks must call.

    Raises:
        NumericsError: a combination has no equilibrium.
    """
    states = combination_states(case) if shell is None else shell_states(case, *shell)
    if not states:
        # Only the first rank has the states of a shell.
        return 0
    results = prove(case, states)
    print_text(console, case.title)
    name = "" if shell is None else shell[0].name
    for table in combination_tables([one.result for one in states], case, name):
        table.show(console)
    proof_table(results, case).show(console)
    print_text(console, results.governing(case.system))
    failed = [one for one in results.proofs if not one.holds]
    for one in failed:
        say(message(f"{shorten(file)}: {one.text(case.system)}. Remedy: {one.remedy}"))
    return 1 if failed else 0

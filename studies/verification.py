# SPDX-License-Identifier: LGPL-3.0-or-later
"""Every proof in one table: value, reference, kind of reference, error, order."""

from __future__ import annotations

from collections.abc import Sequence

from runs.report.numerals import fixed, number
from runs.report.tables import Table
from studies.study import Proof, Study

INTRODUCTION = """\
<!-- SPDX-License-Identifier: LGPL-3.0-or-later -->
# Verification

Each row holds a value against a reference. *Analytic* is a formula; *external*, a published value;
*other code*, another model or method of this project, or the limit of a refinement;
*non-regression*, the value that an earlier release had. The order is the one observed as a mesh or
a step refines. The command that measures all of them, draws their convergence and writes this
table to `runs/out/convergence/verification.md` is

    make convergence

`make test` holds what can be had in seconds to the same references.
"""


def table(study: Study) -> Table:
    """The proofs of one study."""
    return Table.of_rows(
        f"proofs-{study.name}",
        study.title,
        ("what", "value", "reference", "error (%)", "allowed", "", "order", "kind", "source"),
        [_row(proof) for proof in study.proofs],
    )


def markdown(studies: Sequence[Study]) -> str:
    """The page of all studies that prove something."""
    proving = [study for study in studies if study.proofs]
    return "\n".join([INTRODUCTION, *(table(study).markdown() for study in proving)])


def _row(proof: Proof) -> tuple[str, ...]:
    unit = f" {proof.unit}" if proof.unit else ""
    # As many digits as show the error.
    digits = 6 if proof.error < 1.0e-3 else 5
    return (
        proof.what,
        f"{number(proof.value, digits)}{unit}",
        f"{number(proof.reference, digits)}{unit}",
        number(100.0 * proof.error, 2),
        number(100.0 * proof.allowed, 2),
        "✓" if proof.holds else "✗",
        fixed(proof.order, 2),
        proof.kind,
        proof.source,
    )

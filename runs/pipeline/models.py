# SPDX-License-Identifier: LGPL-3.0-or-later
"""The gap system of each model of a case."""

from __future__ import annotations

from dataclasses import replace

from geometry.boom import Boom
from runs.case.build import joined
from runs.case.kinds.model import Built, Joined, ModelTable, Workshop
from runs.case.pulled import with_pulled
from runs.case.schema import Case, Model


def build(case: Case, boom: Boom, model: Model, workshop: Workshop | None = None) -> Built:
    """A model of a case. Collective where it is meshed.

    Args:
        case: its joints have the contact laws.
        boom: of the case.
        model: one of the case's.
        workshop: for a meshed one.

    Raises:
        BoomError: the boom lacks what the model needs.
    """
    return build_on(joined(case, boom, model), case, model, workshop)


def build_on(
    joined: Joined, case: Case, model: ModelTable, workshop: Workshop | None = None
) -> Built:
    """A model on the boom of a case; arguments and errors as of :func:`build`."""
    built = model.build(joined, workshop)
    return replace(built, system=with_pulled(built.system, case, joined.boom))

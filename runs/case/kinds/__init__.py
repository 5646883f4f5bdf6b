# SPDX-License-Identifier: LGPL-3.0-or-later
"""The kinds of models: a module for each, and its place in the list here."""

from collections.abc import Mapping

from runs.case.kinds.finite_element import FiniteElementTable
from runs.case.kinds.kantorovich import KantorovichTable
from runs.case.kinds.model import ModelTable
from runs.case.kinds.rigid import RigidTable
from runs.case.kinds.shell import ShellTable

# What a case file calls each.
KINDS: Mapping[str, type[ModelTable]] = {
    "kantorovich": KantorovichTable,
    "finite-element": FiniteElementTable,
    "shell": ShellTable,
    "rigid": RigidTable,
}

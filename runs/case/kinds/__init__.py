# SPDX-License-Identifier: LGPL-3.0-or-later
"""Kinds of models, one module for each."""

from collections.abc import Mapping

from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.kinds.kantorovich import Kantorovich, Rigid
from protractile.runs.case.kinds.model import ModelTable
from protractile.runs.case.kinds.shell import Shell

# Class of each kind by its name in a case file.
KINDS: Mapping[str, type[ModelTable]] = {
    "kantorovich": Kantorovich,
    "finite-element": BeamElements,
    "shell": Shell,
    "rigid": Rigid,
}

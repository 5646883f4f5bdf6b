# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a case declares, each made once: its boom, and its models on it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from geometry.boom import Boom
from runs.case.build import build_boom
from runs.case.kinds.model import Joined
from runs.case.schema import Case, Model


@dataclass(frozen=True)
class Declared:
    """A case, and what follows from it when it is asked for first."""

    case: Case  #: whose boom can be
    _joined: dict[str, Joined] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def boom(self) -> Boom:
        """As :func:`runs.case.build.build_boom` makes it."""
        return build_boom(self.case)

    def joined(self, model: Model) -> Joined:
        """The boom as one of the case's models sees it."""
        if model.name not in self._joined:
            self._joined[model.name] = model.joined(self.boom)
        return self._joined[model.name]

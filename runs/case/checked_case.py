# SPDX-License-Identifier: LGPL-3.0-or-later
"""A checked case with its boom and models, which are built once."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from geometry.boom import Boom
from runs.case.build import build_boom
from runs.case.kinds.model import Joined
from runs.case.schema import Case, Model


@dataclass(frozen=True)
class CheckedCase:
    """A checked case with its boom and the booms of its models, built on first use."""

    case: Case  #: a case with a valid boom
    _joined: dict[str, Joined] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def boom(self) -> Boom:
        """The boom of the case, from :func:`runs.case.build.build_boom`."""
        return build_boom(self.case)

    def joined(self, model: Model) -> Joined:
        """Return the boom for one of the case's models."""
        if model.name not in self._joined:
            self._joined[model.name] = model.joined(self.boom)
        return self._joined[model.name]

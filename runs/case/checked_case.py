# SPDX-License-Identifier: LGPL-3.0-or-later
"""A checked case with its boom, and the boom with the contact laws of each model."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from geometry.boom import Boom
from runs.case.build import build_boom
from runs.case.kinds.model import ModelBoom
from runs.case.schema import Case, Model


@dataclass(frozen=True)
class CheckedCase:
    """A checked case. Its boom is built once, on first use."""

    case: Case  #: a case with a valid boom
    _model_booms: dict[str, ModelBoom] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def boom(self) -> Boom:
        """The boom of the case, from :func:`runs.case.build.build_boom`."""
        return build_boom(self.case)

    def model_boom(self, model: Model) -> ModelBoom:
        """Return the boom with the contact laws of one of the models of the case."""
        if model.name not in self._model_booms:
            self._model_booms[model.name] = model.model_boom(self.boom)
        return self._model_booms[model.name]

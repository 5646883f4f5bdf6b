# SPDX-License-Identifier: LGPL-3.0-or-later
"""The motions that a case asks of its models, as beams before anything moves."""

from __future__ import annotations

from dataclasses import dataclass, field

from dynamics.motion import Motion
from runs.case.declared import Declared
from runs.case.kinds.model import ModelTable
from runs.case.schema import Model
from runs.pipeline.models import build_on
from runs.pipeline.motion import begun


@dataclass(frozen=True, slots=True)
class Foreseen:
    """Each beam of a case that is built, once.

    Args:
        declared: by the case.
    """

    declared: Declared
    _motions: list[tuple[ModelTable, Motion]] = field(default_factory=list, init=False, repr=False)

    def motion(self, model: Model, beam: ModelTable) -> Motion:
        """The motion that the case asks of a model.

        Args:
            model: one of the case's.
            beam: itself, or what stands for it.

        Raises:
            NumericsError: there is no equilibrium to start from.
        """
        for known, motion in self._motions:
            if known == beam:
                return motion
        case, joined = self.declared.case, self.declared.joined(model)
        motion = begun(build_on(joined, case, beam).system, case)
        self._motions.append((beam, motion))
        return motion

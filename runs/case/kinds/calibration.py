# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of beam models that a shell model of the same boom can calibrate."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import replace
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Self

import numpy as np
from pydantic import Discriminator, Tag

from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line
from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.fields import Name
from protractile.runs.case.kinds.model import (
    BeamTable,
    BuildContext,
    BuiltModel,
    ModelBoom,
    ModelTable,
    Surrogate,
)
from protractile.runs.case.kinds.shell import Shell

if TYPE_CHECKING:
    from protractile.beam_model.calibration import Calibration
    from protractile.shell_model.reduced_shell import ReducedShell


# Keys of the time integration, which a calibrating shell must not have: only the beam moves.
OF_MOTION = ("contact", "step")


# Error paths contain the tag of the table, which is the kind of model.
_Shell = Annotated[
    Annotated[Name, Tag("name")] | Annotated[Shell, Tag("shell")],
    Discriminator(lambda value: "name" if isinstance(value, str) else "shell"),
]


class CalibratedTable(BeamTable, init=False):
    """Keys of a beam model that a shell may calibrate: segment stiffness and station springs."""

    calibrated_by: _Shell | None = None
    """the name of a shell of the case, or the table of another one, that determines the stiffness
    of the segments and the springs of the stations; no calibration unless given"""

    @property
    def needs_shell(self) -> bool:
        return self.calibrated_by is not None

    @property
    def cannot_telescope(self) -> str | None:
        if self.calibrated_by is not None:
            return (
                f"the springs of {self.name!r} are valid at the initial extension, and cannot "
                "telescope; leave calibrated_by out"
            )
        return super().cannot_telescope

    def with_shells(self, update: Mapping[str, object]) -> Self:
        if not isinstance(self.calibrated_by, Shell):
            return self
        return self.model_copy(update={"calibrated_by": self.calibrated_by.with_shells(update)})

    def resolve_shell(self, models: Mapping[str, ModelTable]) -> Self:
        """Return the model with its shell, taken from ``models``, in place of the shell's name."""
        shell = models.get(self.calibrated_by) if isinstance(self.calibrated_by, str) else None
        if not isinstance(shell, Shell):
            return self
        unused: dict[str, object] = dict.fromkeys(OF_MOTION)
        return self.model_copy(update={"calibrated_by": shell.model_copy(update=unused)})

    def check(self, where: str, model_boom: ModelBoom) -> None:
        key = f"{where}.calibrated_by"
        if self.calibrated_by is None:
            super().check(where, model_boom)
            return
        if not isinstance(self.calibrated_by, Shell):
            raise BoomError(
                key, f"{self.calibrated_by!r} is not a shell of the case; give the name of one"
            )
        if self.bonded:
            raise BoomError(
                key, "a bonded model has no stations whose springs could be read; leave it out"
            )
        if self.calibrated_by.contact_line != "near webs":
            raise BoomError(
                key,
                f"the shell touches by {self.calibrated_by.contact_line!r}, where a beam has no "
                "springs; give one with contact_line = 'near webs'",
            )
        for unused in OF_MOTION:
            if getattr(self.calibrated_by, unused) is not None:
                raise BoomError(
                    f"{key}.{unused}",
                    f"of no use: the shell does not move, the beam does; give {where}.{unused}, or "
                    "leave it out",
                )
        self.calibrated_by.check(key, model_boom)
        super().check(where, model_boom)

    def build(self, model_boom: ModelBoom, context: BuildContext | None = None) -> BuiltModel:
        if not isinstance(self.calibrated_by, Shell):
            return super().build(model_boom, context)
        from protractile.beam_model.calibration import calibrate

        built_shell = self.calibrated_by.build(model_boom, context)
        assert built_shell.shell is not None
        begin = perf_counter()
        boom, shell = model_boom.boom, built_shell.shell
        calibration = calibrate(boom, shell.system, shell.probe_responses, self.segments)
        built = self.motion_model(self.build_calibrated(model_boom, calibration), shell, boom)
        seconds = built_shell.seconds | {"calibration": perf_counter() - begin}
        return replace(built, seconds=seconds)

    def build_calibrated(self, model_boom: ModelBoom, calibration: Calibration) -> BuiltModel:
        """Return the calibrated beam model of a boom."""
        from protractile.beam_model.calibration import with_stiffnesses
        from protractile.beam_model.lines import lines

        stiff = with_stiffnesses(model_boom.boom, calibration.segments)
        segments = self.segments(stiff)
        system, along = calibration.beam(stiff, segments), lines(stiff, segments)
        # The coordinates of the springs come after the coordinates of the beam, and do not affect
        # its lines.
        num_coordinates = along[0].rows["deflection"].shape[1]
        basis = np.eye(num_coordinates, system.num_modes)
        return BuiltModel(
            system,
            system.num_modes,
            critical_factor=self.critical_factor(model_boom),
            calibration=calibration,
            lines=[line.transform(basis) for line in along],
        )

    def motion_model(self, built: BuiltModel, shell: ReducedShell, boom: Boom) -> BuiltModel:
        """Return the model to integrate in time: by default the calibrated beam."""
        return built

    def system_without_play(self, boom: Boom) -> tuple[GapSystem, list[Line]] | None:
        # Contacts of a calibrated beam act on its springs, and must be bonded themselves.
        return super().system_without_play(boom) if self.calibrated_by is None else None

    @abstractmethod
    def beam_surrogate(self, boom: Boom) -> Surrogate:
        """Return the surrogate of the beam without its calibration."""

    def surrogate(self, boom: Boom) -> Surrogate:
        surrogate = self.beam_surrogate(boom)
        if not isinstance(self.calibrated_by, Shell):
            return surrogate
        shell = self.calibrated_by.surrogate(boom)
        beam = surrogate.beam.model_copy(update={"calibrated_by": None})
        return Surrogate(
            beam,
            surrogate.coordinates,
            surrogate.memory + shell.memory,
            surrogate.seconds + shell.seconds,
        )

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of beam finite elements."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Literal, Self

import numpy as np
from pydantic import Field

from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import finite_element_segments
from protractile.dynamics.line import Line
from protractile.dynamics.reduction import condense
from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.fields import Flag, Length
from protractile.runs.case.kinds.calibration import CalibratedTable
from protractile.runs.case.kinds.model import BuiltModel, ModelBoom, Surrogate
from protractile.runs.case.kinds.shell import Shell

if TYPE_CHECKING:
    from protractile.shell_model.reduced_shell import ReducedShell

# Maximum number of elements: a larger dense eigenproblem is an input error.
MOST_ELEMENTS = 5_000

# Maximum number of coordinates of each segment with section fields, see the key below.
FIELDS = 40

# Measured cost of a dense eigenproblem of n coordinates: time in s / n³, stored numbers / n².
_EIGEN_TIME, _EIGEN_ROOM = 5.0e-9, 6.0
# Maximum number of coordinates of the beams that estimates and checks build.
_BUILT = 400


class BeamElements(CalibratedTable, init=False):
    """Beam finite elements."""

    kind: Literal["finite-element"]
    """the kind of model"""
    element_length: Length = 0.5
    """the greatest length of an element in m"""
    theory: Literal["euler-bernoulli", "timoshenko"] = "timoshenko"
    """the beam theory, Timoshenko's unless given; a calibrated beam is always shear-flexible,
    with the rotary inertia of its plates"""
    rotary_inertia: Flag = True
    """whether the rotary inertia is kept"""
    bonded_joints: Flag = Field(False, alias="bonded")
    """whether the segments are bonded at the stations, without play"""
    section_fields: Flag = Field(
        False,
        description="whether a calibrated beam has the section's own fields besides: bending and "
        f"breathing and distortion, in {FIELDS} coordinates of each segment at most",
    )

    @property
    def needs_plates(self) -> bool:
        return self.theory == "timoshenko" or super().needs_plates

    @property
    def plates_remedy(self) -> str:
        return "" if super().needs_plates else ", or theory = 'euler-bernoulli' in the model"

    @property
    def bonded(self) -> bool:
        return self.bonded_joints

    def check(self, where: str, model_boom: ModelBoom) -> None:
        if self.section_fields and self.calibrated_by is None:
            raise BoomError(
                f"{where}.section_fields",
                "only a calibrated beam has them; give calibrated_by, or leave it out",
            )
        if self.bonded and self.contact:
            raise BoomError(f"{where}.contact", "a bonded model has no contact; leave it out")
        length = max(segment.length for segment in model_boom.boom.segments)
        if length / self.element_length > MOST_ELEMENTS:
            raise BoomError(
                f"{where}.element_length",
                f"{self.element_length:g} m makes more than {MOST_ELEMENTS} elements of a "
                f"segment; it must be at least {length / MOST_ELEMENTS:.3g} m",
            )
        super().check(where, model_boom)

    def describe(self) -> str:
        if isinstance(self.calibrated_by, Shell):
            more = " and section fields" if self.section_fields else ""
            return (
                f"elements of {self.element_length:g} m, with springs{more} by a shell of "
                f"{self.calibrated_by.mesh_size:g} m"
            )
        return f"{self.theory}, elements of {self.element_length:g} m"

    def segments(self, boom: Boom) -> list[SegmentModel]:
        if self.calibrated_by is not None:
            return finite_element_segments(boom, self.element_length, "timoshenko", True)
        return finite_element_segments(boom, self.element_length, self.theory, self.rotary_inertia)

    def motion_model(self, built: BuiltModel, shell: ReducedShell, boom: Boom) -> BuiltModel:
        if not self.section_fields:
            return super().motion_model(built, shell, boom)
        system, shapes = condense(shell.system, FIELDS * len(boom.segments))
        along: list[Line] = []
        if shell.fields is not None:
            from protractile.shell_model.stress.lines import lines

            along = [line.transform(shapes) for line in lines(shell.fields, boom)]
        return replace(built, system=system, num_dofs=system.num_modes, lines=along)

    def coarsen(self, boom: Boom) -> Self:
        length = self.element_length * max(1.0, self._coordinates(boom) / _BUILT)
        return self.model_copy(update={"element_length": length})

    def beam_surrogate(self, boom: Boom) -> Surrogate:
        coordinates = self._coordinates(boom)
        return Surrogate(
            self.coarsen(boom),
            coordinates,
            memory=8.0 * _EIGEN_ROOM * coordinates**2,
            seconds=_EIGEN_TIME * coordinates**3,
        )

    def _coordinates(self, boom: Boom) -> int:
        nodes = sum(
            np.ceil(segment.length / self.element_length)
            + 1
            + len(boom.stations_of(number))
            + len(boom.observed_places(number))
            for number, segment in enumerate(boom.segments)
        )
        return int((5 if boom.spatial else 2) * nodes)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What models leave besides trajectories: fields, stresses, meshes of shells, lines of beams."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import xarray as xr

from dynamics.damping import pressed_modes
from dynamics.line import Line, Quantity
from dynamics.trajectory import Trajectory
from geometry.arrays import Array
from geometry.boom import Boom
from runs.pipeline.at_rest import positions
from runs.pipeline.modes import MODES
from runs.pipeline.results import CONVENTIONS
from shell_model.stress.field_series import series_times, write_field_series
from shell_model.stress.history import StressSummary, near_places, sum_up
from shell_model.stress.stresses import ShellStress

if TYPE_CHECKING:
    from geometry.plating import PlatedMesh
    from shell_model.reduced_shell import ReducedShell


STRESSES = "stress.nc"
SERIES = "fields"

# Enough for a film.
FRAMES = 61


@dataclass(frozen=True, slots=True)
class ShellOutput:
    """Everything of one shell that goes to files of its own.

    Args:
        fields: points, triangles, segment, modes and stresses of the mesh, ``state`` (time,
            mode), and ``pressed_mode_shape`` (pressed_mode in Hz, mode) of the boom
            with its joints pressed.
        stresses: von Mises stresses near stations and supports over time.
        largest: the largest of them, and what the walls carry then.
        meshes: name of the segment → its mesh.
    """

    fields: xr.Dataset
    stresses: xr.Dataset
    largest: StressSummary
    meshes: dict[str, PlatedMesh]

    @property
    def modes(self) -> xr.Dataset | None:
        """Fields whose instants are the modes, at their frequencies in Hz; None without any."""
        if "pressed_mode" not in self.fields.dims:
            return None
        return self.fields.drop_vars(["state", "time"]).assign(
            state=(("time", "mode"), self.fields["pressed_mode_shape"].values),
            time=("time", self.fields["pressed_mode"].values, {"units": "Hz"}),
        )

    @classmethod
    def of(
        cls, boom: Boom, name: str, reduced: ReducedShell, trajectory: Trajectory
    ) -> ShellOutput:
        """From a shell that has moved; on rank 0.

        Args:
            boom: what it is a shell of.
            name: of the model.
            reduced: the shell.
            trajectory: its motion.
        """
        assert reduced.fields is not None
        names = [segment.name for segment in boom.segments]
        fields = reduced.fields.assign(
            state=(("time", "mode"), trajectory.states.astype(np.float32)),
            time=("time", trajectory.time, {"units": "s"}),
            **_modes(reduced),
        ).assign_attrs(model=name)
        shell = ShellStress.of(fields)
        stresses = near_places(shell, _places(boom), names).assign_attrs(model=name)
        meshes = dict(zip(names, reduced.meshes, strict=True))
        return cls(fields, stresses, sum_up(shell, stresses), meshes)

    def write_files(self, folder: Path, prefix: str) -> None:
        """Stresses, series and meshes into a run's folder; the fields stand in a file before.

        Args:
            folder: of the run.
            prefix: of the files' names.
        """
        self.stresses.assign_attrs(Conventions=CONVENTIONS).to_netcdf(
            folder / f"{prefix}{STRESSES}", engine="scipy"
        )
        # Of names joined by a hyphen two may be the same.
        meshes, series = folder / "mesh" / prefix.removesuffix("-"), folder / SERIES
        for place in (meshes, series):
            place.mkdir(parents=True, exist_ok=True)
        write_field_series(self.fields, series, series_times(self.fields))
        if (modes := self.modes) is not None:
            of_modes = modes.assign_attrs(model=f"{modes.attrs['model']}-modes")
            write_field_series(of_modes, series, modes["time"].values.tolist())
        for segment, mesh in self.meshes.items():
            mesh.write(meshes / f"{segment}.vtu")
            mesh.write_gmsh(meshes / f"{segment}.msh")


class MovedSegment(NamedTuple):
    """Along one segment, x (num_places,) in m, rising, the quantities (num_frames, num_places)."""

    x: Array
    read: Mapping[Quantity, Array]


class BeamOutput(NamedTuple):
    """Of all segments at so many times (num_frames,) in s."""

    time: Array
    segments: list[MovedSegment]

    @classmethod
    def of(cls, lines: Sequence[Line], trajectory: Trajectory) -> BeamOutput:
        """From a beam that has moved; where something jumps what is beyond is kept."""
        steps = frames(trajectory.time.size)
        moved = []
        for line in lines:
            last = np.append(np.diff(line.x) > 0.0, True)
            read = line.read(trajectory.states[steps])
            moved.append(
                MovedSegment(line.x[last], {name: along[:, last] for name, along in read.items()})
            )
        return cls(trajectory.time[steps], moved)


def frames(num_times: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Positions of the output times that a film shows, spread evenly, the ends included."""
    return np.unique(np.linspace(0, num_times - 1, FRAMES).round().astype(np.intp))


def _places(boom: Boom) -> list[float]:
    """x of everything that carries a force into a segment at one place, rising."""
    places = {x for number in range(len(boom.segments)) for x in boom.stations_of(number)}
    places |= {support.x for segment in boom.segments for support in segment.supports}
    return sorted(places)


def _modes(reduced: ReducedShell) -> dict[str, Any]:
    """Those of the boom with its joints pressed, the largest displacement of each 1 m."""
    assert reduced.fields is not None
    system = reduced.system.gathered()
    rest = positions(system)
    if not rest:
        return {}
    omega, shapes = pressed_modes(system, rest[0.0])
    modes = shapes[:, :MODES].T
    moved = np.tensordot(modes, reduced.fields["modes"].values, axes=1)
    largest = np.sqrt((moved**2).sum(axis=2)).max(axis=1)
    return {
        "pressed_mode": ("pressed_mode", omega[:MODES] / (2.0 * np.pi), {"units": "Hz"}),
        "pressed_mode_shape": (("pressed_mode", "mode"), modes / largest[:, None]),
    }

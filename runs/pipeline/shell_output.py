# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a shell leaves besides its trajectory: its fields, its stresses, its meshes."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr

from dynamics.damping import pressed_modes
from dynamics.trajectory import Trajectory
from geometry.boom import Boom
from geometry.drawing import drives_below
from geometry.load import Load
from runs.pipeline.at_rest import positions
from runs.pipeline.modes import MODES
from runs.pipeline.results import CONVENTIONS
from shell_model.pictures.deformation import DOWN, MASS, SPRING, UP, Sign
from shell_model.pictures.field_series import series_times, write_field_series
from shell_model.stress.history import StressSummary, near_places, sum_up
from shell_model.stress.stresses import ShellStress

if TYPE_CHECKING:
    from geometry.plating import PlatedMesh
    from shell_model.reduced_shell import ReducedShell


STRESSES = "stress.nc"
SERIES = "fields"


@dataclass(frozen=True, slots=True)
class ShellOutput:
    """Everything of one shell that goes to files of its own.

    Args:
        fields: points, triangles, segment, modes and stresses of the mesh, ``state`` (time,
            mode), the joints, and ``pressed_mode_shape`` (pressed_mode in Hz, mode) of the boom
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
            **_joints(boom),
            **_stops(boom),
            **_lugs(boom),
            **_signs(boom),
            **_modes(reduced),
        ).assign_attrs(model=name, segments=json.dumps(names), drawn=json.dumps(_drawn(boom)))
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


def _places(boom: Boom) -> list[float]:
    """x of everything that carries a force into a segment at one place, rising."""
    places = {x for number in range(len(boom.segments)) for x in boom.stations_of(number)}
    places |= {support.x for segment in boom.segments for support in segment.supports}
    return sorted(places)


def _stops(boom: Boom) -> dict[str, Any]:
    """Where the ground stops which segment, on which side (1 above, -1 below), and how far off."""
    sides = [
        (stop, side)
        for stop in boom.stops
        for side, stiffness in ((1.0, stop.stiffness), (-1.0, stop.stiffness_below))
        if stiffness > 0.0
    ]
    if not sides:
        return {}
    places = np.array([stop.x for stop, _ in sides])
    clearances = np.array([stop.clearance for stop, _ in sides])
    return {
        "stop_segment": ("stop", np.array([stop.segment for stop, _ in sides], dtype=np.int32)),
        "stop_x": ("stop", places, {"units": "m"}),
        "stop_side": ("stop", np.array([side for _, side in sides])),
        "stop_clearance": ("stop", clearances, {"units": "m"}),
    }


def _lugs(boom: Boom) -> dict[str, Any]:
    """Where cylinders meet segments, and the unit vectors from the ground to there."""
    if not boom.cylinders:
        return {}
    along, up = np.array([cylinder.direction for cylinder in boom.cylinders]).T
    segments = np.array([cylinder.segment for cylinder in boom.cylinders], dtype=np.int32)
    return {
        "lug_segment": ("lug", segments),
        "lug_x": ("lug", np.array([cylinder.x for cylinder in boom.cylinders]), {"units": "m"}),
        "lug_along": ("lug", along),
        "lug_up": ("lug", up),
    }


def _signs(boom: Boom) -> dict[str, Any]:
    """Elastic supports, masses and point loads along z, as pictures draw them."""
    found = [
        Sign(number, support.x, SPRING)
        for number, segment in enumerate(boom.segments)
        for support in segment.supports
        if support.stiffness is not None
    ]
    for number, segment in enumerate(boom.segments):
        found += [Sign(number, mass.x, MASS) for mass in segment.masses]
    for load in boom.loads:
        if load.x is not None and load.direction == "z" and type(load) is Load:
            found.append(Sign(load.segment, load.x, UP if load.magnitude > 0.0 else DOWN))
    if not found:
        return {}
    segments, places, kinds = zip(*dict.fromkeys(found), strict=True)
    return {
        "sign_segment": ("sign", np.array(segments, dtype=np.int32)),
        "sign_x": ("sign", np.array(places), {"units": "m"}),
        "sign_kind": ("sign", np.array(kinds, dtype=np.int32)),
    }


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


def _drawn(boom: Boom) -> list[list[str]]:
    """The results that together tell how far each segment is drawn along."""
    drives = [drives_below(boom.joints, number) for number in range(len(boom.segments))]
    return [[f"drawn_out-{n + 1}" if n else "drawn_out" for n in below] for below in drives]


def _joints(boom: Boom) -> dict[str, Any]:
    """Which segments have play in one another, how much, and at which stations they touch.

    ``station_joint`` (station) is -1 at stops. Empty dimensions, which netCDF 3 does not have, are
    left out.
    """
    joints = [joint for joint in boom.joints if not joint.tied]
    if not joints:
        return {}
    lateral = [np.nan if j.lateral_clearance is None else j.lateral_clearance for j in joints]
    per_direction = [number for number, joint in enumerate(joints) for _ in joint.stations]
    of_stations = per_direction * (2 if boom.spatial else 1) + [-1] * len(boom.stops)
    return {
        "joint_outer": ("joint", np.array([j.outer for j in joints], dtype=np.int32)),
        "joint_inner": ("joint", np.array([j.inner for j in joints], dtype=np.int32)),
        "clearance": ("joint", np.array([j.clearance for j in joints]), {"units": "m"}),
        "lateral_clearance": ("joint", np.array(lateral), {"units": "m"}),
        "station_joint": ("station", np.array(of_stations, dtype=np.int32)),
    }

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Output of models: fields, stresses and meshes of shells, deflections of beams.

A field series for ParaView is a ``.vtu`` file for each time, and a ``.pvd`` file that lists them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt

from protractile.analysis.equilibria import equilibria
from protractile.analysis.modes import MODES
from protractile.dynamics.damping import closed_contact_modes
from protractile.dynamics.line import Line, LineQuantity
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.runs.pipeline.results import CONVENTIONS
from protractile.shell_model.stress.history import StressSummary, stress_near_places, summarise
from protractile.shell_model.stress.stresses import COMPONENTS, FACES, ShellStress, Stress

if TYPE_CHECKING:
    import xarray as xr

    from protractile.geometry.plating import PlatedMesh
    from protractile.shell_model.reduced_shell import ReducedShell


STRESSES = "stress.nc"
SERIES = "fields"

# Number of frames of an animation.
FRAMES = 61


# Maximum number of frames of a series, and of triangles in all frames: at about 110 bytes per
# triangle, a series has at most 110 MB. Compression would hardly reduce this.
SERIES_FRAMES, TRIANGLES = 51, 1_000_000


@dataclass(frozen=True, slots=True)
class ShellOutput:
    """Motion, stresses and meshes of a shell, which are written to files."""

    #: mesh with modes and their stresses; ``state`` (time, mode), the coordinates of the motion;
    #: ``contact_mode_shape`` (contact_mode in Hz, mode), the modes with closed contacts
    fields: xr.Dataset
    stresses: xr.Dataset  #: von Mises stresses near stations and supports over time
    #: largest of these stresses, and the forces in the walls at the time of this stress
    largest: StressSummary
    meshes: dict[str, PlatedMesh]  #: mesh of each segment, by name

    @property
    def modes(self) -> xr.Dataset | None:
        """The fields with contact modes as ``state`` and frequencies in Hz as ``time``, or None."""
        if "contact_mode" not in self.fields.dims:
            return None
        return self.fields.drop_vars(["state", "time"]).assign(
            state=(("time", "mode"), self.fields["contact_mode_shape"].values),
            time=("time", self.fields["contact_mode"].values, {"units": "Hz"}),
        )

    @classmethod
    def of(
        cls,
        boom: Boom,
        name: str,
        reduced: ReducedShell,
        trajectory: Trajectory,
    ) -> ShellOutput:
        """Return the output of a shell after its motion, on rank 0."""
        assert reduced.fields is not None
        names, states = [segment.name for segment in boom.segments], trajectory.states
        fields = reduced.fields.assign(
            # A hoisted load adds a coordinate, which is left out.
            state=(("time", "mode"), states[:, : reduced.system.num_modes].astype(np.float32)),
            time=("time", trajectory.time, {"units": "s"}),
            **_modes(reduced),
        ).assign_attrs(model=name)
        shell = ShellStress.from_fields(fields)
        stresses = stress_near_places(shell, force_places(boom), names).assign_attrs(model=name)
        meshes = dict(zip(names, reduced.meshes, strict=True))
        return cls(fields, stresses, summarise(shell, stresses), meshes)

    def write_files(self, folder: Path, prefix: str) -> None:
        """Write stresses, field series and meshes to a folder that already has the fields.

        ``prefix`` is that of the file names.
        """
        self.stresses.assign_attrs(Conventions=CONVENTIONS).to_netcdf(
            folder / f"{prefix}{STRESSES}", engine="scipy"
        )
        # A folder for each model, since names joined by a hyphen may coincide.
        meshes, series = folder / "mesh" / prefix.removesuffix("-"), folder / SERIES
        for place in (meshes, series):
            place.mkdir(parents=True, exist_ok=True)
        times = self.fields["time"].values
        frames = max(2, min(SERIES_FRAMES, TRIANGLES // self.fields.sizes["triangle"]))
        even = np.linspace(times[0], times[-1], frames).tolist()
        write_field_series(self.fields, series, even)
        if (modes := self.modes) is not None:
            of_modes = modes.assign_attrs(model=f"{modes.attrs['model']}-modes")
            write_field_series(of_modes, series, modes["time"].values.tolist())
        for segment, mesh in self.meshes.items():
            mesh.write(meshes / f"{segment}.vtu")
            mesh.write_gmsh(meshes / f"{segment}.msh")


class SegmentMotion(NamedTuple):
    """Deflections and section forces (num_frames, num_places) of a segment at x (num_places,)."""

    x: Array
    curves: Mapping[LineQuantity, Array]


class BeamOutput(NamedTuple):
    """Deflections and section forces of the segments of a beam at times (num_frames,) in s."""

    time: Array
    segments: list[SegmentMotion]

    @classmethod
    def of(cls, lines: Sequence[Line], trajectory: Trajectory) -> BeamOutput:
        """Return the output of a beam.

        Where a section force jumps, the output has the value on the side of the tip.
        """
        steps = frame_indices(trajectory.time.size)
        moved = []
        for line in lines:
            last = np.append(np.diff(line.x) > 0.0, True)
            read = line.read(trajectory.states[steps])
            moved.append(
                SegmentMotion(line.x[last], {name: along[:, last] for name, along in read.items()})
            )
        return cls(trajectory.time[steps], moved)


def frame_indices(num_times: int) -> np.ndarray[tuple[int], np.dtype[np.intp]]:
    """Return evenly spaced indices of output times for an animation, from first to last."""
    return np.unique(np.linspace(0, num_times - 1, FRAMES).round().astype(np.intp))


def force_places(boom: Boom) -> list[float]:
    """Return the x in m of all point forces on the segments, in ascending order."""
    places = {x for number in range(len(boom.segments)) for x in boom.stations_of(number)}
    places |= {support.x for segment in boom.segments for support in segment.supports}
    return sorted(places)


def _modes(reduced: ReducedShell) -> dict[str, Any]:
    """Return dataset variables of the modes with closed contacts, scaled to a maximum of 1 m."""
    assert reduced.fields is not None
    system = reduced.system.gather_loads()
    rest = equilibria(system)
    if not rest:
        return {}
    omega, shapes = closed_contact_modes(system, rest[0.0])
    modes = shapes[:, :MODES].T
    moved = np.tensordot(modes, reduced.fields["modes"].values, axes=1)
    largest = np.sqrt((moved**2).sum(axis=2)).max(axis=1)
    return {
        "contact_mode": ("contact_mode", omega[:MODES] / (2.0 * np.pi), {"units": "Hz"}),
        "contact_mode_shape": (("contact_mode", "mode"), modes / largest[:, None]),
    }


def write_field_series(fields: xr.Dataset, folder: Path, times: Sequence[float]) -> list[Path]:
    """Write displacements and stresses for ParaView at the output times nearest to ``times``.

    Each ``.vtu`` file has displacements in m at points. On triangles it has the number of the
    segment, and in Pa the von Mises stresses of faces and middle, and six stress components.

    Args:
        fields: fields of :mod:`.stress.fields`, and the modal coordinates ``state``
            (time, mode); attribute ``model``.
        folder: folder for ``MODEL.pvd`` and ``MODEL-NUMBER.vtu``.
        times: times in s.

    Returns:
        The files, the ``.pvd`` last.

    Raises:
        ValueError: a time lies outside the run.
    """
    import meshio

    output_times = np.asarray(fields["time"].values, dtype=float)
    for t in times:
        if not output_times[0] <= t <= output_times[-1]:
            raise ValueError(
                f"time must be between {output_times[0]:g} and {output_times[-1]:g} s, got {t:g}"
            )
    steps = np.unique([np.abs(output_times - t).argmin() for t in times])
    shell, model = ShellStress.from_fields(fields), str(fields.attrs["model"])
    segment = (fields["segment"].values + 1).astype(np.int32)
    modes, states = fields["modes"].values, fields["state"].values[steps]
    digits = len(str(steps.size - 1))
    written = []
    for number, (state, stress) in enumerate(
        zip(states, shell.instants(output_times[steps].tolist()), strict=True)
    ):
        path = folder / f"{model}-{number:0{digits}}.vtu"
        displacement = np.tensordot(state, modes, axes=1).astype(np.float32)
        meshio.Mesh(
            fields["points"].values,
            [("triangle", fields["triangles"].values)],
            point_data={"displacement (m)": displacement},
            cell_data={"segment": [segment], **_stresses_by_name(stress)},
        ).write(path, compression=None)
        written.append(path)
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for t, path in zip(output_times[steps], written, strict=True):
        ElementTree.SubElement(collection, "DataSet", timestep=f"{t:.9g}", part="0", file=path.name)
    ElementTree.indent(root)
    listing = folder / f"{model}.pvd"
    ElementTree.ElementTree(root).write(listing, encoding="utf-8", xml_declaration=True)
    return [*written, listing]


def _stresses_by_name(stress: Stress) -> dict[str, list[npt.NDArray[np.float32]]]:
    """Return the von Mises stresses and stress components of triangles, by name."""
    components = np.concatenate([stress.membrane, stress.bending], axis=1)
    return {f"von Mises, {face} (Pa)": [stress.von_mises(face)] for face in FACES} | {
        f"{name.replace('_', ' ')} (Pa)": [values]
        for name, values in zip(COMPONENTS, components.T, strict=True)
    }

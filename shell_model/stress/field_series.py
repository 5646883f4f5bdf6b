# SPDX-License-Identifier: LGPL-3.0-or-later
"""Field series for ParaView: a ``.vtu`` file for each time, and a ``.pvd`` file that lists them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import meshio
import numpy as np
import numpy.typing as npt
import xarray as xr

from shell_model.stress.stresses import COMPONENTS, FACES, ShellStress, Stress

# Maximum number of frames of a series, and of triangles in all frames: at about 110 bytes per
# triangle, a series has at most 110 MB. Compression would hardly reduce this.
FRAMES, TRIANGLES = 51, 1_000_000


def series_times(fields: xr.Dataset) -> list[float]:
    """Return the evenly spaced times of a series in s, from the start to the end of the run."""
    times = fields["time"].values
    frames = max(2, min(FRAMES, TRIANGLES // fields.sizes["triangle"]))
    return [float(t) for t in np.linspace(times[0], times[-1], frames)]


def write_field_series(fields: xr.Dataset, folder: Path, times: Sequence[float]) -> list[Path]:
    """Write displacements and stresses for ParaView at the output times nearest to ``times``.

    Each ``.vtu`` file has displacements in m at points. On triangles it has the number of the
    segment, and in Pa the von Mises stresses of faces and middle, and six stress components.

    Args:
        fields: fields of ``shell_model.stress.fields``, and the modal coordinates ``state``
            (time, mode); attribute ``model``.
        folder: folder for ``MODEL.pvd`` and ``MODEL-NUMBER.vtu``.
        times: times in s.

    Returns:
        The files, the ``.pvd`` last.

    Raises:
        ValueError: a time lies outside the run.
    """
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

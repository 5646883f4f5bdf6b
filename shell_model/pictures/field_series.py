# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fields over time for ParaView: one ``.vtu`` for each time, and a ``.pvd`` that lists them."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import numpy.typing as npt
import xarray as xr

from shell_model.pictures.vtu import TriangleFiles
from shell_model.stress.stresses import COMPONENTS, FACES, ShellStress, Stress

# A series has so many frames at most, and fewer of a fine mesh: all triangles of all frames, of
# about 50 bytes each, make 50 MB at most. The paper's boom takes 14 MB.
FRAMES, TRIANGLES = 51, 1_000_000


def series_times(fields: xr.Dataset) -> list[float]:
    """As many as a series may have, evenly spread over the run, its ends included, in s."""
    times = fields["time"].values
    frames = max(2, min(FRAMES, TRIANGLES // fields.sizes["triangle"]))
    return [float(t) for t in np.linspace(times[0], times[-1], frames)]


def write_field_series(fields: xr.Dataset, folder: Path, times: Sequence[float]) -> list[Path]:
    """Write displacement and stresses at some times; a program opens them by the ``.pvd``.

    Each ``.vtu`` has at the points the displacement in m, and on the triangles the number of
    the segment, von Mises stresses of both faces and the middle, and the six ``COMPONENTS``,
    all in Pa. The times in the ``.pvd`` are those of the output that are next to the given ones.

    Args:
        fields: what ``shell_model.stress.fields`` gathers, and the modal coordinates ``state``
            (time, mode); attribute ``model``.
        folder: gets ``MODEL.pvd`` and ``MODEL-NUMBER.vtu``.
        times: in s.

    Returns:
        The files, the ``.pvd`` last.

    Raises:
        ValueError: a time lies outside the run.
    """
    known = np.asarray(fields["time"].values, dtype=float)
    for t in times:
        if not known[0] <= t <= known[-1]:
            raise ValueError(f"time must be between {known[0]:g} and {known[-1]:g} s, got {t:g}")
    steps = np.unique([np.abs(known - t).argmin() for t in times])
    shell, model = ShellStress.of(fields), str(fields.attrs["model"])
    triangles = TriangleFiles(fields["points"].values, fields["triangles"].values)
    segment = (fields["segment"].values + 1).astype(np.int32)
    modes, states = fields["modes"].values, fields["state"].values[steps]
    digits = len(str(steps.size - 1))
    written = []
    for number, (state, stress) in enumerate(
        zip(states, shell.instants(known[steps].tolist()), strict=True)
    ):
        path = folder / f"{model}-{number:0{digits}}.vtu"
        moved = np.tensordot(state, modes, axes=1).astype(np.float32)
        triangles.write(path, {"displacement (m)": moved}, {"segment": segment, **_named(stress)})
        written.append(path)
    collection = folder / f"{model}.pvd"
    names = [path.name for path in written]
    _write_collection(collection, known[steps].tolist(), names)
    return [*written, collection]


def _named(stress: Stress) -> dict[str, npt.NDArray[np.generic]]:
    """What is on triangles, by its name."""
    components = np.concatenate([stress.membrane, stress.bending], axis=1)
    return {f"von Mises, {face} (Pa)": stress.von_mises(face) for face in FACES} | {
        f"{name.replace('_', ' ')} (Pa)": values
        for name, values in zip(COMPONENTS, components.T, strict=True)
    }


def _write_collection(path: Path, times: Sequence[float], names: Sequence[str]) -> None:
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for t, name in zip(times, names, strict=True):
        ElementTree.SubElement(collection, "DataSet", timestep=f"{t:.9g}", part="0", file=name)
    ElementTree.indent(root)
    ElementTree.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Field series for ParaView: one ``.vtu`` for each time, and a ``.pvd`` that lists them."""

from __future__ import annotations

import sys
import zlib
from base64 import b64encode
from collections.abc import Mapping, Sequence
from pathlib import Path
from xml.etree import ElementTree
from xml.sax.saxutils import quoteattr

import numpy as np
import numpy.typing as npt
import xarray as xr

from geometry.arrays import Array
from shell_model.stress.stresses import COMPONENTS, FACES, ShellStress, Stress

# A series has at most this number of frames, and fewer of a fine mesh: all triangles of all frames,
# of about 60 bytes each, make 60 MB at most. The paper's boom takes 16 MB.
FRAMES, TRIANGLES = 51, 1_000_000

Values = npt.NDArray[np.generic]

# Bytes per block, and level of compression of what packs well: stresses and displacements pack to
# nine tenths at any level, which takes half of the time of a series.
BLOCK, LEVEL = 1 << 16, 1

_TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "u1": "UInt8"}
_ORDER = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
_TRIANGLE = 5


def series_times(fields: xr.Dataset) -> list[float]:
    """Return the permitted number of times, evenly spread over the run with its ends, in s."""
    times = fields["time"].values
    frames = max(2, min(FRAMES, TRIANGLES // fields.sizes["triangle"]))
    return [float(t) for t in np.linspace(times[0], times[-1], frames)]


def write_field_series(fields: xr.Dataset, folder: Path, times: Sequence[float]) -> list[Path]:
    """Write displacement and stresses at some times; ParaView opens them by the ``.pvd``.

    Each ``.vtu`` has at the points the displacement in m, and on the triangles the number of
    the segment, von Mises stresses of both faces and the middle, and the six ``COMPONENTS``,
    all in Pa. The times in the ``.pvd`` are those of the output that are next to the given ones.

    Args:
        fields: those of ``shell_model.stress.fields``, and the modal coordinates ``state``
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
    root = ElementTree.Element("VTKFile", type="Collection", version="0.1")
    collection = ElementTree.SubElement(root, "Collection")
    for t, path in zip(known[steps], written, strict=True):
        ElementTree.SubElement(collection, "DataSet", timestep=f"{t:.9g}", part="0", file=path.name)
    ElementTree.indent(root)
    listing = folder / f"{model}.pvd"
    ElementTree.ElementTree(root).write(listing, encoding="utf-8", xml_declaration=True)
    return [*written, listing]


def _named(stress: Stress) -> dict[str, npt.NDArray[np.generic]]:
    """Return the data on triangles by their names."""
    components = np.concatenate([stress.membrane, stress.bending], axis=1)
    return {f"von Mises, {face} (Pa)": stress.von_mises(face) for face in FACES} | {
        f"{name.replace('_', ' ')} (Pa)": values
        for name, values in zip(COMPONENTS, components.T, strict=True)
    }


class TriangleFiles:
    """Writer of files with common points (num_points, 3) in m, triangles (num_triangles, 3)."""

    def __init__(self, points: Array, triangles: npt.NDArray[np.int32]) -> None:
        count = len(triangles)
        corners = np.ascontiguousarray(triangles, dtype=np.int32)
        self._begin = (
            f'<VTKFile type="UnstructuredGrid" version="0.1" byte_order="{_ORDER}" '
            'compressor="vtkZLibDataCompressor">\n<UnstructuredGrid>\n'
            f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{count}">\n'
            f"<Points>\n{_packed('Points', points)}</Points>\n<Cells>\n"
            + _packed("connectivity", corners.ravel())
            + _packed("offsets", np.arange(3, 3 * count + 3, 3, dtype=np.int32))
            + _packed("types", np.full(count, _TRIANGLE, dtype=np.uint8))
            + "</Cells>\n"
        )

    def write(
        self, path: Path, at_points: Mapping[str, Values], on_triangles: Mapping[str, Values]
    ) -> None:
        """Write values at points (num_points, ...), on triangles (num_triangles, ...), by names."""
        data = [
            f"<{kind}>\n{''.join(_packed(*entry) for entry in arrays.items())}</{kind}>\n"
            for kind, arrays in (("PointData", at_points), ("CellData", on_triangles))
        ]
        end = "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
        path.write_text(f"{self._begin}{''.join(data)}{end}", encoding="utf-8")


def _packed(name: str, values: Values) -> str:
    """Return an array in VTK's format: sizes of compressed blocks, and the blocks, in base 64."""
    raw = np.ascontiguousarray(values).tobytes()
    level = 0 if values.dtype == np.float32 else LEVEL
    blocks = [zlib.compress(raw[k : k + BLOCK], level) for k in range(0, len(raw), BLOCK)]
    last = len(raw) % BLOCK
    sizes = np.array([len(blocks), BLOCK, last, *map(len, blocks)], dtype=np.uint32)
    content = b64encode(sizes.tobytes()) + b64encode(b"".join(blocks))
    several = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    return (
        f'<DataArray type="{_TYPES[values.dtype.str[1:]]}" Name={quoteattr(name)}{several} '
        f'format="binary">{content.decode("ascii")}</DataArray>\n'
    )

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Triangles with data as ``.vtu`` files, whose mesh, the same in all, is packed once."""

from __future__ import annotations

import sys
import zlib
from base64 import b64encode
from collections.abc import Mapping
from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array

Values = npt.NDArray[np.generic]

# Bytes that are packed together, and how hard: stresses, which are most of a file, pack to nine
# tenths at any level.
BLOCK, LEVEL = 1 << 16, 1

_TYPES = {"f4": "Float32", "f8": "Float64", "i4": "Int32", "u1": "UInt8"}
_ORDER = "LittleEndian" if sys.byteorder == "little" else "BigEndian"
_TRIANGLE = 5


class TriangleFiles:
    """Writes files of the same points (num_points, 3) in m and triangles (num_triangles, 3)."""

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
    """An array as VTK has it: how long its packed blocks are, and the blocks, in base 64."""
    raw = np.ascontiguousarray(values).tobytes()
    blocks = [zlib.compress(raw[k : k + BLOCK], LEVEL) for k in range(0, len(raw), BLOCK)]
    last = len(raw) % BLOCK
    sizes = np.array([len(blocks), BLOCK, last, *map(len, blocks)], dtype=np.uint32)
    content = b64encode(sizes.tobytes()) + b64encode(b"".join(blocks))
    several = f' NumberOfComponents="{values.shape[1]}"' if values.ndim > 1 else ""
    return (
        f'<DataArray type="{_TYPES[values.dtype.str[1:]]}" Name={quoteattr(name)}{several} '
        f'format="binary">{content.decode("ascii")}</DataArray>\n'
    )

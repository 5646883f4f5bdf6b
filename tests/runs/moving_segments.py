# SPDX-License-Identifier: LGPL-3.0-or-later
"""Fields of an invented shell: the outer segment bends beyond its supports at 0 and 2 m, and the
inner segment is rigid.
"""

import numpy as np
import xarray as xr

from protractile.geometry.arrays import Array
from protractile.geometry.mesh import mesh_segment
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.report.scene import Scene
from tests.runs.case_texts import shipped

CASE = shipped("coarse")
BOOM = build_boom(CASE)
OUTER, INNER = (segment.section_at(10.0) for segment in BOOM.segments)
CLEARANCE = 7.0e-3
TIME = np.linspace(0.0, 2.0, 401)


def shape(points: Array, deflection: Array, slope: Array) -> Array:
    """Return the displacements (num_points, 3) of plane sections."""
    return np.stack([-points[:, 2] * slope, np.zeros(len(points)), deflection], axis=1)


def moving_fields() -> xr.Dataset:
    """Return the content of a run's fields."""
    outer = mesh_segment(OUTER, {"start": 0.0, "support": 2.0, "tail": 9.0, "end": 10.0}, 0.3)
    inner = mesh_segment(INNER, {"start": 9.0, "head": 10.0, "end": 19.0}, 0.3)
    x, xi = outer.points[:, 0], inner.points[:, 0]
    still = np.zeros_like(outer.points), np.zeros_like(inner.points)
    modes = [
        (shape(outer.points, x * (x - 2.0) / 80.0, (2.0 * x - 2.0) / 80.0), still[1]),
        (still[0], shape(inner.points, np.ones_like(xi), np.zeros_like(xi))),
        (still[0], shape(inner.points, (xi - 9.0) / 10.0, np.full_like(xi, 0.1))),
    ]
    swing = np.sin(np.pi * TIME) ** 2
    state = np.stack([0.02 * swing, 0.02 * swing - CLEARANCE, 0.15 * swing], axis=1)
    triangles = [outer.triangles, inner.triangles + len(outer.points)]
    # What the outer segment's bending makes; the inner one is rigid but for a dark end.
    bent = np.zeros((1, len(outer.triangles), 6), dtype=np.float32)
    bent[0, :, 0] = -2.1e11 / 40.0 * outer.points[outer.triangles, 2].mean(axis=1)
    pressed = np.zeros((2, len(inner.triangles), 6), dtype=np.float32)
    pressed[1, :, 0] = 1.0e9 * (inner.points[inner.triangles, 0].mean(axis=1) < 9.4)
    return xr.Dataset(
        {
            "wall": ("triangle", np.concatenate([outer.walls, inner.walls])),
            "thickness": ("triangle", np.full(sum(len(t) for t in triangles), 0.0065)),
            "coordinates_1": (("own_1", "mode"), np.eye(3)[:1]),
            "coordinates_2": (("own_2", "mode"), np.eye(3)[1:]),
            "stress_1": (("own_1", "triangle_1", "stress"), bent),
            "stress_2": (("own_2", "triangle_2", "stress"), pressed),
            "points": (("point", "component"), np.concatenate([outer.points, inner.points])),
            "triangles": (("triangle", "corner"), np.concatenate(triangles).astype(np.int32)),
            "segment": ("triangle", np.repeat(np.int32([0, 1]), [len(t) for t in triangles])),
            "modes": (
                ("mode", "point", "component"),
                np.array([np.concatenate(mode) for mode in modes], dtype=np.float32),
            ),
            "state": (("time", "mode"), state.astype(np.float32)),
        },
        coords={"time": TIME, "plate_1": list(outer.plates), "plate_2": list(inner.plates)},
    )


def moving_trajectories() -> xr.Dataset:
    """Return trajectories with contact from 0.2 s on, the largest mean force at 0.5 s and the
    largest peak force at 1.6 s.
    """
    swing = np.sin(np.pi * TIME) ** 2
    force = np.where(TIME[:, None] >= 0.2 - 1e-9, [-2.0e4, 1.8e4] * swing[:, None], 0.0)
    peak = 1.2 * force
    peak[320, 0] = -9.0e4
    per_station = ("model", "time", "station")
    return xr.Dataset(
        {
            "tip": (("model", "time"), (0.17 * swing - CLEARANCE)[None]),
            "contact_force": (per_station, force[None]),
            "contact_force_peak": (per_station, peak[None]),
            "direction": ("station", ["z", "z"]),
        },
        coords={"model": ["shell"], "time": TIME, "station": [9.0, 10.0]},
    ).set_coords("direction")


def moving_scene(case: Case = CASE, state: float = 1.0, **motion: Array) -> Scene:
    """Return the scene of the fields from the side.

    Args:
        case: case of the same segments.
        state: factor of the motion's coordinates.
        motion: other results (time,).
    """
    fields = moving_fields()
    given = moving_trajectories().sel(model="shell")
    given = given.assign({name: ("time", values) for name, values in motion.items()})
    return Scene.views(fields.assign(state=state * fields["state"]), given, case)[0]

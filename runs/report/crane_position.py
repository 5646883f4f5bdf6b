# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plan or elevation of a crane with its load, to scale, beside the pictures of its boom."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from protractile.dynamics.motion_laws import HistorySum
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom
from protractile.geometry.telescoping import drives_of
from protractile.runs.case.motions import frame_motion
from protractile.runs.case.schema import Case
from protractile.runs.report import theme

# Length of a rope that the case does not give, over the length of the boom.
_ROPE = 0.25


class CranePosition(NamedTuple):
    """Positions of a crane without its deflections."""

    time: Array  #: (num_times,) in s
    #: (num_times, 2, 2) foot and tip in m: in the plan of a crane that slews, otherwise in the
    #: elevation
    boom: Array
    load: Array | None  #: (num_times, 2) load on the rope, in the same view; None without a hoist
    title: str  #: name of the view

    @classmethod
    def of(cls, case: Case, boom: Boom, motion: xr.Dataset) -> CranePosition | None:
        """Return the positions in a motion; None if the crane does not hoist, slew or luff."""
        if case.hoist is None and case.slew is None and case.luff is None:
            return None
        time, frame = motion["time"].values, frame_motion(case, boom.segments)
        drives = drives_of(boom.joints, len(boom.segments) - 1)
        extension = HistorySum(tuple(drive.history for drive in drives))
        out, up = frame.position(time, boom.tip, extension)
        swing_out, swing_aside, height = (
            motion[name].values if name in motion else np.zeros(time.size)
            for name in ("swing_out", "swing_aside", "load_height")
        )
        slewed, radius = frame.slew_angle(time), np.full(time.size, frame.radius)
        radial = np.array([np.cos(slewed), np.sin(slewed)])
        if case.slew is not None:
            foot, tip = radius * radial, out * radial
            load = tip + swing_out * radial
            load += swing_aside * np.array([-radial[1], radial[0]])
        else:
            foot, tip = np.array([radius, 0.0 * time]), np.array([out, up])
            rope = case.hoist and (case.hoist.pendulum or case.hoist.length)
            load = np.array([out + swing_out, up[0] - (rope or _ROPE * boom.tip) + height])
        return cls(
            time,
            np.stack([foot.T, tip.T], axis=1),
            load.T if "rope_force" in motion else None,
            "elevation, to scale" if case.slew is None else "plan, to scale",
        )

    def prepare(self, axes: Axes) -> None:
        """Set the limits of axes so that they show all positions."""
        places = [self.boom.reshape(-1, 2), *([] if self.load is None else [self.load])]
        low, high = (
            edge(np.concatenate([*places, [[0.0, 0.0]]]), axis=0) for edge in (np.min, np.max)
        )
        margin = 0.06 * (high - low).max()
        axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin))
        axes.set_aspect("equal")
        axes.axis("off")
        axes.set_title(self.title, fontsize=17)

    def draw(self, axes: Axes, time: float) -> Iterator[Artist]:
        """Draw the boom, the rope and the load at a time in s, and yield the artists."""
        step = int(np.abs(self.time - time).argmin())
        style: dict[str, Any] = {"color": theme.INK, "clip_on": False}
        red = style | {"color": theme.FORCE}
        yield from axes.plot(*self.boom[step].T, linewidth=6.0, solid_capstyle="butt", **style)
        yield from axes.plot(*self.boom[step, 0], "o", markersize=11, **style)
        if self.load is not None:
            rope = np.array([self.boom[step, 1], self.load[step]])
            yield from axes.plot(*rope.T, linewidth=1.5, **style)
            yield from axes.plot(*self.load[step], "s", markersize=12, **red)

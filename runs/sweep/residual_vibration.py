# SPDX-License-Identifier: LGPL-3.0-or-later
"""Residual vibration after telescoping at several speeds, and vibration without telescoping."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from protractile.geometry.arrays import Array
from protractile.geometry.typography import TO_MILLI
from protractile.runs.report import theme
from protractile.runs.report.figure_context import new_sheet
from protractile.runs.report.formatting import number

# Relative excess over the level that is tolerated, since time steps and impacts cause scatter.
_SAME = 1.0e-2

# Texts and line styles for vibration without telescoping.
_ENDS = {
    "residual_vibration_initial": ("at the initial extension", ":"),
    "residual_vibration_final": ("at the final extension", "--"),
}


class VibrationCurve(NamedTuple):
    """Residual vibration of a model over the speed of the drive."""

    speed: Array  #: ascending mean speeds (num_points,) of the drive in m/s
    vibration: Array  #: residual vibrations (num_points,) in m
    levels: dict[str, Array]  #: vibrations (num_points,) in m without telescoping

    def with_level(self, end: str) -> VibrationCurve:
        """Return the curve at the speeds for which the level ``end`` is known."""
        finite = np.isfinite(self.levels[end])
        levels = {end: self.levels[end][finite]}
        return VibrationCurve(self.speed[finite], self.vibration[finite], levels)


def vibration_curves(data: xr.Dataset) -> dict[str, VibrationCurve]:
    """Return the curves by model; empty if the sweep does not vary the telescoping speed alone."""
    curves = {}
    for name in data["model"].values:
        one = data.sel(model=name)
        vibration = one["residual_vibration"].values
        finite = np.isfinite(vibration) & np.isfinite(one["drive_speed"].values)
        speed = one["drive_speed"].values[finite]
        if vibration.ndim > 1 or np.unique(speed).size < 2:
            continue
        order = np.argsort(speed)
        ends = {end: one[end].values[finite][order] for end in _ENDS}
        levels = {end: level for end, level in ends.items() if np.isfinite(level).any()}
        curves[str(name)] = VibrationCurve(speed[order], vibration[finite][order], levels)
    return curves


def admissible_speed(curve: VibrationCurve, end: str) -> float | None:
    """Return the largest speed in m/s up to which the vibration does not exceed the level ``end``.

    The vibration is interpolated linearly. Return None if the slowest speed exceeds the level.

    >>> speed, vibration = np.array([1.0, 2.0, 3.0]), np.array([2.0, 3.0, 5.0])
    >>> levels = {"initial": 4.0 + 0.0 * speed, "final": np.array([1.0, 2.0, 3.0])}
    >>> one = VibrationCurve(speed, vibration, levels)
    >>> admissible_speed(one, "initial"), admissible_speed(one, "final")
    (2.5, None)
    """
    speed, vibration, levels = curve.with_level(end)
    excess = vibration - levels[end]
    exceeding = np.flatnonzero(excess > _SAME * levels[end])
    if not exceeding.size:
        return float(speed[-1])
    first = int(exceeding[0])
    if first == 0:
        return None
    near = slice(first - 1, first + 1)
    return float(np.interp(0.0, excess[near], speed[near]))


def describe(name: str, curve: VibrationCurve) -> Iterator[str]:
    """Yield a sentence on the admissible telescoping speed for each level of a curve."""
    for end in curve.levels:
        speed, vibration, levels = curve.with_level(end)
        level, fastest = levels[end], admissible_speed(curve, end)
        ends = dict.fromkeys(number(TO_MILLI * of) for of in (level.min(), level.max()))
        level_text = f"that without telescoping, {_ENDS[end][0]} ({' to '.join(ends)} mm)"
        if fastest is None:
            slowest = f"the slowest speed, {speed[0]:.3g} m/s"
            least = number(TO_MILLI * float(vibration[0]))
            yield f"{name}: vibration of {least} mm at {slowest}, exceeds {level_text}"
        else:
            last = ", the fastest speed with a result" if fastest == speed[-1] else ""
            yield f"{name}: vibration within {level_text} up to {fastest:.3g} m/s{last}"


def draw_vibration(
    data: xr.Dataset, line_styles: Mapping[str, theme.LineStyle], path: Path
) -> None:
    """Draw the residual vibration over the mean speed of the drive, if the sweep varies it."""
    curves = vibration_curves(data)
    if not curves:
        return
    sheet, (axes,) = new_sheet(1, 4.6)
    for name, one in curves.items():
        line: dict[str, Any] = {"color": line_styles[name].color, "label": f"{name}, telescoping"}
        axes.plot(one.speed, TO_MILLI * one.vibration, marker="o", markersize=4.0, **line)
        for end, level in one.levels.items():
            where, dashes = _ENDS[end]
            line["label"] = f"{name}, without telescoping, {where}"
            axes.plot(one.speed, TO_MILLI * level, linestyle=dashes, linewidth=1.0, **line)
    axes.set(xlabel="mean speed of the drive (m/s)", ylabel="residual vibration of the tip (mm)")
    axes.set_ylim(bottom=0.0)
    handles, labels = axes.get_legend_handles_labels()
    sheet.legend(handles, labels, loc="outside lower left", ncols=1)
    lines = [line for name, one in curves.items() for line in describe(name, one)]
    sheet.suptitle("Residual vibration over telescoping speed", x=0.02, ha="left", fontsize=12.0,
                   fontweight="bold")  # fmt: skip
    axes.set_title("\n".join(lines), fontsize=8.5, fontweight="normal", wrap=True)
    sheet.savefig(path)

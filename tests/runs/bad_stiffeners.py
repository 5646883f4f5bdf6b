# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slips in collars and diaphragms; see ``bad_edits``."""

from tests.runs.coarse_case import adding

STIFFENERS = [
    *adding("supports = [0.0, 2.0]", {
        "collars = [{ span = [9.7, 10.3], thickness = 0.01 }]":
            "segment[1].collars[1].span: 10.3 m lies outside 'outer'; it must be between 0 and "
            "10 m",
        "collars = [{ span = [9.9, 9.7], thickness = 0.01 }]":
            "segment[1].collars[1].span: must run from a smaller to a larger x, got [9.9, 9.7] m",
        "collars = [{ span = [9.5, 10.0], thickness = 0.01 }, { span = [9.0, 9.7], thickness = "
        "0.02 }]":
            "segment[1].collars: two lie on one another from 9.5 m on; give one of the "
            "thickness of both there",
        "collars = [{ span = [9.7, 10.0], thickness = 0.0 }]":
            "segment[1].collars[1].thickness: must be a number greater than 0, got 0.0",
        "diaphragms = [{ x = 0.0, thickness = 0.008 }, { x = 9.5, thickness = 0.008 }]":
            "segment[1].diaphragms[2].x: 'inner' slides inside 'outer' at 9.5 m, and no plate "
            "can close the box there; it must be below 9 m",
    }),
    *adding("span = [9.0, 19.0]", {
        "diaphragms = [{ x = 9.0, thickness = 0.008 }, { x = 19.5, thickness = 0.008 }]":
            "segment[2].diaphragms[2].x: 19.5 m lies outside 'inner'; it must be between 9 and "
            "19 m",
        "diaphragms = [{ x = 9.0, thickness = -0.008 }]":
            "segment[2].diaphragms[1].thickness: must be a number greater than 0, got -0.008",
        "diaphragms = [{ x = 9.0, thickness = 0.008 }, { x = 9.0, thickness = 0.004 }]":
            "segment[2].diaphragms: a place is given twice; give each once",
    }),
    *adding("height_to_width = 1.5", {
        "collars = [{ span = [1.0, 2.0] }]":
            "segment[1].collars[1].thickness: missing; it is the additional thickness in m of "
            "the walls",
        "collars = [{ span = [1.0, 2.0], thick = 0.1 }]":
            "segment[1].collars[1].thick: unknown key; the nearest known one is thickness",
        "collars = [{ span = [1.0, 2.0], thickness = 0.01, walls = ['lid'] }]":
            "segment[1].collars[1].walls: 'lid' is no wall of 'outer'; give 'bottom', 'right', "
            "'top' or 'left'",
        "collars = [{ span = [1.0, 2.0], thickness = 0.01, walls = ['left'] }]":
            "segment[1].collars[1].walls: do not mirror themselves in y; give the opposite "
            "walls, too",
        "collars = [{ span = [1.0, 2.0], thickness = 0.01, across = [0.1, 0.05] }]":
            "segment[1].collars[1].across: must run from a smaller to a larger distance from the "
            "middle of the wall, at most 0.162958 m, got [0.1, 0.05] m",
        "diaphragms = [{ x = 1.0 }]":
            "segment[1].diaphragms[1].thickness: missing; it is the thickness in m",
        "collars = [{ span = [1.0, 2.0], thickness = 5.0 }]":
            "segment[1].collars[1].thickness: must be at most 0.162958 m, half of the box's "
            "smallest size, got 5",
    }),
]  # fmt: skip

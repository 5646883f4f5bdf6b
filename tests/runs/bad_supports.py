# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slips in what holds a boom to the ground; see ``bad_edits``."""

from tests.runs.coarse_case import replacing

_CYLINDER = (
    '[[cylinder]]\nsegment = "outer"\nx = 4.0\ndepth = 0.3\nground = [1.0, -2.0]\n'
    "stiffness = 1e7\n\n[[joint]]"
)

SUPPORTS = [
    *replacing("supports = [0.0, 2.0]", {
        "supports = [{ x = 0.0, rotation_stiffness = 1e6 }, 2.0]":
            "model[1].base: 'outer' has clamped or elastic supports, for which the functions "
            "'as printed' have no form; use base = 'complete'",
        'supports = [{ x = 0.0, kind = "hinged", stiffness = 1e6 }, 2.0]':
            "segment[1].supports: a hinge is rigid, and the one at 0 m has a stiffness; leave "
            "it out, or make the support pinned",
        "supports = [0.0, { x = 2.0, dashpot = 1e3 }]":
            "segment[1].supports: the support at 2 m is rigid, and its dashpot would never "
            "move; leave it out, or give the support a stiffness",
        'supports = [{ x = 0.0, kind = "hinged" }]':
            "segment[1]: nothing holds 'outer': give it two supports, a hinge and a cylinder "
            "whose line passes beside it, or a joint with two stations to a segment that is held",
    }),
    ("[[joint]]",
     _CYLINDER.replace("outer", "jib"),
     "cylinder[1].segment: 'jib' is no segment; give 'outer' or 'inner'"),
    ("[[joint]]",
     _CYLINDER,
     "model[1].base: 'outer' has a cylinder, for which the functions 'as printed' have no form; "
     "use base = 'complete'"),
    ("[[joint]]",
     _CYLINDER.replace("stiffness = 1e7\n", ""),
     "cylinder[1].stiffness: missing; it is the axial stiffness in N/m; of two cylinders side "
     "by side their sum"),
    ("[[joint]]",
     _CYLINDER.replace("[1.0, -2.0]", "[1.0]"),
     "cylinder[1].ground: must be a list of two numbers, got [1.0]"),
    ("[[joint]]",
     _CYLINDER.replace("depth", "height"),
     "cylinder[1].height: unknown key; known ones are segment, x, depth, ground, stiffness, "
     "dashpot, spread, capacity, pin"),
    ("[[joint]]",
     _CYLINDER.replace("stiffness", "spread = 1.0\nstiffness"),
     "cylinder[1].spread: the boom is flat, and nothing turns about its axis; leave it out, or "
     "give the joints lateral_play"),
]  # fmt: skip

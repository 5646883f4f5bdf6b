# SPDX-License-Identifier: LGPL-3.0-or-later
"""Errors in a case file: text of the coarse case, its replacement, and the expected message."""

from tests.runs.bad_booms import NUMBERS
from tests.runs.bad_contacts import CONTACTS
from tests.runs.bad_forms import FORMS
from tests.runs.coarse_case import adding, replacing

# Beams that nothing can calibrate.
CALIBRATIONS = [
    *replacing('theory = "timoshenko"', {
        'calibrated_by = "plates"':
            "model[4].calibrated_by: 'plates' is not a shell of the case; give the name of one",
        'calibrated_by = "beam-fe"':
            "model[4].calibrated_by: 'beam-fe' is not a shell of the case; give the name of one",
        'calibrated_by = { name = "wide", kind = "shell", contact_line = "across" }':
            "model[4].calibrated_by: the shell touches by 'across', where a beam has no "
            "springs; give one with contact_line = 'near webs'",
        'calibrated_by = { name = "fine", kind = "shell", mesh_size = 1e-5 }':
            "model[4].calibrated_by.mesh_size: 1e-05 m makes more than 2e+07 triangles; it must "
            "be at least 0.00176 m",
        'calibrated_by = { name = "s", kind = "shell", contact = { force_file = "none.csv" } }':
            "model[4].calibrated_by.contact: of no use: the shell does not move, the beam does; "
            "give model[4].contact, or leave it out",
        'calibrated_by = { name = "s", kind = "shell", step = 1e-6 }':
            "model[4].calibrated_by.step: of no use: the shell does not move, the beam does; "
            "give model[4].step, or leave it out",
        'calibrated_by = { name = "fine", kind = "shell", mesh_siz = 0.1 }':
            "model[4].calibrated_by.mesh_siz: unknown key; the nearest known one is mesh_size",
        'calibrated_by = { kind = "shell" }':
            "model[4].calibrated_by.name: missing; it is the name of the model in the results",
        "calibrated_by = 5": "model[4].calibrated_by: must be a table, got 5",
        "section_fields = true":
            "model[4].section_fields: only a calibrated beam has them; give calibrated_by, or "
            "leave it out",
    }),
    ("bonded = true", 'bonded = true\ncalibrated_by = "shell"',
     "model[5].calibrated_by: a bonded model has no stations whose springs could be read; leave "
     "it out"),
]  # fmt: skip

# Collars and diaphragms.
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

# What holds a boom to the ground.
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

BAD_EDITS = [*FORMS, *NUMBERS, *CALIBRATIONS, *CONTACTS, *STIFFENERS, *SUPPORTS]

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
        'calibrated_by = { name = "wide", kind = "shell", contact_line = "across" }':
            "model[4].calibrated_by: the shell touches by 'across', where a beam has no "
            "springs; give one with contact_line = 'near webs'",
        'calibrated_by = { name = "s", kind = "shell", contact = { force_file = "none.csv" } }':
            "model[4].calibrated_by.contact: of no use: the shell does not move, the beam does; "
            "give model[4].contact, or leave it out",
        'calibrated_by = { name = "fine", kind = "shell", mesh_siz = 0.1 }':
            "model[4].calibrated_by.mesh_siz: unknown key; the nearest known one is mesh_size",
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
        "collars = [{ span = [9.9, 9.7], thickness = 0.01 }]":
            "segment[1].collars[1].span: must run from a smaller to a larger x, got [9.9, 9.7] m",
        "collars = [{ span = [9.5, 10.0], thickness = 0.01 }, { span = [9.0, 9.7], thickness = "
        "0.02 }]":
            "segment[1].collars: two lie on one another from 9.5 m on; give one of the "
            "thickness of both there",
        "diaphragms = [{ x = 0.0, thickness = 0.008 }, { x = 9.5, thickness = 0.008 }]":
            "segment[1].diaphragms[2].x: 'inner' slides inside 'outer' at 9.5 m, and no plate "
            "can close the box there; it must be below 9 m",
    }),
    *adding("span = [9.0, 19.0]", {
        "diaphragms = [{ x = 9.0, thickness = 0.008 }, { x = 9.0, thickness = 0.004 }]":
            "segment[2].diaphragms: a place is given twice; give each once",
    }),
    *adding("height_to_width = 1.5", {
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
        'supports = [{ x = 0.0, kind = "hinged" }]':
            "segment[1]: nothing holds 'outer': give it two supports, a hinge and a cylinder "
            "whose line passes beside it, or a joint with two stations to a segment that is held",
    }),
    ("[[joint]]",
     _CYLINDER,
     "model[1].base: 'outer' has a cylinder, for which the functions 'as printed' have no form; "
     "use base = 'complete'"),
    ("[[joint]]",
     _CYLINDER.replace("stiffness = 1e7\n", ""),
     "cylinder[1].stiffness: missing; it is the axial stiffness in N/m; of two cylinders side "
     "by side their sum"),
]  # fmt: skip

BAD_EDITS = [*FORMS, *NUMBERS, *CALIBRATIONS, *CONTACTS, *STIFFENERS, *SUPPORTS]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Errors in contacts and friction; see ``bad_edits``."""

from tests.runs.coarse_case import CONTACT, FROM_EXPONENT, adding, replacing

CONTACTS = [
    *adding("exponent = 2.0", {
        "lateral_play = 0.01\nlateral_exponent = 1.5":
            "joint[1].lateral_stiffness: missing; it is the lateral contact stiffness in "
            "N/m^n; the same unless given",
        "restitution = { coefficient = 1.2, speed = 0.1 }":
            "joint[1].restitution.coefficient: must be a number not greater than 1, got 1.2",
        "bonded = true\nfriction = 0.2\nnormal_forces = [1.0, 1.0]":
            "joint[1].friction: the joint is bonded, and nothing slides; leave it out",
        "bonded = true\ncontact_length = 0.1":
            "joint[1].contact_length: the joint is bonded, and nothing touches; leave it out",
        "pad = { length = 1.5, width = 0.06 }":
            "joint[1].pad.length: must be above 0 and not above the overlap of 1 m, got 1.5 m",
        "pad = { length = 0.1, width = 0.06, offset = 0.01, bears = 'corner' }":
            "joint[1].pad.offset: the pad bears on the corner; leave offset out, or bears = "
            "'corner'",
        "pad = { length = 0.1, width = 0.06, bears = 'web' }":
            "joint[1].pad.bears: must be 'wall' or 'corner', got 'web'",
        "pad = { length = 0.1, width = 0.2 }":
            "joint[1].pad.width: must be above 0 and not above half a wall of the inner "
            "segment, 0.135298 m, got 0.2 m",
        "pad = { length = 0.1, width = 0.1, offset = 0.05 }":
            "joint[1].pad.width: must be above 0 and not above half a wall of the inner "
            "segment, 0.135298 m less the offset of 0.05 m, got 0.1 m",
        "play_above = 0.02": "joint[1].play_above: must be a part of play, got 0.02 m",
        "interference = 0.001": "joint[1].interference: shims leave no play; give play = 0",
        "lateral_play_right = 0.002":
            "joint[1].lateral_play_right: must be a part of lateral_play, got 0.002 m",
        "pad = { length = 0.1 }":
            "joint[1].pad.width: missing; it is the width from the corner inwards in m",
        "bonded = true\npad = { length = 0.1, width = 0.06 }":
            "joint[1].pad: the joint is bonded, and nothing touches; leave it out",
        "contact_length = 1.5":
            "joint[1].contact_length: must be above 0 and not above the overlap's 1 m, got 1.5 m",
    }),
    *replacing("stiffness = 1e13\nexponent = 2.0", {
        "pad = { length = 0.1, width = 0.06 }":
            "joint[1].pad: has no thickness; give the thickness in m, from which the joint's "
            "stiffness follows, or the joint's stiffness",
        "pads = [{ length = 0.1, width = 0.06, thickness = 0.02 }]":
            "joint[1].pads[1].side: missing; it is the wall of the inner segment with the pad; "
            "right is at positive y",
        "pads = [{ side = 'below', length = 0.1, width = 0.06, thickness = 0.02 }]":
            "joint[1].pads: none is above; give each side one at least",
        "pads = [{ side = 'left', length = 0.1, width = 0.06, thickness = 0.02 }]":
            "joint[1].pads[1].side: the boom is flat, and nothing presses laterally; leave "
            "the pad out, or give the joints lateral_play",
        "pads = [{ side = 'above', length = 0.1, width = 0.06, thickness = 0.02 }, { side = "
        "'above', length = 0.1, width = 0.06, thickness = 0.02, offset = 0.04 }, { side = "
        "'below', length = 0.1, width = 0.06, thickness = 0.02 }]":
            "joint[1].pads: two lie on one another above, 0.04 m from the corner; give the "
            "outer one a width of at most 0.04 m",
        "pad = { length = 0.1, width = 0.06 }\npads = [{ side = 'below', length = 0.1, width = "
        "0.06, thickness = 0.02 }]":
            "joint[1].pad: pads is given; leave one of them out",
    }),
    *replacing("exponent = 2.0", {
        "pad = { length = 0.1, width = 0.06, thickness = 0.02 }":
            "joint[1].stiffness: pad.thickness is given; leave one of them out",
    }),
    ("play = 0.014\nstiffness = 1e13", "play = 0.0\ninterference = 0.001\nstiffness = 1e13",
     "joint[1].interference: contact on both sides of a joint at once needs a law of the "
     "exponent 1, and model 'kantorovich-4' has another; give it one, or leave interference out"),
    ('contact_line = "near webs"', 'contact_line = "near webs"\nsurface_stiffness = 1e10',
     "model[6].surface_stiffness: the segments touch at their stations, 'near webs'; leave it "
     "out, or give contact_line = 'surface'"),
    *replacing('contact_line = "near webs"', {
        "surface_points = [8, 4]":
            "model[6].surface_points: the segments touch at their stations, 'near webs'; leave "
            "it out, or give contact_line = 'surface'",
        'contact_line = "surface"\nsurface_points = [100, 4]':
            "model[6].surface_points: 100 times 4 points on half a wall are more than 256, "
            "which a reduced model can bear; give fewer",
    }),
    (FROM_EXPONENT,
     FROM_EXPONENT.replace(
         "exponent = 2.0\n", "exponent = 2.0\npad = { length = 0.1, width = 0.06 }\n"
     ).replace('"near webs"', '"across"'),
     "model[6].contact_line: 'across' leaves no place to the pads of joint[1]; give 'near "
     "webs', or leave pad out"),
    (FROM_EXPONENT,
     FROM_EXPONENT.replace("exponent = 2.0\n", "exponent = 2.0\nlateral_play = 0.01\n").replace(
         '"near webs"', '"across"'
     ),
     "model[6].contact_line: 'across' is for a flat boom; in space the segments touch 'near "
     "webs' or by 'surface'"),
    (FROM_EXPONENT,
     FROM_EXPONENT.replace(
         "exponent",
         "lateral_play = 0.01\nlateral_stiffness = 1e11\nlateral_exponent = 1.5\nexponent",
         1,
     )
     .replace('"near webs"', '"surface"\nsurface_stiffness = 1e14')
     .replace(CONTACT, "", 3),
     "model[6].surface_stiffness: its unit depends on the exponent, and the joints have 1.5 and "
     "2; leave it out, or give the model its own contact"),
    ("stiffness = 1e13\n" + FROM_EXPONENT,
     FROM_EXPONENT.replace("exponent = 2.0", "force_table = [[1e-3, 1e4], [2e-3, 4e4]]")
     .replace('"near webs"', '"surface"\nsurface_stiffness = 1e14')
     .replace(CONTACT, "", 3),
     "model[6].surface_stiffness: is one number, and a force_table has as many as lines; leave "
     "it out, or give the model its own contact"),
]  # fmt: skip

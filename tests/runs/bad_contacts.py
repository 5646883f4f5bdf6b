# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slips in how segments touch and rub; see ``bad_edits``."""

from __future__ import annotations

from tests.runs.coarse_case import CONTACT, FROM_EXPONENT

LAW = "stiffness = 1e13\nexponent = 2.0\n"

CONTACTS = {
    "friction without what presses": (
        "exponent = 2.0\n",
        "exponent = 2.0\nfriction = 0.2\n",
        "joint[1].normal_forces: missing, and the joint has friction; give normal_forces, one in N "
        "for each station, since in a flat boom no other plane presses",
    ),
    "a normal force too few": (
        "exponent = 2.0\n",
        "exponent = 2.0\nfriction = 0.2\nnormal_forces = [4500.0]\n",
        "joint[1].normal_forces: must have one number for each of the 2 stations, got 1",
    ),
    "an exponent to the sides of a stiffness of another": (
        "exponent = 2.0\n",
        "exponent = 2.0\nlateral_play = 0.01\nlateral_exponent = 1.5\n",
        "joint[1].lateral_stiffness: missing; it is the contact stiffness to the sides in N/m^n; "
        "the same unless given",
    ),
    "negative friction": (
        "exponent = 2.0\n",
        "exponent = 2.0\nfriction = -0.2\n",
        "joint[1].friction: must be a number not less than 0, got -0.2",
    ),
    "restitution above one": (
        "exponent = 2.0\n",
        "exponent = 2.0\nrestitution = { coefficient = 1.2, speed = 0.1 }\n",
        "joint[1].restitution.coefficient: must be a number not greater than 1, got 1.2",
    ),
    "width that the play does not leave": (
        "exponent = 2.0\n",
        "exponent = 2.0\nlateral_play = 0.1\n",
        "joint[1].lateral_play: 'inner' does not fit in 'outer': 0.044042 m of width are free, and "
        "a lateral play of 0.1 m is asked for; make the inner section or the lateral play smaller",
    ),
    "friction of a tied joint": (
        "exponent = 2.0\n",
        "exponent = 2.0\ntied = true\nfriction = 0.2\nnormal_forces = [1.0, 1.0]\n",
        "joint[1].friction: the joint is tied, and nothing slides; leave it out",
    ),
    "pads that say nothing of a stiffness": (
        LAW,
        "pad = { length = 0.1, width = 0.06 }\n",
        "joint[1].pad: has no thickness; give the thickness in m, from which the joint's stiffness "
        "follows, or the joint's stiffness",
    ),
    "pads longer than the overlap": (
        "exponent = 2.0\n",
        "exponent = 2.0\npad = { length = 1.5, width = 0.06 }\n",
        "joint[1].pad.length: must be above 0 and not above the overlap of 1 m, got 1.5 m",
    ),
    "pads on the corner with an offset": (
        "exponent = 2.0\n",
        "exponent = 2.0\npad = { length = 0.1, width = 0.06, offset = 0.01, bears = 'corner' }\n",
        "joint[1].pad.offset: the pad bears on the corner; leave offset out, or bears = 'corner'",
    ),
    "pads that bear on the web": (
        "exponent = 2.0\n",
        "exponent = 2.0\npad = { length = 0.1, width = 0.06, bears = 'web' }\n",
        "joint[1].pad.bears: must be 'wall' or 'corner', got 'web'",
    ),
    "pads wider than half a flange": (
        "exponent = 2.0\n",
        "exponent = 2.0\npad = { length = 0.1, width = 0.2 }\n",
        "joint[1].pad.width: must be above 0 and not above half a wall of the inner segment, "
        "0.135298 m, got 0.2 m",
    ),
    "pads wider than their offset leaves": (
        "exponent = 2.0\n",
        "exponent = 2.0\npad = { length = 0.1, width = 0.1, offset = 0.05 }\n",
        "joint[1].pad.width: must be above 0 and not above half a wall of the inner segment, "
        "0.135298 m less the offset of 0.05 m, got 0.1 m",
    ),
    "a stiffness beside that of pads": (
        "exponent = 2.0\n",
        "pad = { length = 0.1, width = 0.06, thickness = 0.02 }\n",
        "joint[1].stiffness: pad.thickness is given; leave one of them out",
    ),
    "a play above beyond the play": (
        "exponent = 2.0\n",
        "exponent = 2.0\nplay_above = 0.02\n",
        "joint[1].play_above: must be a part of play, got 0.02 m",
    ),
    "shims in a play": (
        "exponent = 2.0\n",
        "exponent = 2.0\ninterference = 0.001\n",
        "joint[1].interference: shims leave no play; give play = 0",
    ),
    "a part of a lateral play that is none": (
        "exponent = 2.0\n",
        "exponent = 2.0\nlateral_play_right = 0.002\n",
        "joint[1].lateral_play_right: must be a part of lateral_play, got 0.002 m",
    ),
    "shims under a square law": (
        "play = 0.014\nstiffness = 1e13\n",
        "play = 0.0\ninterference = 0.001\nstiffness = 1e13\n",
        "joint[1].interference: contact on both sides of a joint at once needs a law of the "
        "exponent 1, and model 'kantorovich-4' has another; give it one, or leave interference out",
    ),
    "pads without a width": (
        "exponent = 2.0\n",
        "exponent = 2.0\npad = { length = 0.1 }\n",
        "joint[1].pad.width: missing; it is the width from the corner inwards in m",
    ),
    "pads of a tied joint": (
        "exponent = 2.0\n",
        "exponent = 2.0\ntied = true\npad = { length = 0.1, width = 0.06 }\n",
        "joint[1].pad: the joint is tied, and nothing touches; leave it out",
    ),
    "several pads without a side": (
        LAW,
        "pads = [{ length = 0.1, width = 0.06, thickness = 0.02 }]\n",
        "joint[1].pads[1].side: missing; it is the wall of the "
        "inner segment with the pad; right is at positive y",
    ),
    "pads on one side alone": (
        LAW,
        "pads = [{ side = 'below', length = 0.1, width = 0.06, thickness = 0.02 }]\n",
        "joint[1].pads: none is above; give each side one at least",
    ),
    "pads to the sides of a flat boom": (
        LAW,
        "pads = [{ side = 'left', length = 0.1, width = 0.06, thickness = 0.02 }]\n",
        "joint[1].pads[1].side: the boom is flat, and nothing presses to the sides; leave the pad "
        "out, or give the joints lateral_play",
    ),
    "pads on one another": (
        LAW,
        "pads = [{ side = 'above', length = 0.1, width = 0.06, thickness = 0.02 }, "
        "{ side = 'above', length = 0.1, width = 0.06, thickness = 0.02, offset = 0.04 }, "
        "{ side = 'below', length = 0.1, width = 0.06, thickness = 0.02 }]\n",
        "joint[1].pads: two lie on one another above, 0.04 m from the corner; give the outer one a "
        "width of at most 0.04 m",
    ),
    "pads beside a pad": (
        LAW,
        "pad = { length = 0.1, width = 0.06 }\n"
        "pads = [{ side = 'below', length = 0.1, width = 0.06, thickness = 0.02 }]\n",
        "joint[1].pad: pads is given; leave one of them out",
    ),
    "a stiffness beside several pads": (
        "exponent = 2.0\n",
        "pads = [{ side = 'below', length = 0.1, width = 0.06, thickness = 0.02 }]\n",
        "joint[1].stiffness: pads is given; leave one of them out",
    ),
    "contact longer than the overlap": (
        "exponent = 2.0\n",
        "exponent = 2.0\ncontact_length = 1.5\n",
        "joint[1].contact_length: must be above 0 and not above the overlap's 1 m, got 1.5 m",
    ),
    "contact along no length": (
        "exponent = 2.0\n",
        "exponent = 2.0\ncontact_length = 0.0\n",
        "joint[1].contact_length: must be a number greater than 0, got 0.0",
    ),
    "a length of a tied joint's contact": (
        "exponent = 2.0\n",
        "exponent = 2.0\ntied = true\ncontact_length = 0.1\n",
        "joint[1].contact_length: the joint is tied, and nothing touches; leave it out",
    ),
    "dashpots of a tied joint": (
        "exponent = 2.0\n",
        "exponent = 2.0\ntied = true\ndashpot = 1e3\n",
        "joint[1].dashpot: the joint is tied, and nothing moves; leave it out",
    ),
    "a dashpot that drives": (
        "exponent = 2.0\n",
        "exponent = 2.0\ndashpot = -1e3\n",
        "joint[1].dashpot: must be a number not less than 0, got -1000.0",
    ),
    "pads across the flanges": (
        FROM_EXPONENT,
        FROM_EXPONENT.replace(
            "exponent = 2.0\n", "exponent = 2.0\npad = { length = 0.1, width = 0.06 }\n"
        ).replace('"near webs"', '"across"'),
        "model[6].contact_line: 'across' leaves no place to the pads of joint[1]; give 'near "
        "webs', or leave pad out",
    ),
    "contact across the flanges in space": (
        FROM_EXPONENT,
        FROM_EXPONENT.replace("exponent = 2.0\n", "exponent = 2.0\nlateral_play = 0.01\n").replace(
            '"near webs"', '"across"'
        ),
        "model[6].contact_line: 'across' is for a flat boom; in space the segments touch 'near "
        "webs' or by 'surface'",
    ),
    "stiffness of a surface at stations": (
        'contact_line = "near webs"',
        'contact_line = "near webs"\nsurface_stiffness = 1e10',
        "model[6].surface_stiffness: the segments touch at their stations, 'near webs'; leave it "
        "out, or give contact_line = 'surface'",
    ),
    "points of a surface at stations": (
        'contact_line = "near webs"',
        "surface_points = [8, 4]",
        "model[6].surface_points: the segments touch at their stations, 'near webs'; leave it out, "
        "or give contact_line = 'surface'",
    ),
    "too many points of a surface": (
        'contact_line = "near webs"',
        'contact_line = "surface"\nsurface_points = [100, 4]',
        "model[6].surface_points: 100 times 4 points on half a wall are more than 256, which a "
        "reduced model can bear; give fewer",
    ),
    "one stiffness for surfaces of two laws": (
        FROM_EXPONENT,
        FROM_EXPONENT.replace(
            "exponent",
            "lateral_play = 0.01\nlateral_stiffness = 1e11\nlateral_exponent = 1.5\nexponent",
            1,
        )
        .replace('"near webs"', '"surface"\nsurface_stiffness = 1e14')
        .replace(CONTACT, "", 3),
        "model[6].surface_stiffness: its unit depends on the exponent, and the joints have 1.5 and "
        "2; leave it out, or give the model its own contact",
    ),
    "stiffness of a surface of a measured contact": (
        "stiffness = 1e13\n" + FROM_EXPONENT,
        FROM_EXPONENT.replace("exponent = 2.0", "force_table = [[1e-3, 1e4], [2e-3, 4e4]]")
        .replace('"near webs"', '"surface"\nsurface_stiffness = 1e14')
        .replace(CONTACT, "", 3),
        "model[6].surface_stiffness: is one number, and a force_table has as many as lines; leave "
        "it out, or give the model its own contact",
    ),
}

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Errors in a case file: text of the coarse case, its replacement, and the expected message."""

from tests.runs.case_texts import CONTACT, adding, replacing

# Keys and types, and missing keys.
BOX = "section = { height = 0.49, width = 0.33, flange = 0.0065, web = 0.0065 }"

FORMS = [
    *replacing("duration = 0.6", {
        "colour = 1":
            "time.colour: unknown key; known ones are duration, output_step, step, tolerance",
        "duration = 0.6\nangle = 45.0": "time.angle: unknown key; use gravity.angle",
        "duration = true": "time.duration: must be a number, got true",
    }),
    ("terms = [2, 3]", "terms = [2, 2.5]",
     "model[2].terms[2]: must be a whole number, got 2.5"),
    *replacing("[material]", {
        "[material]\nE = 2.1e11":
            "material.E: unknown key; use youngs_modulus, Young's modulus E in Pa",
        "[[axial]]\nforce = 1e3\nramp = 0.5\n\n[material]":
            "axial[1].ramp: an axial force is constant; give it at its largest, or one "
            "[[load_case]] per value",
    }),
    *replacing("height_to_width = 1.5", {
        "section = { shape = 'star', height = 0.49 }":
            "segment[1].section.shape: must be 'box', 'unequal box', 'polygon', 'hexagon', "
            "'octagon' or 'U', got 'star'",
        "head_section = { height = 0.4, width = 0.3, flange = 0.0065, web = 0.0065 }":
            "segment[1].section: missing; a segment with a head_section tapers from it",
    }),
    ("supports = [0.0, 2.0]", 'supports = [0.0, "near"]',
     "segment[1].supports[2].x: must be a number of m, 'tail', 'head' or a distance in m from "
     "one of them such as { tail = 0.2 }, got 'near'"),
    ("[material]\nyoungs_modulus = 2.1e11\npoissons_ratio = 0.3\ndensity = 7850.0\n", "",
     "material: missing, and 'outer' has none of its own; it is the table of elastic constants and "
     "density, of segments without a material of their own"),
    ("mass_per_length = 55.07\n", "",
     "segment[2].mass_per_length: missing; it is the mass per length in kg/m; follows from the "
     "section unless given"),
    ("height_to_width = 1.5\n", "",
     "segment[1].section: missing, and 'timoshenko' needs it; give section or height_to_width, "
     "or theory = 'euler-bernoulli' in the model"),
    ("bonded = true", "bonded = 1",
     "model[5].bonded: must be true or false, got 1"),
    *replacing("span = [9.0, 19.0]", {
        "span = [9.0, 14.0, 19.0]":
            "segment[2].span: must be a list of two numbers, got [9.0, 14.0, 19.0]",
    }),
    ("[[joint]]", "[joint]",
     "joint: must be an array of tables, each headed [[joint]], got {'outer': 'outer', 'inner': "
     "'inner', 'stations': [9.0, 10..."),
    ('kind = "shell"', 'kind = "plate"',
     "model[6].kind: must be 'kantorovich', 'finite-element', 'shell' or 'rigid', got 'plate'"),
    ("[time]", "[time",
     "line 8: not TOML: Expected ']' at the end of a table declaration (column 6); see "
     "https://toml.io"),
    ('name = "beam-fe"', 'name = "балка"',
     "model[3].name: must be made of Latin letters, digits, blanks and . _ + -, starting with a "
     "letter or a digit, got 'балка'"),
    ("play = 0.014", "play = 0,014",
     "line 39: not TOML: 0,014 has a decimal comma; give 0.014"),
    ("height_to_width = 1.5",
     f"{BOX}\nhead_section = {{ height = 0.4, width = 0.3, flange = 0.0065, web = 0.0065 }}",
     "segment[2].section: missing, and none is inferred within 'outer', which tapers; give it"),
    ('name = "beam-fe"',
     f'name = "{"b" * 61}"',
     "model[3].name: too long; give 60 characters at most"),
    ("duration = 0.6",
     f"{'k' * 5000} = 1",
     "time.kkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkk ... "
     "kkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkkk: unknown key; known ones are "
     "duration, output_step, step, tolerance"),
    ("[[joint]]",
     '[[stop]]\nsegment = "inner"\nx = 10.0\nplay = 1.0\nstiffness = 1e7\n' * 2000 + "[[joint]]",
     "stop: too many; give 50 at most"),
    ("density = 7850.0",
     f"density = {'7' * 5000}",
     "file: a whole number has more than 64 bits; give fewer digits, or a number as 1.0e20"),
]  # fmt: skip

# Numbers and booms.
NUMBERS = [
    *replacing("supports = [0.0, 2.0]", {
        'supports = [0.0, { x = 2.0, kind = "clamped" }]':
            "model[1].base: 'outer' has clamped or elastic supports, for which the functions "
            "'as printed' have no form; use base = 'complete'",
    }),
    ("load = 55.07", "load = 55.07\nviscous_damping = 10.0",
     "segment[2].viscous_damping: the shell 'shell' has none; leave it out, or run beams alone"),
    ("[[joint]]",
     '[[cylinder]]\nsegment = "outer"\nx = 4.0\nground = [1.0, -2.0]\nstiffness = 1e7\n\n[[joint]]',
     "model[1].base: 'outer' has a cylinder, for which the functions 'as printed' have no form; "
     "use base = 'complete'"),
    *replacing("play = 0.014", {
        "play = 0.028":
            "segment[2].section: no uniform-wall box with A = 0.00701529 m² and J = 0.00021829 "
            "m⁴ closes a clearance of 0.014 m in a room of 0.482373 m x 0.319415 m; give the "
            "section explicitly: pads then take up the difference to the stated clearance",
        "play = 1e300":
            "segment: numbers out of proportion (Numerical result out of range); give them in "
            "SI units",
    }),
    ("span = [9.0, 19.0]", "span = [9.9999999, 19.0]",
     "joint[1]: 'inner' overlaps 'outer' by 1e-07 m; it must be at least 0.0009 m, usual is a "
     "tenth of its length"),
    ("youngs_modulus = 2.1e11", "youngs_modulus = nan",
     "material.youngs_modulus: must be a finite number, got nan"),
    ("terms = [2, 3]", "terms = [2, 61]",
     "model[2].terms: must not be above 60, where the polynomials lose their digits, got [2, 61]; "
     "use finite elements"),
    ('name = "kantorovich-5"', 'name = "beam estimate"',
     "model[2].name: 'beam estimate' is a model in all results; give another"),
    ('inner = "inner"', 'inner = "innner"',
     "joint[1].inner: 'innner' is no segment; give 'outer' or 'inner'"),
    ("height_to_width = 1.5",
     "section = { height = 0.49, width = 0.33, flange = 0.0075, web = 0.0065 }",
     "segment[1].mass_per_length: 83.16 is not the section's own 88.862, and beams and shell "
     "would be different booms; leave it out, or change the section"),
    *replacing("duration = 0.6", {
        "duration = 0.6005":
            "time.duration: must be a whole number of output steps of 0.001 s, such as 0.6 s, "
            "got 0.6005 s",
        "duration = 1e9":
            "time.output_step: 0.001 s makes 1e+12 outputs of 1e+09 s; it must be at least 100 s",
    }),
    ("duration = 0.6", "duration = 0.6\nstep = 0.01",
     "time.step: must not be above the output step of 0.001 s, got 0.01 s"),
    ("element_length = 0.5", "element_length = 1e-9",
     "model[3].element_length: 1e-09 m makes more than 5000 elements of a segment; it must be "
     "at least 0.002 m"),
    ("mesh_size = 0.25", 'mesh_size = 0.25\nmodes = "many"',
     "model[6].modes: must be a whole number above 0, or 'auto', got 'many'"),
    ('contact_tolerance = "any"', "contact_tolerance = 1e-4",
     "model[6].contact_tolerance: must be a number from 0.001 to below 1, or 'any', got 0.0001"),
    ("[[model]]",
     '[[joint]]\nouter = "inner"\ninner = "outer"\nstations = [9.5]\nplay = 0.014\nstiffness = '
     "1e13\n\n[[model]]",
     "joint[2]: 'inner' and 'outer' are joined by joint[1] already; give all their stations "
     "there"),
    ("height_to_width = 1.5",
     "height_to_width = 1.5\nsection = { height = 0.49, width = 0.33, flange = 0.0065, web = "
     "0.0065 }",
     "segment[1].height_to_width: the section is given; leave one of them out"),
    ("bonded = true",
     f"bonded = true\n{CONTACT}",
     "model[5].contact: a bonded model has no contact; leave it out"),
]  # fmt: skip

# Contacts and friction.
CONTACTS = [
    *adding("exponent = 2.0", {
        "lateral_play = 0.01\nlateral_exponent = 1.5":
            "joint[1].lateral_stiffness: missing; it is the lateral contact stiffness in "
            "N/m^n; the same unless given",
        "bonded = true\nfriction = 0.2\nnormal_forces = [1.0, 1.0]":
            "joint[1].friction: the joint is bonded, and nothing slides; leave it out",
        "pad = { length = 1.5, width = 0.06 }":
            "joint[1].pad.length: must be above 0 and not above the overlap of 1 m, got 1.5 m",
        "pad = { length = 0.1, width = 0.06, offset = 0.01, bears = 'corner' }":
            "joint[1].pad.offset: the pad bears on the corner; leave offset out, or bears = "
            "'corner'",
        "pad = { length = 0.1, width = 0.1, offset = 0.05 }":
            "joint[1].pad.width: must be above 0 and not above half a wall of the inner "
            "segment, 0.135298 m less the offset of 0.05 m, got 0.1 m",
        "play_above = 0.02": "joint[1].play_above: must be a part of play, got 0.02 m",
        "interference = 0.001": "joint[1].interference: shims leave no play; give play = 0",
        "contact_length = 1.5":
            "joint[1].contact_length: must be above 0 and not above the overlap's 1 m, got 1.5 m",
    }),
    *replacing("stiffness = 1e13\nexponent = 2.0", {
        "pad = { length = 0.1, width = 0.06 }":
            "joint[1].stiffness: missing; give pad, with the thickness from which it follows, or "
            "stiffness in N/m^n",
        "pads = [{ side = 'below', length = 0.1, width = 0.06, thickness = 0.02 }]":
            "joint[1].pads: none is above; give each side one at least",
        "pads = [{ side = 'left', length = 0.1, width = 0.06, thickness = 0.02 }]":
            "joint[1].pads[1].side: the boom is flat, and nothing presses laterally; leave "
            "the pad out, or give the joints lateral_play",
        "pad = { length = 0.1, width = 0.06 }\npads = [{ side = 'below', length = 0.1, width = "
        "0.06, thickness = 0.02 }]":
            "joint[1].pad: pads is given; leave one of them out",
    }),
    ("exponent = 2.0", "pad = { length = 0.1, width = 0.06, thickness = 0.02 }",
     "joint[1].stiffness: pad.thickness is given; leave one of them out"),
    ("play = 0.014\nstiffness = 1e13", "play = 0.0\ninterference = 0.001\nstiffness = 1e13",
     "joint[1].interference: contact on both sides of a joint at once needs a law of the "
     "exponent 1, and model 'kantorovich-4' has another; give it one, or leave interference out"),
    ('contact_line = "near webs"', 'contact_line = "near webs"\nsurface_stiffness = 1e10',
     "model[6].surface_stiffness: the segments touch at their stations, 'near webs'; leave it "
     "out, or give contact_line = 'surface'"),
    ('contact_line = "near webs"', 'contact_line = "surface"\nsurface_points = [100, 4]',
     "model[6].surface_points: 100 times 4 points on half a wall are more than 256, which a "
     "reduced model can bear; give fewer"),
]  # fmt: skip

# The same at the shell's contact, by several replacements.
LAW = "stiffness = 1e13\nexponent = 2.0"
ACROSS = (('"near webs"', '"across"'),)
SURFACE = (('"near webs"', '"surface"\nsurface_stiffness = 1e14'), *3 * [(CONTACT, "")])
OF_SHELLS = [
    (f"{LAW}\npad = {{ length = 0.1, width = 0.06 }}", ACROSS,
     "contact_line: 'across' leaves no place to the pads of joint[1]; give 'near webs', or leave "
     "pad out"),
    (f"{LAW}\nlateral_play = 0.01", ACROSS,
     "contact_line: 'across' is for a flat boom; in space the segments touch 'near webs' or by "
     "'surface'"),
    (f"{LAW}\nlateral_play = 0.01\nlateral_stiffness = 1e11\nlateral_exponent = 1.5", SURFACE,
     "surface_stiffness: its unit depends on the exponent, and the joints have 1.5 and 2; leave it "
     "out, or give the model its own contact"),
    ("force_table = [[1e-3, 1e4], [2e-3, 4e4]]", SURFACE,
     "surface_stiffness: is one number, and a force_table has as many as lines; leave it out, or "
     "give the model its own contact"),
]  # fmt: skip

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
        "diaphragms = [{ x = 0.0, thickness = 0.008 }, { x = 9.0, thickness = 0.008 }]":
            "segment[1].diaphragms[2].x: 'inner' slides inside 'outer' at 9 m, and no plate "
            "can close the box there; it must be below 9 m",
    }),
    *adding("span = [9.0, 19.0]", {
        "diaphragms = [{ x = 9.0, thickness = 0.008 }, { x = 9.0, thickness = 0.004 }]":
            "segment[2].diaphragms: a place is given twice; give each once",
    }),
    *adding("height_to_width = 1.5", {
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

ONE_EDIT = FORMS + NUMBERS + CALIBRATIONS + CONTACTS + STIFFENERS
BAD_EDITS = [
    *((((good, bad),), line) for good, bad, line in ONE_EDIT),
    *((((LAW, law), *edits), f"model[6].{line}") for law, edits, line in OF_SHELLS),
]

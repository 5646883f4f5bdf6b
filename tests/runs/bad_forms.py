# SPDX-License-Identifier: LGPL-3.0-or-later
"""Errors in keys and types of a case file, and missing keys; see ``bad_edits``."""

from tests.runs.coarse_case import replacing

BOX = "section = { height = 0.49, width = 0.33, flange = 0.0065, web = 0.0065 }"

FORMS = [
    *replacing("duration = 0.6", {
        "colour = 1":
            "time.colour: unknown key; known ones are duration, output_step, step, tolerance",
        "duration = 0.6\nangle = 45.0": "time.angle: unknown key; use gravity.angle",
        "step_output = 0.6": "time.step_output: unknown key; the nearest known one is output_step",
        "duration = true": "time.duration: must be a number, got true",
        'duration = "0.6"': "time.duration: must be a number, got '0.6'",
        '"\\u001b[31m" = 1':
            "time.\\x1b[31m: unknown key; known ones are duration, output_step, step, tolerance",
    }),
    *replacing("terms = [2, 3]", {
        "terms = [2, 2.5]": "model[2].terms[2]: must be a whole number, got 2.5",
    }),
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
        "section = { shape = 'octagon', height = 0.5, width = 0.3, chamfer = 0.1, top = 0.01, "
        "bottom = 0.01, web = 0.01, radius = 0.1 }":
            "segment[1].section.radius: unknown key; known ones are shape, height, width, top, "
            "bottom, web, chamfer",
        "head_section = { height = 0.4, width = 0.3, flange = 0.0065, web = 0.0065 }":
            "segment[1].section: missing; a segment with a head_section tapers from it",
        "section = { shape = 'U', height = 0.5, width = 0.3, radius = 0.1, facets = 21, top = "
        "0.01, bottom = 0.01, web = 0.01 }":
            "segment[1].section.facets: must be a number not greater than 20, got 21",
        "section = { shape = 'unequal box', height = 0.5, width = 0.3, top = 0.01, web = 0.01 }":
            "segment[1].section.bottom: missing; it is the thickness of the lower flange in m",
    }),
    ("supports = [0.0, 2.0]", 'supports = [0.0, "2 m"]',
     "segment[1].supports[2].x: must be a number of m, 'tail', 'head' or a distance in m from "
     "one of them such as { tail = 0.2 }, got '2 m'"),
    ("density = 7850.0\n", "",
     "material.density: missing; it is the density in kg/m^3"),
    ("mass_per_length = 55.07\n", "",
     "segment[2].mass_per_length: missing; it is the mass per length in kg/m; follows from the "
     "section unless given"),
    ('kind = "shell"\n', "",
     "model[6].kind: missing; give 'kantorovich', 'finite-element', 'shell' or 'rigid'"),
    ("height_to_width = 1.5\n", "",
     "segment[1].section: missing, and 'timoshenko' needs it; give section or height_to_width, "
     "or theory = 'euler-bernoulli' in the model"),
    ("bonded = true", "bonded = 1",
     "model[5].bonded: must be true or false, got 1"),
    *replacing("title = \"The paper's boom, coarse and short\"", {
        "title = 3": "title: must be a text, got 3",
        'title = "red \\u001b[31m"':
            "title: must be a line of printable characters, got 'red \\x1b[31m'",
    }),
    *replacing("span = [9.0, 19.0]", {
        "span = 9.0": "segment[2].span: must be a list, got 9.0",
        "span = [9.0, 14.0, 19.0]":
            "segment[2].span: must be a list of two numbers, got [9.0, 14.0, 19.0]",
    }),
    ("[[joint]]", "[joint]",
     "joint: must be an array of tables, each headed [[joint]], got {'outer': 'outer', 'inner': "
     "'inner', 'stations': [9.0, 10..."),
    ('kind = "shell"', 'kind = "plate"',
     "model[6].kind: must be 'kantorovich', 'finite-element', 'shell' or 'rigid', got 'plate'"),
    *replacing("[time]", {
        'demand = ["S1", "S12"]\n[time]':
            "demand[2]: must be 'S1', 'S2', 'S3', 'S4', 'S5', 'S6', 'S7', 'S8', 'S9', 'S10' or "
            "'S11', got 'S12'",
        "[time":
            "line 8: not TOML: Expected ']' at the end of a table declaration (column 6); see "
            "https://toml.io",
    }),
    ('name = "beam-fe"', 'name = "beam/fe"',
     "model[3].name: must be made of letters, digits, blanks and . _ + -, starting with one of "
     "the first, got 'beam/fe'"),
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
    ("supports = [0.0, 2.0]",
     f"supports = {[0.0] * 20_000}",
     "segment[1].supports: too many; give 100 at most"),
    ("[[joint]]",
     '[[stop]]\nsegment = "inner"\nx = 10.0\nplay = 1.0\nstiffness = 1e7\n' * 2000 + "[[joint]]",
     "stop: too many; give 50 at most"),
    ("density = 7850.0",
     f"density = {'7' * 5000}",
     "file: a whole number has more than 64 bits; give fewer digits, or a number as 1.0e20"),
    ("terms = [2, 3]",
     f"terms = [2, 0x{'f' * 5000}]",
     "model[2].terms[2]: has more than 64 bits; give fewer digits, or a number as 1.0e20"),
]  # fmt: skip

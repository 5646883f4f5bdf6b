# SPDX-License-Identifier: LGPL-3.0-or-later
"""Invalid numbers and booms; see ``bad_edits``."""

from tests.runs.coarse_case import CONTACT, adding, replacing

NUMBERS = [
    *replacing("supports = [0.0, 2.0]", {
        'supports = [0.0, { x = 2.0, kind = "welded" }]':
            "segment[1].supports[2].kind: must be 'pinned', 'hinged' or 'clamped', got 'welded'",
        'supports = [0.0, { x = 2.0, kind = "clamped" }]':
            "model[1].base: 'outer' has clamped or elastic supports, for which the functions "
            "'as printed' have no form; use base = 'complete'",
    }),
    *adding("load = 55.07", {
        "lateral_load = 20.0":
            "segment[2].lateral_load: the boom is flat, and nothing moves along 'y'; give the "
            "joints lateral_play",
        "viscous_damping = 10.0":
            "segment[2].viscous_damping: the shell 'shell' has none; leave it out, or run beams "
            "alone",
    }),
    *replacing("load = 55.07\n\n[[joint]]", {
        'load = 55.07\n\n[[load]]\nsegment = "jib"\nmagnitude = 1.0\n\n[[joint]]':
            "load[1].segment: 'jib' is no segment; give 'outer' or 'inner'",
        'load = 55.07\n\n[[stop]]\nsegment = "inner"\nx = 3.0\nplay = 0.1\nstiffness = '
        "1e7\n\n[[joint]]":
            "stop[1].x: 3 m lies outside 'inner'; it must be between 9 and 19 m",
    }),
    ("stiffness = 1e13", "stiffness = 0.0",
     "joint[1].stiffness: must be a number greater than 0, got 0.0"),
    *replacing("play = 0.014", {
        "play = -0.014": "joint[1].play: must be a number not less than 0, got -0.014",
        "play = 0.028":
            "segment[2].section: no uniform-wall box with A = 0.00701529 m² and J = 0.00021829 "
            "m⁴ closes a clearance of 0.014 m in a room of 0.482373 m x 0.319415 m; give the "
            "section explicitly: pads then take up the difference to the stated clearance",
        "play = 1e300":
            "segment: numbers out of proportion (Numerical result out of range); give them in "
            "SI units",
    }),
    *replacing("span = [9.0, 19.0]", {
        "span = [19.0, 9.0]":
            "segment[2].span: must run from a smaller to a larger x, got [19, 9] m",
        "span = [9.9999999, 19.0]":
            "joint[1]: 'inner' overlaps 'outer' by 1e-07 m; it must be at least 0.0009 m, usual "
            "is a tenth of its length",
    }),
    ("youngs_modulus = 2.1e11", "youngs_modulus = nan",
     "material.youngs_modulus: must be a finite number, got nan"),
    ("poissons_ratio = 0.3", "poissons_ratio = 0.5",
     "material.poissons_ratio: must be a number less than 0.5, got 0.5"),
    *replacing("exponent = 2.0", {
        "exponent = 2e9":
            "joint[1].exponent: must be a number not greater than 10, got 2000000000.0",
    }),
    *replacing("terms = [2, 3]", {
        "terms = [2, 3, 1]":
            "model[2].terms: must have one number for each of the 2 segments, got [2, 3, 1]",
        "terms = [2, 61]":
            "model[2].terms: must not be above 60, where the polynomials lose their digits, got "
            "[2, 61]; use finite elements",
    }),
    ('name = "kantorovich-5"', 'name = "kantorovich-4"',
     "model[2].name: 'kantorovich-4' is the name of model[1] already; give each its own"),
    ('name = "inner"', 'name = "outer"',
     "segment[2].name: 'outer' is the name of segment[1] already; give each its own"),
    *replacing('inner = "inner"', {
        'inner = "innner"': "joint[1].inner: 'innner' is no segment; give 'outer' or 'inner'",
    }),
    *replacing("stations = [9.0, 10.0]", {
        "stations = []": "joint[1].stations: empty; give at least one",
    }),
    *replacing("height_to_width = 1.5", {
        "section = { height = 0.49, width = 0.33, flange = 0.0075, web = 0.0065 }":
            "segment[1].mass_per_length: 83.16 is not the section's own 88.862, and beams and "
            "shell would be different booms; leave it out, or change the section",
    }),
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
    *adding("mesh_size = 0.25", {
        'modes = "many"': "model[6].modes: must be a whole number above 0, or 'auto', got 'many'",
    }),
    *replacing('contact_tolerance = "any"', {
        "contact_tolerance = 1e-4":
            "model[6].contact_tolerance: must be a number from 0.001 to below 1, or 'any', got "
            "0.0001",
    }),
    ("mesh_size = 0.25", "mesh_size = 1e-9",
     "model[6].mesh_size: 1e-09 m makes more than 2e+07 triangles; it must be at least 0.00176 m"),
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

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slips in a case file: what stands in the coarse case, what replaces it, and the line it earns."""

from __future__ import annotations

from pathlib import Path

CASES = Path(__file__).parents[2] / "runs" / "cases"
COARSE = (CASES / "coarse.toml").read_text(encoding="utf-8")
CONTACT = next(line for line in COARSE.splitlines() if line.startswith("contact = "))

BAD_EDITS = {
    "unknown key": (
        "duration = 0.6",
        "colour = 1",
        "time.colour: unknown key; known ones are duration, output_step, step",
    ),
    "misspelled key": (
        "duration = 0.6",
        "durration = 0.6",
        "time.durration: unknown key; the nearest known one is duration",
    ),
    "misspelled key of a model": (
        "terms = [2, 3]",
        "term = [2, 3]",
        "model[2].term: unknown key; the nearest known one is terms",
    ),
    "misspelled table": (
        "[material]",
        "[materials]",
        "materials: unknown key; the nearest known one is material",
    ),
    "unknown key in a section": (
        "height_to_width = 1.5",
        "section = { height = 0.49, width = 0.33, flange = 0.0065, web = 0.0065, wall = 2 }",
        "segment[1].section.wall: unknown key; known ones are height, width, flange, web",
    ),
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
    "negative friction": (
        "exponent = 2.0\n",
        "exponent = 2.0\nfriction = -0.2\n",
        "joint[1].friction: must be a number not less than 0, got -0.2",
    ),
    "support that is a text": (
        "supports = [0.0, 2.0]",
        'supports = [0.0, "2 m"]',
        "segment[1].supports[2]: must be a table, got '2 m'",
    ),
    "support of an unknown kind": (
        "supports = [0.0, 2.0]",
        'supports = [0.0, { x = 2.0, kind = "welded" }]',
        "segment[1].supports[2].kind: must be 'pinned' or 'clamped', got 'welded'",
    ),
    "soft clamp": (
        "supports = [0.0, 2.0]",
        'supports = [0.0, { x = 2.0, kind = "clamped", stiffness = 1e6 }]',
        "segment[1].supports: a clamped support is rigid, and the one at 2 m has a stiffness; "
        "leave it out, or make the support pinned",
    ),
    "collar beyond the head": (
        "supports = [0.0, 2.0]",
        "supports = [0.0, 2.0]\ncollars = [{ span = [9.7, 10.3], thickness = 0.01 }]",
        "segment[1].collars[1].span: 10.3 m lies outside the segment; it must be between 0 and 10 "
        "m",
    ),
    "backward collar": (
        "supports = [0.0, 2.0]",
        "supports = [0.0, 2.0]\ncollars = [{ span = [9.9, 9.7], thickness = 0.01 }]",
        "segment[1].collars[1].span: must run from a smaller to a larger x, got [9.9, 9.7] m",
    ),
    "collar on a collar": (
        "supports = [0.0, 2.0]",
        "supports = [0.0, 2.0]\ncollars = [{ span = [9.5, 10.0], thickness = 0.01 }, "
        "{ span = [9.0, 9.7], thickness = 0.02 }]",
        "segment[1].collars: two lie on one another from 9.5 m on; give one of the thickness of "
        "both there",
    ),
    "collar without thickness": (
        "supports = [0.0, 2.0]",
        "supports = [0.0, 2.0]\ncollars = [{ span = [9.7, 10.0], thickness = 0.0 }]",
        "segment[1].collars[1].thickness: must be a number greater than 0, got 0.0",
    ),
    "diaphragm beyond the tip": (
        "span = [9.0, 19.0]",
        "span = [9.0, 19.0]\ndiaphragms = [{ x = 9.0, thickness = 0.008 }, "
        "{ x = 19.5, thickness = 0.008 }]",
        "segment[2].diaphragms[2].x: 19.5 m lies outside the segment; it must be between 9 and 19 "
        "m",
    ),
    "diaphragm of negative thickness": (
        "span = [9.0, 19.0]",
        "span = [9.0, 19.0]\ndiaphragms = [{ x = 9.0, thickness = -0.008 }]",
        "segment[2].diaphragms[1].thickness: must be a number greater than 0, got -0.008",
    ),
    "two diaphragms at one place": (
        "span = [9.0, 19.0]",
        "span = [9.0, 19.0]\ndiaphragms = [{ x = 9.0, thickness = 0.008 }, "
        "{ x = 9.0, thickness = 0.004 }]",
        "segment[2].diaphragms: a place is given twice; give each once",
    ),
    "diaphragm in the way of the inner segment": (
        "supports = [0.0, 2.0]",
        "supports = [0.0, 2.0]\ndiaphragms = [{ x = 0.0, thickness = 0.008 }, "
        "{ x = 9.5, thickness = 0.008 }]",
        "segment[1].diaphragms[2].x: 'inner' slides inside 'outer' at 9.5 m, and no plate can "
        "close the box there; it must be below 9 m",
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
    "lateral load in a flat boom": (
        "load = 55.07\n",
        "load = 55.07\nlateral_load = 20.0\n",
        "segment[2].lateral_load: the boom is flat, and nothing moves along 'y'; give the joints "
        "lateral_play",
    ),
    "friction of a tied joint": (
        "exponent = 2.0\n",
        "exponent = 2.0\ntied = true\nfriction = 0.2\nnormal_forces = [1.0, 1.0]\n",
        "joint[1].friction: the joint is tied, and nothing slides; leave it out",
    ),
    "pads longer than the overlap": (
        "exponent = 2.0\n",
        "exponent = 2.0\npad = { length = 1.5, width = 0.06 }\n",
        "joint[1].pad.length: must be above 0 and not above the overlap of 1 m, got 1.5 m",
    ),
    "pads wider than half a flange": (
        "exponent = 2.0\n",
        "exponent = 2.0\npad = { length = 0.1, width = 0.2 }\n",
        "joint[1].pad.width: must be above 0 and not above half a wall of the inner segment, "
        "0.135298 m, got 0.2 m",
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
    "pads across the flanges": (
        COARSE[COARSE.index("exponent = 2.0") :],
        COARSE[COARSE.index("exponent = 2.0") :]
        .replace("exponent = 2.0\n", "exponent = 2.0\npad = { length = 0.1, width = 0.06 }\n")
        .replace('"near webs"', '"across"'),
        "model[6].contact_line: 'across' leaves no place to the pads of joint[1]; give 'near "
        "webs', or leave pad out",
    ),
    "contact across the flanges in space": (
        COARSE[COARSE.index("exponent = 2.0") :],
        COARSE[COARSE.index("exponent = 2.0") :]
        .replace("exponent = 2.0\n", "exponent = 2.0\nlateral_play = 0.01\n")
        .replace('"near webs"', '"across"'),
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
        COARSE[COARSE.index("exponent = 2.0") :],
        COARSE[COARSE.index("exponent = 2.0") :]
        .replace("exponent", "lateral_play = 0.01\nlateral_exponent = 1.5\nexponent", 1)
        .replace('"near webs"', '"surface"\nsurface_stiffness = 1e14')
        .replace(CONTACT, "", 3),
        "model[6].surface_stiffness: its unit depends on the exponent, and the joints have 1.5 and "
        "2; leave it out, or give the model its own contact",
    ),
    "load of no segment": (
        "load = 55.07\n\n[[joint]]",
        'load = 55.07\n\n[[load]]\nsegment = "jib"\nmagnitude = 1.0\n\n[[joint]]',
        "load[1].segment: 'jib' is no segment; give 'outer' or 'inner'",
    ),
    "stop beside its segment": (
        "load = 55.07\n\n[[joint]]",
        'load = 55.07\n\n[[stop]]\nsegment = "inner"\nx = 3.0\nplay = 0.1\nstiffness = 1e7\n\n'
        "[[joint]]",
        "stop[1].x: 3 m lies outside 'inner'; it must be between 9 and 19 m",
    ),
    "series on a clamp": (
        "supports = [0.0, 2.0]",
        'supports = [0.0, { x = 2.0, kind = "clamped" }]',
        "model[1].base: 'outer' has clamped or elastic supports, for which the functions 'as "
        "printed' have no form; use base = 'complete'",
    ),
    "missing key": (
        "density = 7850.0\n",
        "",
        "material.density: missing; it is the density in kg/m^3",
    ),
    "missing key of a segment": (
        "span = [9.0, 19.0]\n",
        "",
        "segment[2].span: missing; it is the x of its two ends in m, rising",
    ),
    "missing key of a law": (
        CONTACT,
        "contact = { stiffness = 1e9 }",
        "model[3].contact.exponent: missing; it is the exponent n of the contact law",
    ),
    "missing mass": (
        "mass_per_length = 55.07\n",
        "",
        "segment[2].mass_per_length: missing; it is the mass per length in kg/m; follows from the "
        "section unless given",
    ),
    "missing kind": (
        'kind = "shell"\n',
        "",
        "model[6].kind: missing; give 'kantorovich', 'finite-element' or 'shell'",
    ),
    "missing section": (
        "height_to_width = 1.5\n",
        "",
        "segment[1].section: missing, and 'timoshenko' needs it; give section or height_to_width",
    ),
    "text for a number": (
        "duration = 0.6",
        'duration = "0.6"',
        "time.duration: must be a number, got '0.6'",
    ),
    "truth for a number": (
        "duration = 0.6",
        "duration = true",
        "time.duration: must be a number, got true",
    ),
    "number for a truth": (
        "tied = true",
        "tied = 1",
        "model[5].tied: must be true or false, got 1",
    ),
    "number for a text": (
        'title = "The paper\'s boom, coarse and short"',
        "title = 3",
        "title: must be a text, got 3",
    ),
    "number for a table": (
        CONTACT,
        "contact = 3",
        "model[3].contact: must be a table, got 3",
    ),
    "number for a list": (
        "span = [9.0, 19.0]",
        "span = 9.0",
        "segment[2].span: must be a list, got 9.0",
    ),
    "table for an array of tables": (
        "[[joint]]",
        "[joint]",
        "joint: must be an array of tables, each headed [[joint]], got {'outer': 'outer', "
        "'inner': 'inner', 'stations': [9.0, 10...",
    ),
    "part of a term": (
        "terms = [2, 3]",
        "terms = [2, 2.5]",
        "model[2].terms[2]: must be a whole number, got 2.5",
    ),
    "one end": (
        "span = [9.0, 19.0]",
        "span = [9.0]",
        "segment[2].span: must be a list of two numbers, got [9.0]",
    ),
    "three ends": (
        "span = [9.0, 19.0]",
        "span = [9.0, 14.0, 19.0]",
        "segment[2].span: must be a list of two numbers, got [9.0, 14.0, 19.0]",
    ),
    "negative": (
        "mass_per_length = 83.16",
        "mass_per_length = -83.16",
        "segment[1].mass_per_length: must be a number greater than 0, got -83.16",
    ),
    "zero": (
        "stiffness = 1e13",
        "stiffness = 0.0",
        "joint[1].stiffness: must be a number greater than 0, got 0.0",
    ),
    "negative play": (
        "play = 0.014",
        "play = -0.014",
        "joint[1].play: must be a number not less than 0, got -0.014",
    ),
    "infinite": (
        "span = [9.0, 19.0]",
        "span = [9.0, inf]",
        "segment[2].span[2]: must be a finite number, got inf",
    ),
    "not a number": (
        "youngs_modulus = 2.1e11",
        "youngs_modulus = nan",
        "material.youngs_modulus: must be a finite number, got nan",
    ),
    "incompressible": (
        "poissons_ratio = 0.3",
        "poissons_ratio = 0.5",
        "material.poissons_ratio: must be a number less than 0.5, got 0.5",
    ),
    "exponent below one": (
        "exponent = 2.0",
        "exponent = 0.5",
        "joint[1].exponent: must be a number not less than 1, got 0.5",
    ),
    "no terms": (
        "terms = [2, 3]",
        "terms = [2, 0]",
        "model[2].terms[2]: must be a number not less than 1, got 0",
    ),
    "unknown kind": (
        'kind = "shell"',
        'kind = "plate"',
        "model[6].kind: must be 'kantorovich', 'finite-element' or 'shell', got 'plate'",
    ),
    "unknown option": (
        'contact_line = "near webs"',
        'contact_line = "middle"',
        "model[6].contact_line: must be 'near webs', 'across' or 'surface', got 'middle'",
    ),
    "unknown statement": (
        "[time]",
        'demand = ["S1", "S12"]\n[time]',
        "demand[2]: must be 'S1', 'S2', 'S3', 'S4', 'S5', 'S6', 'S7', 'S8', 'S9', 'S10' or 'S11', "
        "got 'S12'",
    ),
    "name that is no file name": (
        'name = "beam-fe"',
        'name = "beam/fe"',
        "model[3].name: must be made of letters, digits, blanks and . _ + -, starting with one of "
        "the first, got 'beam/fe'",
    ),
    "model name twice": (
        'name = "kantorovich-5"',
        'name = "kantorovich-4"',
        "model[2].name: 'kantorovich-4' is the name of model[1] already; give each its own",
    ),
    "segment name twice": (
        'name = "inner"',
        'name = "outer"',
        "segment[2].name: 'outer' is the name of segment[1] already; give each its own",
    ),
    "joint of a stranger": (
        'inner = "inner"',
        'inner = "innner"',
        "joint[1].inner: 'innner' is no segment; give 'outer' or 'inner'",
    ),
    "joint with itself": (
        'inner = "inner"',
        'inner = "outer"',
        "joint[1].inner: must be another segment than the outer one",
    ),
    "terms for a third segment": (
        "terms = [2, 3]",
        "terms = [2, 3, 1]",
        "model[2].terms: must have one number for each of the 2 segments, got [2, 3, 1]",
    ),
    "contact of a tied model": (
        "tied = true",
        f"tied = true\n{CONTACT}",
        "model[5].contact: a tied model has no contact; leave it out",
    ),
    "backward segment": (
        "span = [9.0, 19.0]",
        "span = [19.0, 9.0]",
        "segment[2].span: must run from a smaller to a larger x, got [19, 9] m",
    ),
    "no overlap": (
        "span = [9.0, 19.0]",
        "span = [11.0, 19.0]",
        "joint[1]: 'outer' ends at 10 m before 'inner' starts at 11 m; the segments of a joint "
        "must overlap",
    ),
    "station outside the overlap": (
        "stations = [9.0, 10.0]",
        "stations = [9.0, 10.5]",
        "joint[1].stations: 10.5 m lies outside the overlap of 'outer' and 'inner'; it must be "
        "between 9 and 10 m",
    ),
    "no stations": (
        "stations = [9.0, 10.0]",
        "stations = []",
        "joint[1].stations: empty; give at least one",
    ),
    "support outside": (
        "supports = [0.0, 2.0]",
        "supports = [0.0, 12.0]",
        "segment[1].supports: 12 m lies outside the segment; it must be between 0 and 10 m",
    ),
    "nothing holds": (
        "supports = [0.0, 2.0]",
        "supports = []",
        "segment[1]: nothing holds 'outer': give it two supports, or a joint with two stations to "
        "a segment that is held",
    ),
    "inner box too large": (
        "mass_per_length = 55.07\nsecond_moment_of_area = 2.1829e-4\n",
        "section = { height = 0.49, width = 0.33, flange = 0.0065, web = 0.0065 }\n",
        "joint[1].play: 'inner' does not fit in 'outer': -0.014127 m of height and -0.0170849 m of "
        "width are free, and a play of 0.014 m is asked for; make the inner section or the play "
        "smaller",
    ),
    "section that does not close": (
        "play = 0.014",
        "play = 0.028",
        "segment[2].section: no uniform-wall box with A = 0.00701529 m² and J = 0.00021829 m⁴ "
        "closes a clearance of 0.014 m inside 0.488874 m x 0.325916 m x 0.00650084 m; give the "
        "section explicitly: pads then take up the difference to the stated clearance",
    ),
    "walls that fill the box": (
        "height_to_width = 1.5",
        "section = { height = 0.49, width = 0.33, flange = 0.0065, web = 0.4 }",
        "segment[1].section: walls of 0.0065 m (flange) and 0.4 m (web) leave no room in a box of "
        "0.49 m x 0.33 m; the walls must be thinner",
    ),
    "part of an output step": (
        "duration = 0.6",
        "duration = 0.6005",
        "time.duration: must be a whole number of output steps of 0.001 s, such as 0.6 s, got "
        "0.6005 s",
    ),
    "too many outputs": (
        "duration = 0.6",
        "duration = 1e9",
        "time.output_step: 0.001 s makes 1e+12 outputs of 1e+09 s; it must be at least 100 s",
    ),
    "step above the output step": (
        "duration = 0.6",
        "duration = 0.6\nstep = 0.01",
        "time.step: must not be above the output step of 0.001 s, got 0.01 s",
    ),
    "step of a model above the output step": (
        "terms = [2, 3]",
        "terms = [2, 3]\nstep = 0.01",
        "model[2].step: must not be above the output step of 0.001 s, got 0.01 s",
    ),
    "damping of a shell": (
        "load = 55.07",
        "load = 55.07\nviscous_damping = 10.0",
        "segment[2].viscous_damping: the shell 'shell' has none; leave it out, or run beams alone",
    ),
    "too many elements": (
        "element_length = 0.5",
        "element_length = 1e-9",
        "model[3].element_length: 1e-09 m makes more than 5000 elements of a segment; it must be "
        "at least 0.002 m",
    ),
    "a collar without its thickness": (
        "height_to_width = 1.5",
        "height_to_width = 1.5\ncollars = [{ span = [1.0, 2.0] }]",
        "segment[1].collars[1].thickness: missing; it is the thickness in m that it adds to all "
        "four walls",
    ),
    "an unknown key of a collar": (
        "height_to_width = 1.5",
        "height_to_width = 1.5\ncollars = [{ span = [1.0, 2.0], thick = 0.1 }]",
        "segment[1].collars[1].thick: unknown key; the nearest known one is thickness",
    ),
    "a diaphragm without its thickness": (
        "height_to_width = 1.5",
        "height_to_width = 1.5\ndiaphragms = [{ x = 1.0 }]",
        "segment[1].diaphragms[1].thickness: missing; it is the thickness in m",
    ),
    "a collar thicker than the box": (
        "height_to_width = 1.5",
        "height_to_width = 1.5\ncollars = [{ span = [1.0, 2.0], thickness = 5.0 }]",
        "segment[1].collars[1].thickness: must be at most 0.162958 m, half of what the box is "
        "across, got 5",
    ),
    "coordinates that are no number": (
        "mesh_size = 0.25",
        'mesh_size = 0.25\nmodes = "many"',
        "model[6].modes: must be a whole number above 0, or 'auto', got 'many'",
    ),
    "no coordinates": (
        "mesh_size = 0.25",
        "mesh_size = 0.25\nmodes = 0",
        "model[6].modes: must be a whole number above 0, or 'auto', got 0",
    ),
    "too many triangles": (
        "mesh_size = 0.25",
        "mesh_size = 1e-9",
        "model[6].mesh_size: 1e-09 m makes more than 2e+07 triangles; it must be at least "
        "0.00176 m",
    ),
    "out of proportion": (
        "play = 0.014",
        "play = 1e300",
        "segment: numbers out of proportion (Numerical result out of range); give them in SI units",
    ),
    "joint given twice": (
        "[[model]]",
        '[[joint]]\nouter = "inner"\ninner = "outer"\nstations = [9.5]\nplay = 0.014\n'
        "stiffness = 1e13\n\n[[model]]",
        "joint[2]: 'inner' and 'outer' are joined by joint[1] already; give all their stations "
        "there",
    ),
    "more terms than digits": (
        "terms = [2, 3]",
        "terms = [2, 61]",
        "model[2].terms: must not be above 60, where the polynomials lose their digits, got "
        "[2, 61]; use finite elements",
    ),
    "ratio beside a section": (
        "height_to_width = 1.5",
        "height_to_width = 1.5\nsection = { height = 0.49, width = 0.33, flange = 0.0065, "
        "web = 0.0065 }",
        "segment[1].height_to_width: the section is given; leave one of them out",
    ),
    "mass of another section": (
        "height_to_width = 1.5",
        "section = { height = 0.49, width = 0.33, flange = 0.0075, web = 0.0065 }",
        "segment[1].mass_per_length: 83.16 is not the section's own 88.862, and beams and shell "
        "would be different booms; leave it out, or change the section",
    ),
    "not TOML": (
        "[time]",
        "[time",
        "line 7: not TOML: Expected ']' at the end of a table declaration (column 6); see "
        "https://toml.io",
    ),
}

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beams that nothing can calibrate; see ``bad_edits``."""

from tests.runs.coarse_case import replacing

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

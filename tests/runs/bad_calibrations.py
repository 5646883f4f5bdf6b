# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beams that nothing can calibrate; see ``bad_edits``."""

from __future__ import annotations

_THEORY = 'theory = "timoshenko"\n'

CALIBRATIONS = {
    "calibrated by no model": (
        _THEORY,
        'calibrated_by = "plates"\n',
        "model[4].calibrated_by: 'plates' is not a shell of the case; give the name of one",
    ),
    "calibrated by a beam": (
        _THEORY,
        'calibrated_by = "beam-fe"\n',
        "model[4].calibrated_by: 'beam-fe' is not a shell of the case; give the name of one",
    ),
    "calibrated without play": (
        "tied = true",
        'tied = true\ncalibrated_by = "shell"',
        "model[5].calibrated_by: a tied model has no stations whose springs could be read; leave "
        "it out",
    ),
    "calibrated across": (
        _THEORY,
        'calibrated_by = { name = "wide", kind = "shell", contact_line = "across" }\n',
        "model[4].calibrated_by: the shell touches by 'across', where a beam has no springs; give "
        "one with contact_line = 'near webs'",
    ),
    "calibrated by a slip of the pen": (
        _THEORY,
        'calibrated_by = { name = "fine", kind = "shell", mesh_size = 1e-5 }\n',
        "model[4].calibrated_by.mesh_size: 1e-05 m makes more than 2e+07 triangles; it must be at "
        "least 0.00176 m",
    ),
    "calibrated by a shell that touches": (
        _THEORY,
        'calibrated_by = { name = "s", kind = "shell", contact = { force_file = "none.csv" } }\n',
        "model[4].calibrated_by.contact: of no use: the shell does not move, the beam does; give "
        "model[4].contact, or leave it out",
    ),
    "calibrated by a shell with a step": (
        _THEORY,
        'calibrated_by = { name = "s", kind = "shell", step = 1e-6 }\n',
        "model[4].calibrated_by.step: of no use: the shell does not move, the beam does; give "
        "model[4].step, or leave it out",
    ),
    "misspelled key of a shell that calibrates": (
        _THEORY,
        'calibrated_by = { name = "fine", kind = "shell", mesh_siz = 0.1 }\n',
        "model[4].calibrated_by.mesh_siz: unknown key; the nearest known one is mesh_size",
    ),
    "missing key of a shell that calibrates": (
        _THEORY,
        'calibrated_by = { kind = "shell" }\n',
        "model[4].calibrated_by.name: missing; it is the name of the model in the results",
    ),
    "calibrated by a number": (
        _THEORY,
        "calibrated_by = 5\n",
        "model[4].calibrated_by: must be a table, got 5",
    ),
    "fields of a section without a shell": (
        _THEORY,
        "section_fields = true\n",
        "model[4].section_fields: only a calibrated beam has them; give calibrated_by, or leave it "
        "out",
    ),
}

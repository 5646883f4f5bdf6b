# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slips in a case file: what stands in the coarse case, what replaces it, and the line it earns."""

from tests.runs.bad_booms import NUMBERS
from tests.runs.bad_calibrations import CALIBRATIONS
from tests.runs.bad_contacts import CONTACTS
from tests.runs.bad_forms import FORMS
from tests.runs.bad_stiffeners import STIFFENERS
from tests.runs.bad_supports import SUPPORTS

BAD_EDITS = [*FORMS, *NUMBERS, *CALIBRATIONS, *CONTACTS, *STIFFENERS, *SUPPORTS]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Study of statements that an accurate solution contradicts, by numerical methods of 1997."""

from studies.numerics_1997.tables import study as study

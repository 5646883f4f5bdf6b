# SPDX-License-Identifier: LGPL-3.0-or-later
"""Study of the paper's statements that an accurate solution contradicts, by numerics of 1997."""

from studies.numerics_1997.tables import study as study

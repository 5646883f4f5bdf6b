# SPDX-License-Identifier: LGPL-3.0-or-later
"""Examples of the paper by numerics of its time, for :mod:`studies.as_computed_then`."""

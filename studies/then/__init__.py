# SPDX-License-Identifier: LGPL-3.0-or-later
"""The examples of the paper by numerics of its time, for :mod:`studies.as_computed_then`."""

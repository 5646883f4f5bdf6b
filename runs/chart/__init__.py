# SPDX-License-Identifier: LGPL-3.0-or-later
"""Load charts: the rated capacity of a boom over radius and length, and what limits it."""

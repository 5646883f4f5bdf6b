# SPDX-License-Identifier: LGPL-3.0-or-later
"""Drives that telescope a boom: extension over time, moving rows, stick-slip."""

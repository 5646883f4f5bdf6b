# SPDX-License-Identifier: LGPL-3.0-or-later
"""Measured cost of runs."""

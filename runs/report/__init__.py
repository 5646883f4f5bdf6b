# SPDX-License-Identifier: LGPL-3.0-or-later
"""Presentation of a run: tables, figures, pictures and an HTML page."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Beams as gap systems: Kantorovich series, finite elements, rigid segments; static states."""

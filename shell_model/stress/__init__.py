# SPDX-License-Identifier: LGPL-3.0-or-later
"""Stresses and displacements of a reduced shell in motion."""

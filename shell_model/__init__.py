# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells as gap systems: FEniCSx forms, contact rows, reduction, stresses."""

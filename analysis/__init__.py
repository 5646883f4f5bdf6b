# SPDX-License-Identifier: LGPL-3.0-or-later
"""Mechanics of states of a model: section forces, stresses, pads, modes, buckling, fatigue."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Measurements of a boom: comparison with its model, identification of unknowns, prediction."""

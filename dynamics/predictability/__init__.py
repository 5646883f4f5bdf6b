# SPDX-License-Identifier: LGPL-3.0-or-later
"""Predictability of chaotic motion: ensembles and horizons."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Exports of models to other programs."""

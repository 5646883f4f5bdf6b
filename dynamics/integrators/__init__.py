# SPDX-License-Identifier: LGPL-3.0-or-later
"""The ways to move a gap system through time."""

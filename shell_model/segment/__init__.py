# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shell model of one segment."""

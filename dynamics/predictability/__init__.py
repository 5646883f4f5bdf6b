# SPDX-License-Identifier: LGPL-3.0-or-later
"""What can be known of a chaotic motion: ensembles, horizons, slow motion, comparison."""

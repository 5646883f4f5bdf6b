# SPDX-License-Identifier: LGPL-3.0-or-later
"""Case files in, trajectories, verdicts and a report out."""

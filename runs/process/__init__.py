# SPDX-License-Identifier: LGPL-3.0-or-later
"""The process that runs: its ranks, its signals, its streams, what it says."""

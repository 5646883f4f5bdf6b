# SPDX-License-Identifier: LGPL-3.0-or-later
"""The process: its ranks, signals, streams, progress and messages."""

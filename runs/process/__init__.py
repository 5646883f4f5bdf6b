# SPDX-License-Identifier: LGPL-3.0-or-later
"""Process control: ranks, signals, streams, progress and messages."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Runs of one case with varied values, and their charts."""

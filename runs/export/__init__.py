# SPDX-License-Identifier: LGPL-3.0-or-later
"""A boom for other programs."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""One segment as a shell of plates."""

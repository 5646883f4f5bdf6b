# SPDX-License-Identifier: LGPL-3.0-or-later
"""Files that are complete or absent, a run's folder, and the cache between runs."""

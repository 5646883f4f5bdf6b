# SPDX-License-Identifier: LGPL-3.0-or-later
"""Files that are complete or absent, folders of runs, and the cache between runs."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Parameter studies: runs of one case with varied values, and charts of the results."""

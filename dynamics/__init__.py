# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of gap systems, and its predictability."""

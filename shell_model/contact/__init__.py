# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact, friction and ties between segments: rows, and the local compliance of walls."""

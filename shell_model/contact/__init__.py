# SPDX-License-Identifier: LGPL-3.0-or-later
"""Contact, friction and bonded joints of shells: rows, and the local compliance of walls."""

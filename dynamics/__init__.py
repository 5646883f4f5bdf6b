# SPDX-License-Identifier: LGPL-3.0-or-later
"""How gap systems move, and what their motion is worth."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Where segments touch, rub or are tied: rows, and how much walls give way there."""

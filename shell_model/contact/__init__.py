# SPDX-License-Identifier: LGPL-3.0-or-later
"""Rows that read a shell where segments touch, rub or are held."""

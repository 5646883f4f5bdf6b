# SPDX-License-Identifier: LGPL-3.0-or-later
"""The case file: its schema, its reading and checking, and the boom and models that it defines."""

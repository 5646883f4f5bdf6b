# SPDX-License-Identifier: LGPL-3.0-or-later
"""A case file: what it may say, how it is read and checked, what it makes."""

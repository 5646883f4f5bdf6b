# SPDX-License-Identifier: LGPL-3.0-or-later
"""The paper's statements: rules that judge results, and readings of its data."""

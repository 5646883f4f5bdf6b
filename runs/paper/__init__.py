# SPDX-License-Identifier: LGPL-3.0-or-later
"""The paper's statements, and the rules that judge results by them."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cautions on a case: rules with condition, sentence and remedy, for ``check`` and ``run``."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Gap systems made of others: fewer coordinates, residual springs, ties."""

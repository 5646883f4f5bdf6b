# SPDX-License-Identifier: LGPL-3.0-or-later
"""Model reduction of a shell by Krylov bases of its symmetry classes."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Model reduction of a shell: symmetry classes, Krylov bases, distributed products."""

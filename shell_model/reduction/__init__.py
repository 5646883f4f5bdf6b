# SPDX-License-Identifier: LGPL-3.0-or-later
"""Few coordinates for a shell: mirror families, Krylov bases, distributed products."""

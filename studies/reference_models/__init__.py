# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reference models for verification: other shells, solids, the unreduced shell."""

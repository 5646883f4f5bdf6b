# SPDX-License-Identifier: LGPL-3.0-or-later
"""Models that serve proofs alone: other shells, solids, the unreduced shell."""

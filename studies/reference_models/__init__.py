# SPDX-License-Identifier: LGPL-3.0-or-later
"""Reference models for verification, for example solids, plates and the unreduced shell."""

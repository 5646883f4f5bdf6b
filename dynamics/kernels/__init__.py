# SPDX-License-Identifier: LGPL-3.0-or-later
"""The compiled loops of the integrators."""

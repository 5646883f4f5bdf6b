# SPDX-License-Identifier: LGPL-3.0-or-later
"""Many runs of one case with values varied, and their charts."""

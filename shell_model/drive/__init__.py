# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a drive changes of a boom's shells."""

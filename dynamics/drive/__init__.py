# SPDX-License-Identifier: LGPL-3.0-or-later
"""What moves rows while a boom is drawn out."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What draws a boom out, rows and thrusts that go along, and drives that stick and slip."""

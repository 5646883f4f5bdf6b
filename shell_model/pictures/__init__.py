# SPDX-License-Identifier: LGPL-3.0-or-later
"""Pictures of a shell in motion, and fields for ParaView."""

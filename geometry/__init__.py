# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the boom is made of: sections, segments, joints, loads, meshes."""

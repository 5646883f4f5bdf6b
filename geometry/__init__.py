# SPDX-License-Identifier: LGPL-3.0-or-later
"""Components of a boom: sections, segments, joints, loads, meshes."""

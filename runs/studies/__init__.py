# SPDX-License-Identifier: LGPL-3.0-or-later
"""What proves the models: each study has tables, curves, and values beside their references."""

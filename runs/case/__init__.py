# SPDX-License-Identifier: LGPL-3.0-or-later
"""Case files: the schema, the reader, the checks, and the boom and models of a case."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The pipeline from a case to results: models, motions, ensembles, summaries."""

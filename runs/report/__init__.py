# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a person sees of a run: tables, figures, pictures, one HTML page."""

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Files that are whole or not there, a run's folder, and what is kept between runs."""

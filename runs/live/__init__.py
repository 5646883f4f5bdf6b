# SPDX-License-Identifier: LGPL-3.0-or-later
"""The live page, on which a designer changes numbers of a case and sees the results of a beam."""

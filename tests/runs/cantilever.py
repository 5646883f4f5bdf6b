# SPDX-License-Identifier: LGPL-3.0-or-later
"""A cantilever under a uniform load as a case, and its closed forms."""

YOUNG, MASS, SECOND, LENGTH, LOAD = 2.0e11, 20.0, 1.0e-6, 4.0, 100.0

CANTILEVER = f"""
title = "Cantilever"
time = {{ duration = 0.2, output_step = 0.01 }}
material = {{ youngs_modulus = {YOUNG}, poissons_ratio = 0.3, density = 7850.0 }}
damping = {{ modal = 0.02 }}

[[segment]]
name = "beam"
length = {LENGTH}
supports = [{{ x = 0.0, kind = "clamped" }}]
mass_per_length = {MASS}
second_moment_of_area = {SECOND}
load = {LOAD}

[[model]]
name = "beam"
kind = "finite-element"
theory = "euler-bernoulli"
rotary_inertia = false
"""


def static_tip(length: float = LENGTH) -> float:
    """Return q L⁴/(8 E J) in m."""
    return LOAD * length**4 / (8.0 * YOUNG * SECOND)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What play adds to a boom that rests: the fly turns until it touches above and below."""

from boom_in_python import LAW, boom

import protractile as pt


def deflection(tied: bool) -> float:
    """Static deflection of the tip in m, with the joint's play or without."""
    system = pt.finite_element_system(boom(tied), [LAW], element_length=1.0)
    return float(system.observers["tip"].row @ pt.equilibrium(system, system.load))


if __name__ == "__main__":
    with_play, without = deflection(tied=False), deflection(tied=True)
    print(f"{1e3 * with_play:.2f} mm with play, {1e3 * without:.2f} mm without")

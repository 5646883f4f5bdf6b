# SPDX-License-Identifier: LGPL-3.0-or-later
"""Effect of play on a boom at rest: the fly rotates until it touches above and below."""

from boom_in_python import boom

import protractile as pt


def deflection(bonded: bool) -> float:
    """Return the static deflection of the tip in m, with or without the joint's play."""
    model = pt.BeamElements(boom(), bonded=bonded)
    return float(model.simulate(1.0e-3, at_rest=True).tip[0])


if __name__ == "__main__":
    with_play, without = deflection(bonded=False), deflection(bonded=True)
    print(f"{1e3 * with_play:.2f} mm with play, {1e3 * without:.2f} mm without")

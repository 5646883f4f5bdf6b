# SPDX-License-Identifier: LGPL-3.0-or-later
"""What of a boom is out of proportion, and deserves a caution."""

from __future__ import annotations

from dynamics.equilibrium import equilibrium
from dynamics.failure import NumericsError
from dynamics.gap_system import GapSystem
from geometry.boom import Boom

# Part of the critical force above which the second order is no small correction.
CLOSE = 1.0 / 3.0

# Part of the boom's length beyond which a static tip is no small deflection.
FAR = 0.05


def static_tip(system: GapSystem) -> float:
    """The tip's deflection in m at rest under the constant loads; NaN where there is no such rest.

    Args:
        system: all that stays constant from t = 0 on is in its ``load``.
    """
    try:
        return float(system.observers["tip"].row @ equilibrium(system, system.load))
    except NumericsError:
        return float("nan")


def of_buckling(name: str, critical_factor: float | None) -> list[str]:
    """A caution against a model's axial forces, if they deserve one.

    Args:
        name: of the model.
        critical_factor: of its axial forces, None where it is not known or there are none.
    """
    if critical_factor is None or critical_factor * CLOSE >= 1.0:
        return []
    return [
        f"caution: in {name} the axial forces are {100.0 / critical_factor:.3g} % of those under "
        "which the boom buckles, more than a third: deflections grow out of proportion"
    ]


def of_tip(where: str, tip: float | None, boom: Boom) -> list[str]:
    """A caution against a deflection at rest, if it deserves one.

    Args:
        where: ``in MODEL``, say.
        tip: in m, NaN or None where there is no rest.
        boom: from whose first end to its tip is its length.
    """
    if tip is None or not abs(tip) > FAR * boom.length:
        return []
    return [
        f"caution: {where} the tip rests at {tip:.3g} m, {100.0 * abs(tip) / boom.length:.2g} % of "
        "the boom's length and more than 5 %: small displacements do not hold; check units and "
        "loads"
    ]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Terms of contact laws: one-sided powers of a penetration.

Python and the compiled loops share these formulas. The potential serves the energy balance, which
checks every trajectory.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

# Types of arrays: (num_terms,) of TERM, (num_rows,) of LIMITS.
Terms = npt.NDArray[np.void]
Limits = npt.NDArray[np.void]

# Types: a relative displacement y, or an array of them; a function of a term and y, or of the
# arrays of several terms with one exponent and y.
Gap = Any
OfTerm = Callable[[Any, Gap], Gap]

# Record of a term in the law of a row.
TERM = np.dtype(
    [
        ("row", np.int64),
        ("side", np.float64),
        ("stiffness", np.float64),
        ("onset", np.float64),
        ("exponent", np.float64),
    ]
)
# Record of the y in m between which a contact is open, and of its damping χ in s/m.
LIMITS = np.dtype([("low", np.float64), ("high", np.float64), ("damping", np.float64)])


class Term(NamedTuple):
    """One-sided power law F = side · k max(side · y − onset, 0)ⁿ.

    >>> pt.PowerContact(1e6, 1.0).lower().with_clearance(0.01).terms
    (Term(side=-1.0, stiffness=1000000.0, onset=0.01, exponent=1.0),)
    """

    side: float  #: 1 for contact at positive y, −1 at negative y
    stiffness: float  #: k in N/mⁿ; negative where a law becomes softer
    onset: float  #: distance in m from y = 0 at which contact begins
    exponent: float  #: n, at least 1


def force_of(term: np.void, y: Gap) -> Gap:
    """Return the force in N of a term at relative displacements y in m."""
    depth, n = np.maximum(term["side"] * y - term["onset"], 0.0), term["exponent"]
    power = depth if n == 1.0 else depth * depth if n == 2.0 else depth**n
    return term["side"] * term["stiffness"] * power


def energy_of(term: np.void, y: Gap) -> Gap:
    """Return the potential in J of a term at relative displacements y in m."""
    depth, n = np.maximum(term["side"] * y - term["onset"], 0.0), term["exponent"]
    return term["stiffness"] * depth ** (n + 1.0) / (n + 1.0)


def slope_of(term: np.void, y: Gap) -> Gap:
    """Return dF/dy in N/m of a term at relative displacements y in m."""
    depth, n = np.maximum(term["side"] * y - term["onset"], 0.0), term["exponent"]
    return np.sign(depth) * n * term["stiffness"] * depth ** (n - 1.0)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Cautions on the response of a boom: period, buckling, and large deflections."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from protractile.geometry.boom import Boom
from protractile.runs.case.schema import Case

# Fraction of the buckling load above which second-order effects are not small.
NEAR_BUCKLING = 1.0 / 3.0

# Fractions of the length of the boom: the error of small displacements is told above the first one,
# and is a caution above the second one.
TOLD_DEFLECTION, LARGE_DEFLECTION = 0.05, 0.15

# Errors of tip deflection and moments by small displacements, over the square of the deflection as
# a fraction of the length; measured on elasticas with play (studies/large_deflections.py).
TIP_ERROR, MOMENT_ERROR = 1.1, 0.65

# Advice on a large deflection without a known cause.
CHECK_UNITS = "check units and loads"

# Number of periods of the boom beyond which a run is too long for a design.
MANY_PERIODS = 1000.0


def period_cautions(where: str, frequency: float, case: Case) -> Iterator[str]:
    """Yield a caution if the run is shorter than one period of the boom, or has very many periods.

    ``where`` names the source of the frequency, for example ``in MODEL``. The frequency is the
    first one in Hz, with closed contacts.
    """
    duration = case.time.duration
    periods, run = duration * frequency, f"caution: time.duration: the run of {duration:g} s"
    if periods > MANY_PERIODS:
        yield (
            f"{run} has {periods:.3g} periods {where}; if the duration is in ms, give "
            f"{1e-3 * duration:g} s"
        )
    elif periods < 1.0:
        yield (
            f"{run} is shorter than one period {where}, {1.0 / frequency:.3g} s; usual are three "
            "periods at least"
        )


def buckling_cautions(name: str, critical_factor: float | None) -> Iterator[str]:
    """Yield a caution if the axial forces of a model are close to buckling.

    The factor is None without axial forces, or if it is not computed.
    """
    if critical_factor is not None and critical_factor * NEAR_BUCKLING < 1.0:
        yield (
            f"caution: in {name} the axial forces are {100.0 / critical_factor:.3g} % of those "
            "under which the boom buckles, more than a third: deflections grow out of proportion"
        )


def tip_cautions(
    where: str, tip: float | None, boom: Boom, advise: Callable[[], str] = lambda: CHECK_UNITS
) -> Iterator[str]:
    """Yield the error of a static deflection by small displacements, a caution if it is large.

    ``where`` names the source of the deflection, for example ``in MODEL``. The deflection is in m,
    and NaN or None without an equilibrium. ``advise`` returns the advice.
    """
    if tip is not None:
        yield from deflection_errors(f"{where} the tip rests at {tip:.3g} m", tip, boom, advise)


def deflection_errors(
    what: str, tip: float, boom: Boom, advise: Callable[[], str]
) -> Iterator[str]:
    """Yield the error by small displacements of a deflection in m, which ``what`` tells."""
    part = abs(tip) / boom.length
    if not part > TOLD_DEFLECTION:
        return
    told = (
        f"{what}, {100.0 * part:.2g} % of the boom's length: small displacements make it about "
        f"{100.0 * TIP_ERROR * part**2:.2g} % too large, and moments about "
        f"{100.0 * MOMENT_ERROR * part**2:.2g} %"
    )
    if part > LARGE_DEFLECTION:
        yield f"caution: {told}; {advise()}"
    else:
        yield f"{told[0].upper()}{told[1:]}, on the safe side."

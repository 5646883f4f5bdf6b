# SPDX-License-Identifier: LGPL-3.0-or-later
"""Error of small displacements, second-order theory, against two elasticas with play.

With the deflection w of the tip and the length L, the tip deflection is about 1.1 (w/L)² and the
moment at the foot about 0.65 (w/L)² too large. Play adds a second part: small displacements leave
out the couple P Δ of the axial force P where it passes to the inner segment, a clearance Δ above
the axis of the outer one. It raises the boom, and leaving it out is on the safe side, too.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from protractile.beam_model.statics import static_state
from protractile.geometry.boom import Boom, BoomError
from protractile.runs.case.build import build_boom
from protractile.runs.case.schema import Case
from protractile.runs.cautions.response import MOMENT_ERROR, TIP_ERROR
from protractile.runs.report.tables import Table
from studies.reference_models.elastica import Rest, Rod, Telescope
from studies.study import Progress, Verification, define_study

GRAVITY, MODULUS = 9.80665, 2.1e11
ANGLES, PLAYS, PARTS = (0.0, 45.0, 70.0), (0.0, 0.02), (0.05, 0.1, 0.15)
# Range of loads at the tip in N, up to deflections of more than the largest part.
LOADS = 10.0, 1.0e5
# Permitted relative errors of tip and moment after correction by the rule, at the largest part.
ALLOWED = 0.005


class Compared(NamedTuple):
    """A boom at rest by second-order theory and by elasticas."""

    tip: float  #: deflection of the tip in m by second-order theory, negative downwards
    moment: float  #: moment at the foot in N m by second-order theory
    exact: Rest  #: state of the elasticas

    @property
    def errors(self) -> tuple[float, float]:
        """The relative errors of tip deflection and moment, positive on the safe side."""
        return self.tip / self.exact.tip - 1.0, self.moment / self.exact.foot_moment - 1.0


def telescope(load: float, angle: float, play: float) -> Telescope:
    """Return a boom of 17 m with a load in N at its tip; angle in degrees, play in m."""
    outer, inner = Rod(10.0, 3.0e7, 600.0), Rod(9.0, 1.5e7, 300.0)
    return Telescope(outer, inner, 2.0, play, load, float(np.deg2rad(angle)))


def boom_of(telescope: Telescope) -> Boom:
    """Return the boom of small displacements with the data of two elasticas."""
    outer, inner = (
        {
            "name": name,
            "length": rod.length,
            "mass_per_length": rod.weight / GRAVITY,
            "second_moment_of_area": rod.stiffness / MODULUS,
        }
        for name, rod in (("outer", telescope.outer), ("inner", telescope.inner))
    )
    tables = {
        "title": "two segments",
        "time": {"duration": 1.0},
        "gravity": {"angle": float(np.rad2deg(telescope.angle)), "acceleration": GRAVITY},
        "payload": {"mass": telescope.load / GRAVITY},
        "material": {"youngs_modulus": MODULUS, "poissons_ratio": 0.3, "density": 7850.0},
        "segment": [{**outer, "supports": [{"x": 0.0, "kind": "clamped"}]}, inner],
        "joint": [
            {
                "outer": "outer",
                "inner": "inner",
                "extension": telescope.inner.length - telescope.overlap,
                "stations": ["tail", "head"],
                "play": telescope.play,
                "stiffness": 1.0e12,
                "exponent": 1.0,
            }
        ],
        "model": [{"name": "beam", "kind": "finite-element", "theory": "euler-bernoulli"}],
    }
    return build_boom(Case.model_validate(tables))


def second_order(telescope: Telescope) -> tuple[float, float]:
    """Return the deflection of the tip in m and the moment at the foot in N m."""
    state = static_state(boom_of(telescope))
    foot = next(one for one in state.reactions if one.segment == 0 and one.x == 0.0)
    return state.tip, -foot.moment


def compare(part: float, angle: float, play: float) -> Compared:
    """Compare both theories at a load that deflects the tip by a part of the length."""

    def excess(load: float) -> float:
        boom = telescope(load, angle, play)
        try:
            return second_order(boom)[0] / boom.length + part
        except BoomError:
            return -1.0  # The boom buckles.

    loaded = telescope(brentq(excess, *LOADS, xtol=1.0), angle, play)
    return Compared(*second_order(loaded), loaded.rest())


@define_study("large_deflections", "Large deflections of booms with play")
def study(progress: Progress) -> Iterator[Verification | Table]:
    """Compare tips and moments at the foot at three angles, with and without play."""
    rows = []
    for angle, play in product(ANGLES, PLAYS):
        progress(f"{angle:g} degrees, play of {1e3 * play:g} mm")
        for part in PARTS:
            found = compare(part, angle, play)
            rows.append((angle, play, part, *found.errors))
        where = f"{part:.0%} of the length, {angle:g}°, play {1e3 * play:g} mm".replace("%", " %")
        source = "two elasticas, times 1 + {:g} (w/L)²"
        yield Verification(
            f"tip deflection at {where}", found.tip, found.exact.tip * (1.0 + TIP_ERROR * part**2),
            "m", "other code", source.format(TIP_ERROR), ALLOWED,
        )  # fmt: skip
        yield Verification(
            f"moment at the foot at {where}", found.moment,
            found.exact.foot_moment * (1.0 + MOMENT_ERROR * part**2),
            "N m", "other code", source.format(MOMENT_ERROR), ALLOWED,
        )  # fmt: skip
    yield Table.of_rows(
        "large-deflections",
        "Errors of small displacements, positive on the safe side",
        (
            ("luffing angle, degrees", ".3g", ""),
            ("play", ".3g", "mm"),
            ("tip over length", ".3g", "%"),
            ("error of the tip", ".2g", "%"),
            ("error of the moment", ".2g", "%"),
        ),
        rows,
    )

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Study of design results at rest against the lever rule."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from mpi4py import MPI

from protractile.analysis.curves import Curve
from protractile.analysis.rows import BEAM, INITIAL, REST
from protractile.dynamics.line import LineQuantity
from protractile.runs import CASES
from protractile.runs.case import reading as case_file
from protractile.runs.pipeline.model_run import RunContext
from protractile.runs.pipeline.results import Results
from protractile.runs.pipeline.run import run_case
from studies.study import Criterion, Progress, Verification, define_study

# Distributed loads in N/m on both segments of the paper's boom.
OUTER, INNER = 83.16, 55.07
# Positions in m of the stations, the second support and the tip; play in m; contacts in N/m.
TAIL, HEAD, SUPPORT, TIP, PLAY, STIFF = 9.0, 10.0, 2.0, 19.0, 0.014, 1.0e9
MODELS = ("timoshenko", "shell")
# Places in m between which section forces are compared.
ALONG_OUTER, ALONG_INNER = 5.5, 14.0

# Elements of half a metre have moments with errors up to q h²/12, here 1.7 N m.
CLOSE, OF_PIECES, EXACT = 1.0e-3, 5.0e-3, 1.0e-6
LEVERS: Criterion = ("analytic", "lever rule", EXACT)


@define_study("design-results", "Design results")
def study(progress: Progress) -> Iterator[Verification]:
    """Compare the paper's boom at rest with closed forms."""
    progress("the paper's boom at rest")
    results = results_at_rest()
    for name in MODELS:
        yield from _at_rest(name, results)
    reactions = results.rows.where(model=BEAM, state=INITIAL, play=True, quantity="reaction")
    supports = [row for row in reactions if not row.place.startswith("contact")]
    for held, force in zip(supports, support_forces(), strict=True):
        what = f"reaction at {held.x:g} m"
        yield Verification(what, 1e-3 * held.value, 1e-3 * force, "kN", *LEVERS)


def results_at_rest() -> Results:
    """Return the results of the paper's boom from a very short run."""
    case = case_file.load(str(CASES / "coarse.toml"))
    time = case.time.model_copy(update={"duration": 0.01})
    models = tuple(model for model in case.models if model.name in MODELS)
    short = case.model_copy(update={"models": models, "time": time})
    run = run_case(short, "coarse.toml", RunContext(MPI.COMM_SELF))
    assert run is not None
    run.evaluate()
    return run.results


def station_forces() -> tuple[float, float]:
    """Return the contact forces at tail and head in N by the lever rule.

    They act on the outer segment; positive forces act upwards.
    """
    load = INNER * (TIP - TAIL)
    head = load * (0.5 * (TIP + TAIL) - TAIL) / (HEAD - TAIL)
    return load - head, head


def support_forces() -> tuple[float, float]:
    """Return the forces in N at both supports of the outer segment; upward forces are positive."""
    tail, head = station_forces()
    far = -(0.5 * OUTER * HEAD**2 + tail * TAIL + head * HEAD) / SUPPORT
    return -OUTER * HEAD - tail - head - far, far


def _at_rest(name: str, results: Results) -> Iterator[Verification]:
    rows = results.rows.where(model=name, state=REST, play=True)
    tail, head = station_forces()
    tilt = (PLAY + (abs(tail) + head) / STIFF) / (HEAD - TAIL)
    criterion: Criterion = (
        "analytic",
        "2 Δ and the compression of contacts, over the overlap",
        CLOSE,
    )
    (rotation,) = rows.where(quantity="rotation")
    turned = 1e3 * rotation.value
    yield Verification(f"tilt of the joint, {name}", turned, 1e3 * tilt, "mrad", *criterion)
    contacts = rows.where(quantity="contact_force")
    for pressed, force in zip(contacts, (tail, head), strict=True):
        what = f"contact force at {pressed.x:g} m, {name}"
        yield Verification(what, 1e-3 * pressed.value, 1e-3 * force, "kN", *LEVERS)
    at_foot, far = support_forces()
    x, s = ALONG_OUTER, TIP - ALONG_INNER
    outer, inner = results.curves.where(model=name, state=REST, play=True)
    bent = -(at_foot * x + far * (x - SUPPORT) + 0.5 * OUTER * x**2)
    comparisons: tuple[tuple[Curve, float, LineQuantity, str, float], ...] = (
        (outer, x, "shear", "kN", -(at_foot + far + OUTER * x)),
        (outer, x, "moment", "kN m", bent),
        (inner, ALONG_INNER, "shear", "kN", INNER * s),
        (inner, ALONG_INNER, "moment", "kN m", -0.5 * INNER * s**2),
    )
    for curve, place, quantity, unit, force in comparisons:
        found = 1e-3 * float(np.interp(place, curve.x, curve.values[quantity]))
        named = f"{quantity} at {place:g} m, {name}"
        yield Verification(named, found, 1e-3 * force, unit, "analytic", "by hand", OF_PIECES)

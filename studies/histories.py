# SPDX-License-Identifier: LGPL-3.0-or-later
"""Responses to loads with histories, compared with closed forms."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from dynamics.excitation import Excitation, PiecewiseLinear, Ramp, Sine
from dynamics.gap_system import GapSystem, Observer
from dynamics.integrator import FixedStep
from dynamics.motion import Motion
from geometry.arrays import Array
from studies.study import Criterion, Progress, Verification, define_study

# Output step, time step and duration in s. A step is a tenth of the smallest 1/ω below.
OUTPUT_STEP, STEP = 0.02, 2.0e-5
DURATION = 4.0
# ω in rad/s of 1 kg on a spring: free, as slow as a boom, as fast as the plates of a shell.
OMEGAS = (0.0, 2.0, 19.0, 300.0, 5.0e3)
# ω in rad/s of the mass whose vibration is reported.
BOOM = 19.0
# Force in N.
FORCE = 10.0

DUHAMEL: Criterion = ("analytic", "Duhamel's integral of each line", 1.0e-8)

_MANY = np.linspace(0.011, 2.9, 1500)
KINKED: Mapping[str, Ramp | PiecewiseLinear] = {
    "a ramp of 0.71 s": Ramp(0.71),
    "kinks at 0.7 and 1.2 s": PiecewiseLinear((0.0, 0.7, 1.2), (0.5, 1.0, -0.5)),
    "kinks at 0.303, 0.311 and 0.7 s": PiecewiseLinear(
        (0.0, 0.303, 0.311, 0.7), (0.0, 1.0, -2.0, 0.3)
    ),
    "a table of 1500 points": PiecewiseLinear(_MANY.tolist(), np.sin(40.0 * _MANY).tolist()),
    "a rise within 1 ms": PiecewiseLinear((0.507, 0.508), (0.0, 1.0)),
}


def response(omega: float, history: Ramp | PiecewiseLinear, time: Array) -> Array:
    """Return the displacement (num_times,) in m of 1 kg from rest under 1 N times a history.

    A spring of ω² N/m holds the mass. The closed form is the sum of the responses to a constant
    load from t = 0 on, and to a ramp from each kink on with the change of slope at the kink.

    Args:
        omega: ω in rad/s, 0 without a spring.
        history: piecewise linear history from t = 0 on.
        time: (num_times,) in s.
    """
    kinks = np.array(history.kinks)
    values = history(kinks)
    slopes = np.diff(values) / np.diff(kinks)
    way = values[0] * 0.5 * time**2 * np.sinc(0.5 * omega * time / np.pi) ** 2
    for begin, change in zip(kinks, np.diff(slopes, prepend=0.0, append=0.0), strict=True):
        since = np.maximum(time - begin, 0.0)
        if omega == 0.0:
            way = way + change * since**3 / 6.0
        else:
            way = way + change * (since - np.sin(omega * since) / omega) / omega**2
    return np.asarray(way)


def masses(history: Ramp | Sine | PiecewiseLinear) -> GapSystem:
    """Return a system of one mass for each of ``OMEGAS``, under 1 N times a history.

    The name of an output is the ω of its mass.
    """
    n = len(OMEGAS)
    return GapSystem(
        omega2=np.square(OMEGAS),
        load=np.zeros(n),
        rows=np.zeros((0, n)),
        laws=[],
        station_of_row=np.zeros(0, dtype=np.int64),
        stations=[0.0],
        observers={f"{w:g}": Observer(row) for w, row in zip(OMEGAS, np.eye(n), strict=True)},
        excitations=[Excitation(np.ones(n), history)],
    )


@define_study("histories", f"Loads with histories, steps of {STEP:g} s")
def study(progress: Progress) -> Iterator[Verification]:
    """Compare vibrations under histories with kinks with closed forms."""
    for what, history in KINKED.items():
        progress(what)
        run = FixedStep(STEP)(Motion(masses(history), DURATION, OUTPUT_STEP))
        found = {omega: run.data[f"{omega:g}"].values for omega in OMEGAS}
        expected = {omega: response(omega, history, run.time) for omega in OMEGAS}
        after = run.time > history.kinks[-1]
        measured, exact = (
            FORCE * 1.0e3 * 0.5 * np.ptp(way[BOOM][after]) for way in (found, expected)
        )
        worst = max(np.abs(found[w] - expected[w]).max() / np.ptp(expected[w]) for w in OMEGAS)
        swing = f"{what}: swing left at {BOOM / (2.0 * np.pi):.2g} Hz"
        largest = f"{what}: largest error, 0 to {OMEGAS[-1] / (2.0 * np.pi):.0f} Hz, part of range"
        yield Verification(swing, measured, exact, "mm", *DUHAMEL)
        yield Verification(largest, float(worst), 0.0, "", *DUHAMEL)

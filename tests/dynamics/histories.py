# SPDX-License-Identifier: LGPL-3.0-or-later
"""Closed forms of vibrations under histories with kinks."""

from collections.abc import Mapping

import numpy as np

from dynamics.arrays import Array
from dynamics.excitation import Excitation, PiecewiseLinear, Ramp, Sine
from dynamics.gap_system import GapSystem, Observer

# ω in rad/s of 1 kg on a spring: free, as slow as a boom, as fast as the plates of a shell.
OMEGAS = (0.0, 2.0, 19.0, 300.0, 5.0e3)

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

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What the schemes of :mod:`studies.then.modal_integrators` make of an oscillator."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dynamics.gap_system import GapSystem, Observer
from dynamics.motion import Motion
from studies.study import Proof
from studies.then.modal_integrators import CENTRAL, NEWMARK, WILSON, Scheme, integrate

PER_PERIOD = 10
# Steps from which a root is read.
STEPS = 100

SOURCE = "roots of the amplification matrix, Bathe 1996"


def textbook_root(scheme: Scheme, phase: float) -> complex:
    """The root λ with which a scheme takes an oscillator from step to step, without damping.

    Newmark's and the central differences' in closed form, Wilson's from his amplification matrix
    (Bathe 1996, section 9.4).

    Args:
        scheme: of the three.
        phase: ω h.
    """
    if scheme == NEWMARK:
        return complex(np.exp(2.0j * np.arctan(0.5 * phase)))
    if scheme == CENTRAL:
        return complex(np.exp(2.0j * np.arcsin(0.5 * phase)))
    theta = scheme.theta
    b = 1.0 / (theta / phase**2 + theta**3 / 6.0)
    matrix = [
        [1.0 - b * theta**2 / 3.0 - 1.0 / theta, -b * theta, -b],
        [1.0 - 0.5 / theta - b * theta**2 / 6.0, 1.0 - 0.5 * b * theta, -0.5 * b],
        [0.5 - (1.0 / theta + b * theta**2 / 3.0) / 6.0, 1.0 - b * theta / 6.0, 1.0 - b / 6.0],
    ]
    return _turning(np.linalg.eigvals(matrix))


def own_root(scheme: Scheme, phase: float) -> complex:
    """The same, read from the motion of an oscillator."""
    motion = Motion(oscillator(), STEPS * phase, phase, position=np.ones(1))
    way = integrate(motion, scheme, settled=False).trajectory.states[:, 0]
    behind = np.stack([way[2:-1], way[1:-2], way[:-3]], axis=1)
    return _turning(np.roots([1.0, *-np.linalg.lstsq(behind, way[3:], rcond=1.0e-9)[0]]))


def oscillator() -> GapSystem:
    """1 kg on a spring of 1 N/m."""
    return GapSystem(
        omega2=np.ones(1),
        load=np.zeros(1),
        rows=np.zeros((0, 1)),
        laws=[],
        station_of_row=np.zeros(0, dtype=np.int64),
        stations=[],
        observers={"tip": Observer(np.ones(1))},
    )


def longer_period(root: complex, phase: float) -> float:
    """By which part a root makes the period longer."""
    return float(phase / np.angle(root)) - 1.0


def lost_amplitude(root: complex) -> float:
    """Which part of the amplitude is lost in a period."""
    return 1.0 - float(abs(root) ** (2.0 * np.pi / np.angle(root)))


def proofs() -> Iterator[Proof]:
    """Period and amplitude of each scheme in ten steps a period."""
    phase = 2.0 * np.pi / PER_PERIOD
    for scheme in (NEWMARK, WILSON, CENTRAL):
        roots = own_root(scheme, phase), textbook_root(scheme, phase)
        periods, amplitudes = (
            [100.0 * error for error in errors]
            for errors in (
                [longer_period(root, phase) for root in roots],
                [lost_amplitude(root) for root in roots],
            )
        )
        name = f"{scheme.name}, {PER_PERIOD} steps a period"
        for what, (value, reference) in (
            ("period longer by", periods),
            ("amplitude lost in a period", amplitudes),
        ):
            yield Proof(f"{name}: {what}", value, reference, "%", "analytic", SOURCE, 1.0e-6)


def _turning(roots: object) -> complex:
    """Of several roots the one that turns forward."""
    return complex(max(np.asarray(roots), key=lambda root: root.imag))

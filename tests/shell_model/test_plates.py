# SPDX-License-Identifier: LGPL-3.0-or-later
"""Plates that vibrate, sections that twist, boxes that keep their frequencies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

pytest.importorskip("dolfinx", reason="the shell model needs DOLFINx")

from shell_model.segment.segment_shell import SegmentShell
from studies.reference_models.eigenmodes import natural_frequencies
from studies.reference_models.plates import SupportedPlate
from studies.reference_models.prismatic import ANGLE, PlainBox
from studies.reference_models.prismatic import BOX as CLOSED
from tests.shell_model.booms import HELD, flat_boom

Shells = Callable[..., SegmentShell]

# Lowest natural frequencies in Hz of a box of 10 m on a mesh of 0.5 m: free, and on supports at
# 0 and 2 m, where the first is the slide along x.
FREE = (
    25.23296631827,
    34.16495354744,
    59.59588382613,
    64.99647238202,
    65.45243516437,
    65.54237275717,
    78.50521431606,
    83.36311545635,
    89.62613755159,
    95.6675575299,
)
SUPPORTED = (
    5.37271909244,
    7.27710022704,
    33.64996850047,
    45.57760117127,
    59.81964907369,
    68.14177774986,
)


def test_boxes_have_the_same_frequencies_on_every_release(box_shell: Shells) -> None:
    """Reference: non-regression, with DOLFINx 0.5.2. Round-off is some 1e-11."""
    free = natural_frequencies(box_shell(0.5), 6 + len(FREE))
    np.testing.assert_allclose(free[6:], FREE, rtol=1.0e-8)
    held = natural_frequencies(box_shell(0.5, supports=HELD), 1 + len(SUPPORTED))
    np.testing.assert_allclose(held[1:], SUPPORTED, rtol=1.0e-8)


@pytest.mark.slow
def test_a_thin_plate_vibrates_after_kirchhoff() -> None:
    """Reference: analytic, π² (m²/a² + n²/b²) √(D/ρt), t/a = 1e-3: shear is 2e-5 of it.

    Order 2 of the frequencies, from above.
    """
    plate = SupportedPlate(1.0, 0.8, 0.001)
    exact = plate.kirchhoff(4)
    errors = np.array([plate.frequencies(n, 4) / exact - 1.0 for n in (8, 16, 32)])
    assert (errors > 0.0).all()
    assert errors[-1].max() < 7.0e-3
    assert errors[-1, 0] < 2.0e-3
    orders = np.log2(errors[:-1] / errors[1:])
    assert (orders > 1.7).all()


@pytest.mark.slow
def test_a_thick_plate_vibrates_after_mindlin() -> None:
    """Reference: analytic, Mindlin (1951) with 5/6, t/a = 0.1, where shear and rotary inertia take
    4 to 14 % off Kirchhoff's frequencies."""
    plate = SupportedPlate(1.0, 0.8, 0.1)
    exact = plate.mindlin(4)
    assert (exact < 0.96 * plate.kirchhoff(4)).all()
    errors = np.array([plate.frequencies(n, 4) / exact - 1.0 for n in (16, 32)])
    assert np.abs(errors[-1]).max() < 2.5e-3
    assert (np.log2(errors[0] / errors[1]) > 1.5).all()


@pytest.mark.slow
def test_an_open_section_twists_after_saint_venant() -> None:
    """Reference: analytic, Σ b t³/3; the corner's and the edges' own share is 0.3 %."""
    assert ANGLE.torsion_constant(4, 80) == pytest.approx(ANGLE.thin_walled_constant, rel=3.0e-3)


@pytest.mark.slow
def test_a_closed_section_twists_after_bredt() -> None:
    """Reference: analytic, 4 A² t/Σ b + Σ b t³/3. The stiff tie of curved shells is off by 1 %."""
    exact = CLOSED.thin_walled_constant
    assert CLOSED.torsion_constant(4, 80) == pytest.approx(exact, rel=5.0e-4)
    assert exact > 1.0e3 * sum(CLOSED.widths) * CLOSED.thickness**3 / 3.0


@pytest.mark.slow
def test_the_drilling_tie_does_not_matter_to_boxes() -> None:
    """Reference: non-regression, the default tie.

    Over four decades, 1e-4 to 1, the frequencies of a free box and the compliance where the inner
    segment presses keep within 0.1 %, on two meshes alike.
    """
    outer, inner = (segment.section for segment in flat_boom().segments)
    assert outer is not None
    assert inner is not None
    box = PlainBox(outer, 10.0)
    ties = (1.0e-4, 1.0e-2, 1.0)
    for size in (0.5, 0.25):
        frequencies = np.array([box.free_frequencies(size, 8, tie) for tie in ties])
        assert (np.ptp(frequencies, axis=0) < 1.0e-3 * frequencies[0]).all()
        compliances = [
            box.compliance(size, (0.0, 2.0), 9.0, 0.5 * inner.width, tie) for tie in ties
        ]
        assert np.ptp(compliances) < 1.0e-3 * min(compliances)
        assert compliances[0] > compliances[1] > compliances[2]

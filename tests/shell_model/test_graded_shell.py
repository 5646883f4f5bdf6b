# SPDX-License-Identifier: LGPL-3.0-or-later
"""What a squeezed station gives way on graded meshes."""

from __future__ import annotations

from dataclasses import replace

import pytest
from mpi4py import MPI

from geometry.boom import Boom, PadSize, Support
from shell_model.boom_shell import ShellOptions, assemble_segments
from shell_model.contact.rows import Touching
from shell_model.contact.surface import SurfaceOptions
from tests.shell_model.booms import LAW, flat_boom
from tests.shell_model.conftest import compliance
from tests.touching import touching

pytestmark = pytest.mark.slow


PADS = {"corners": None, "pads": PadSize(0.1, 0.06)}


def _short_boom(pad: PadSize | None) -> Boom:
    """The paper's boom with segments of 2 m."""
    boom = flat_boom()
    outer, inner = boom.segments
    return Boom(
        (
            replace(outer, end=2.0, supports=(Support(0.0), Support(0.5))),
            replace(inner, start=1.0, end=3.0),
        ),
        (replace(boom.joints[0], stations=(1.0, 2.0), pad=pad),),
    )


def _squeezed(boom: Boom, tolerance: float | None) -> float:
    """By how much the first station closes under equal forces from above and below, in m/N."""
    options = ShellOptions(0.1, contact_tolerance=tolerance)
    shells = assemble_segments(boom, options, MPI.COMM_WORLD)
    contacts = (
        Touching.of(touching(boom, LAW), shells, "near webs", SurfaceOptions()).rows({}).contacts
    )
    up, down = (contact.reading for contact in contacts if contact.station == 0)
    return sum(compliance(shell, up[k] - down[k]) for k, shell in enumerate(shells))


@pytest.mark.parametrize("kind", PADS)
def test_a_tolerance_is_kept(kind: str) -> None:
    """Reference: the mesh of a quarter of the tolerance, extrapolated as errors of the square of
    the size (Richardson 1911). A uniform mesh of the same size is far off.
    """
    boom = _short_boom(PADS[kind])
    uniform, coarse, fine = (_squeezed(boom, tolerance) for tolerance in (None, 0.16, 0.04))
    limit = fine + (fine - coarse) / 3.0
    assert fine == pytest.approx(limit, rel=0.04)
    assert coarse == pytest.approx(limit, rel=0.16)
    assert uniform < 0.95 * limit

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Distortion of hexagons and octagons under pads: the estimate of beams, compared with shells."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from mpi4py import MPI

from protractile.beam_model.calibration import residual_compliance
from protractile.beam_model.finite_element import finite_element_segments
from protractile.beam_model.segment_model import gap_system
from protractile.beam_model.statics import static_state
from protractile.beam_model.wall_compliance import contact_compliance
from protractile.dynamics.contact import PowerContact
from protractile.dynamics.equilibrium import equilibrium_at
from protractile.dynamics.excitation import Step
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, Joint, Pad, Segment, Support
from protractile.geometry.load import Load
from protractile.geometry.polygon import PolygonSection
from protractile.geometry.profiles import hexagon, octagon
from protractile.geometry.section import EACH_SIDE
from protractile.runs.report.tables import Table
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.reduced_shell import reduce_boom
from studies.reference_models.plates import STEEL
from studies.study import Criterion, Piece, Progress, Verification, define_study

MESH_SIZE = 0.08
# Permitted relative errors of the compliance of stations and of the tip deflection.
COMPLIANCE, TIP = 0.08, 0.04
# Force across the tip in N, play in m, and stiffness of the pads in N/m.
FORCE, PLAY, PADS = -2.0e4, 0.004, 1.0e8
_PAD, _CORNER = Pad(0.2, 0.07), Pad(0.2, 0.07, bears="corner")


class Case(NamedTuple):
    """Two segments of polygons with an overlap.

    Args:
        outer, inner: the sections.
        pad: pads of the stations; None for contact along the corners.
        overlap, length: overlap and length of each segment in m.
    """

    outer: PolygonSection
    inner: PolygonSection
    pad: Pad | None = _CORNER
    overlap: float = 1.5
    length: float = 8.0

    @property
    def boom(self) -> Boom:
        """The boom, clamped, with stations at both ends of the overlap."""
        start = self.length - self.overlap
        clamp, end = (Support(0.0, "clamped"),), start + self.length
        segments = (
            Segment.of_section("outer", 0.0, self.length, STEEL, self.outer, supports=clamp),
            Segment.of_section("inner", start, end, STEEL, self.inner),
        )
        law = PowerContact(stiffness=PADS, exponent=1.0)
        joint = Joint(0, 1, (start, self.length), PLAY, contact=law, pad=self.pad)
        return Boom(segments, (joint,), (Load(1, "z", FORCE, end, Step()),))


CASES: Mapping[str, Case] = {
    "hexagons, pads on corners": Case(
        hexagon(0.82, 0.58, 0.39, 0.008, 0.011, 0.007),
        hexagon(0.74, 0.50, 0.32, 0.007, 0.009, 0.006),
    ),
    "hexagons of thicker plates, pads on corners": Case(
        hexagon(0.60, 0.60, 0.30, 0.012, 0.012, 0.012),
        hexagon(0.54, 0.52, 0.26, 0.010, 0.010, 0.010),
        overlap=2.0,
    ),
    "hexagons, pads on walls": Case(
        hexagon(0.60, 0.50, 0.38, 0.010, 0.010, 0.008),
        hexagon(0.54, 0.44, 0.33, 0.008, 0.008, 0.006),
        _PAD,
    ),
    "octagons, pads on corners": Case(
        octagon(0.60, 0.60, 0.16, 0.006, 0.006, 0.006),
        octagon(0.54, 0.54, 0.145, 0.005, 0.005, 0.005),
    ),
    "octagons with small chamfers, stations": Case(
        octagon(0.60, 0.45, 0.08, 0.008, 0.008, 0.006),
        octagon(0.54, 0.39, 0.07, 0.007, 0.007, 0.005),
        None,
        overlap=1.0,
    ),
    "octagons, pads on walls": Case(
        octagon(0.60, 0.60, 0.14, 0.010, 0.010, 0.010),
        octagon(0.53, 0.53, 0.12, 0.008, 0.008, 0.008),
        _PAD,
    ),
}  # fmt: skip

NOTE = (
    "Compliance of the stations at tail and head of the overlap under opposite forces that press "
    f"the walls of both segments apart, and tip deflection under {-1e-3 * FORCE:g} kN. Shells have "
    f"edges of {1e3 * MESH_SIZE:g} mm; their compliance is additional to that of Timoshenko "
    "elements."
)


class Found(NamedTuple):
    """Compliances (2,) of tail and head in m/N, and tip deflection in m."""

    stations: Array
    tip: float


def opening(compliance: Array) -> Array:
    """Return half of the opening (num_stations,) under unit forces on both sides."""
    up, down = slice(0, None, 2), slice(1, None, 2)
    return 0.5 * np.diag(
        compliance[up, up] + compliance[down, down] - compliance[up, down] - compliance[down, up]
    )


def of_beam(boom: Boom, walls: float = 1.0) -> Found:
    """Return the estimate of beam elements, whose compliance of contacts has a factor."""
    return Found(walls * opening(contact_compliance(boom)), static_state(boom, walls=walls).tip)


def of_shell(boom: Boom, size: float = MESH_SIZE) -> Found:
    """Return the results of a shell with edges of a size in m."""
    shell = reduce_boom(boom, ShellOptions(size), MPI.COMM_WORLD).system
    elements = finite_element_segments(boom, 0.25, "timoshenko", True)
    residual = residual_compliance(gap_system(boom, elements, EACH_SIDE), shell)
    system, contacts = shell.gather_loads(), slice(len(shell.laws))
    rest = equilibrium_at(system, 0.0)
    tip = float(system.observers["tip"].row @ rest)
    return Found(opening(residual[contacts, contacts]), tip)


@define_study("polygon_distortion", "Distortion of polygons under pads")
def study(progress: Progress) -> Iterator[Piece]:
    """Compare compliances of stations and tips with shells."""
    rows: list[Sequence[str | float]] = []
    for name, case in CASES.items():
        progress(name)
        beam, rigid, shell = of_beam(case.boom), of_beam(case.boom, 0.0), of_shell(case.boom)
        criterion: Criterion = ("other code", "shells", COMPLIANCE)
        for where, own, reference in zip(
            ("tail", "head"), beam.stations, shell.stations, strict=True
        ):
            what = f"{name}: compliance of the {where}"
            yield Verification(what, 1e9 * own, 1e9 * reference, "1e-9 m/N", *criterion)
        criterion = ("other code", "shells", TIP)
        tip, expected = 1e3 * beam.tip, 1e3 * shell.tip
        yield Verification(f"{name}: tip", tip, expected, "mm", *criterion)
        rows.append((name, tip, expected, 1e3 * rigid.tip, 100.0 * (tip / expected - 1.0)))
    columns = {
        "sections": "", "beam\nmm": ".4g", "shell\nmm": ".4g", "beam, rigid\nsections (mm)": ".4g",
        "beam off the\nshell (%)": ".1f",
    }  # fmt: skip
    yield Table.of_rows("polygon_distortion", "Tip of booms of polygons", columns, rows, (NOTE,))

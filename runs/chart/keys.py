# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of a case for its load chart."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from protractile.geometry.fields import In, Name, NotNegative, Positive
from protractile.runs.case.limits import CaseTable
from protractile.runs.case.load_tables import Telescoped

# Most rows and columns of a chart.
_MOST = 100

Angle = Annotated[float, Field(strict=True, ge=0.0, lt=90.0)]


class ChartTable(CaseTable):
    """The load chart of a boom: its rated capacity for each extension and radius."""

    load_case: Name
    """the name of the load case whose payload is searched"""
    radii: Annotated[tuple[Positive, ...], In("m"), Field(max_length=_MOST)] = ()
    """the horizontal distances in m of the loaded tip from the slewing axis of the chassis, or from
    the foot pin without chassis"""
    luffing: Annotated[tuple[Angle, ...], In("deg"), Field(max_length=_MOST)] = ()
    """the luffing angles in degrees, in place of radii"""
    extensions: Annotated[
        tuple[Annotated[dict[str, NotNegative], In("m")], ...], Field(max_length=_MOST)
    ] = ()
    """the configurations: inner segment = extension in m, as in load cases"""
    telescoped: Annotated[tuple[Telescoped, ...], In("1"), Field(max_length=_MOST)] = ()
    """the fractions of the stroke, in place of extensions, as the table telescoping shares them out
    to the joints: 0 retracted, 1 or "100 %" extended"""
    lengths: Annotated[tuple[Positive, ...], In("m"), Field(max_length=_MOST)] = ()
    """the lengths in m from the foot pin to the tip, in place of extensions; joints extend up to
    their extension in the case, as the table telescoping says"""
    combinations: Annotated[tuple[str, ...], Field(min_length=1)] | None = None
    """the names of the combinations whose proofs must hold; all with the load case unless given"""
    angles: Annotated[tuple[Angle, Angle], In("deg")] = (0.0, 80.0)
    """the smallest and the largest luffing angle in degrees"""
    payload: Annotated[Positive, In("kg")] | None = None
    """the rated payload in kg, such as that of a cage; with it the chart has the governing
    utilisation in place of the capacity"""
    largest_payload: Annotated[Positive, In("kg")] = 1.0e5
    """the largest payload in kg that is tried, such as the capacity of the hook"""


class Keys(CaseTable):
    """Keys of a case for its load chart."""

    chart: ChartTable | None = None
    """the table of the load chart"""

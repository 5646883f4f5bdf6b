# SPDX-License-Identifier: LGPL-3.0-or-later
"""Telescoped beams with play in Exudyn: ``python exudyn_beams.py < GIVEN.json``.

The interpreter needs Exudyn, but not this project. For each step, the script prints the motion of
the tip and the wall time in s.
"""

from __future__ import annotations

import json
import sys
from itertools import pairwise
from time import perf_counter
from typing import Any

import exudyn as exu
from exudyn.itemInterface import (
    CoordinateConstraint,
    LoadMassProportional,
    MarkerBodyMass,
    MarkerNodeCoordinate,
    NodeGenericData,
    NodePoint2DSlope1,
    NodePointGround,
    ObjectANCFCable2D,
    ObjectConnectorCoordinateSpringDamperExt,
    SensorNode,
)


def build(given: dict[str, Any]) -> tuple[Any, int]:
    """Return the assembled system of slender beam elements, and the number of its tip sensor."""
    mbs = exu.SystemContainer().AddSystem()
    ground = mbs.AddMarker(
        MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()), coordinate=0)
    )
    across: list[dict[float, int]] = []
    for beam in given["beams"]:
        nodes = [
            mbs.AddNode(NodePoint2DSlope1(referenceCoordinates=[x, 0.0, 1.0, 0.0]))
            for x in beam["nodes"]
        ]
        for (start, end), ends in zip(pairwise(beam["nodes"]), pairwise(nodes), strict=True):
            element = mbs.AddObject(
                ObjectANCFCable2D(
                    length=end - start,
                    massPerLength=beam["mass_per_length"],
                    bendingStiffness=beam["bending_stiffness"],
                    axialStiffness=beam["axial_stiffness"],
                    nodeNumbers=list(ends),
                )
            )
            mass = mbs.AddMarker(MarkerBodyMass(bodyNumber=element))
            push = [0.0, beam["load"] / beam["mass_per_length"], 0.0]
            mbs.AddLoad(LoadMassProportional(markerNumber=mass, loadVector=push))
        across.append(
            {
                x: mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=1))
                for x, node in zip(beam["nodes"], nodes, strict=True)
            }
        )
        along = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=0))
        for held in (along, *(across[-1][x] for x in beam["supports"])):
            mbs.AddObject(CoordinateConstraint(markerNumbers=[ground, held]))
    outer, inner = across
    for station in given["stations"]:
        state = NodeGenericData(initialCoordinates=[1.0, 0.0, 0.0], numberOfDataCoordinates=3)
        mbs.AddObject(
            ObjectConnectorCoordinateSpringDamperExt(
                markerNumbers=[outer[station["x"]], inner[station["x"]]],
                nodeNumber=mbs.AddNode(state),
                useLimitStops=True,
                limitStopsUpper=station["clearance"],
                limitStopsLower=-station["clearance"],
                limitStopsStiffness=station["stiffness"],
            )
        )
    sensor = mbs.AddSensor(
        SensorNode(
            nodeNumber=nodes[-1],
            outputVariableType=exu.OutputVariableType.Displacement,
            storeInternal=True,
            writeToFile=False,
        )
    )
    mbs.Assemble()
    return mbs, sensor


def move(given: dict[str, Any], step: float) -> dict[str, Any]:
    """Return the tip deflection in m at all output times, and the wall time in s, for a step."""
    mbs, sensor = build(given)
    settings = exu.SimulationSettings()
    settings.timeIntegration.endTime = given["duration"]
    settings.timeIntegration.numberOfSteps = round(given["duration"] / step)
    settings.timeIntegration.verboseMode = 0
    # Looser than the default of 1e-8, which round-off of the axial stiffness makes impossible.
    settings.timeIntegration.newton.relativeTolerance = 1.0e-6
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = given["output_step"]
    start = perf_counter()
    mbs.SolveDynamic(settings)
    seconds = perf_counter() - start
    places = mbs.GetSensorStoredData(sensor)[:, 2:3].tolist()
    return {"step": step, "seconds": seconds, "places": places}


if __name__ == "__main__":
    given = json.load(sys.stdin)
    print(json.dumps([move(given, step) for step in given["steps"]]))

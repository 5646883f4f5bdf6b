# SPDX-License-Identifier: LGPL-3.0-or-later
"""A builder of booms: a telescope of two boxes, of which a test gives what it is about."""

from collections.abc import Callable
from typing import Any

import pytest

import protractile as pt
from protractile.analysis.rows import INITIAL, REST, Row, Rows, static_rows
from protractile.analysis.states import States
from protractile.geometry.axial import with_compression
from protractile.runs.case.kinds.model import BeamTable, BuildContext, ModelTable

STEEL = pt.Material(2.1e11, 0.3, 7850.0, yield_strength=355e6)
CLAMP = pt.Support(0.0, "clamped")
# The boxes of both segments.
ARM = pt.BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006)
FLY = pt.BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005)
PAD = pt.Pad(length=0.1, width=0.08, thickness=0.02, modulus=2e9)


def force(segment: str, x: float, size: float, direction: Any = "z", **more: Any) -> pt.Load:
    """Return a force in N at an x in m, constant from t = 0 on unless a history is given."""
    return pt.Load(segment, direction, size, x=x, **{"history": pt.Step(), **more})


def cantilever(*loads: pt.Load, thrust: float = 0.0, **changes: Any) -> pt.Boom:
    """Return an arm of 8 m, clamped at 0, with a thrust in N at its tip; ``changes`` are fields."""
    fields = {"section": ARM, "material": STEEL, "supports": (CLAMP,), "end": 8.0, **changes}
    end, material, section = (fields.pop(name) for name in ("end", "material", "section"))
    segment = pt.Segment.of_section("arm", 0.0, end, material, section, **fields)
    thrusts = [pt.Thrust("arm", x=end, force=thrust)] if thrust else []
    return pt.Boom(with_compression([segment], [], thrusts), [], loads=loads)


def telescope(*loads: pt.Load, **changes: Any) -> pt.Boom:
    """Return a clamped arm on [0, 8] m and a fly on [6, 14] m, with a play of 10 mm and pads.

    ``changes`` are fields of a part, such as ``joint__play`` or ``fly__masses``, and of the boom.
    """
    fields: dict[str, dict[str, Any]] = {"arm": {}, "fly": {}, "joint": {}, "boom": {}}
    for name, value in changes.items():
        part, _, field = name.rpartition("__")
        fields[part or "boom"][field] = value
    of_joint = {"stations": (6.0, 8.0), "play": 0.010, "pad": PAD, **fields["joint"]}
    of_arm = {"supports": (CLAMP,), **fields["arm"]}
    arm = pt.Segment.of_section("arm", 0.0, 8.0, STEEL, of_arm.pop("section", ARM), **of_arm)
    fly = pt.Segment.of_section(
        "fly", 6.0, 14.0, STEEL, fields["fly"].pop("section", FLY), **fields["fly"]
    )
    joint = pt.Joint("arm", "fly", **of_joint)
    return pt.Boom([arm, fly], [joint], loads=loads, **fields["boom"])


# Models of a boom, with elements of a length in m.
MODELS: dict[str, Callable[[pt.Boom, float], BeamTable]] = {
    "elements": lambda boom, length: pt.BeamElements(
        boom, theory="timoshenko", element_length=length
    ),
    "series": lambda boom, _: pt.Kantorovich(
        boom, terms=(7,) * len(boom.segments), base="complete"
    ),
}


def rows_at_rest(model: ModelTable, boom: pt.Boom, frequencies: int = 0) -> Rows:
    """Return the rows of a model at rest, and its lowest frequencies with contacts open."""
    own = model.model_boom(boom)
    context = None
    if model.needs_shell:
        mpi = pytest.importorskip("mpi4py.MPI", reason="shells need FEniCSx")
        context = BuildContext(mpi.COMM_SELF)
    built = model.build(own, context)
    states = States.at_rest(model.analysis_model(own.boom, built), 1.0)
    rows = [row for row in static_rows(states, "model") if row.state in (INITIAL, REST)]
    lowest = built.system.frequencies[built.system.omega2 > 0.0][:frequencies]
    return Rows([*rows, *(Row("model", INITIAL, True, "frequency", "", str(k), value)
                          for k, value in enumerate(sorted(lowest.tolist())))])  # fmt: skip

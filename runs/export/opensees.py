# SPDX-License-Identifier: LGPL-3.0-or-later
"""Export of a boom of beam elements as an independent OpenSeesPy script.

The script has beam elements with nodal loads, and a truss for each cylinder. Contacts are
zero-length elements. Their elastic material follows points of the contact law, in series with the
spring of a calibrated station. Friction under given normal forces is elastic-plastic. The script
leaves out section fields, and coupling between the springs of different stations.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from protractile.beam_model.calibration import Calibration, with_stiffnesses
from protractile.beam_model.component import Component
from protractile.beam_model.finite_element import finite_element_segment
from protractile.dynamics.contact import ContactLaw
from protractile.dynamics.excitation import InitialImpulse, ReleasedLoad
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.contact_places import ContactPair, pads
from protractile.geometry.typography import choices
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.finite_element import BeamElements
from protractile.runs.case.kinds.model import BuildContext, ModelBoom, select_kind
from protractile.runs.case.messages import translated_errors
from protractile.runs.case.schema import Case
from protractile.runs.folder.cache import Cache
from protractile.runs.folder.files import write_atomically
from protractile.runs.pipeline.models import build
from protractile.runs.process.bad_input import BadInput

if TYPE_CHECKING:
    from mpi4py import MPI

TEMPLATE = Path(__file__).parent / "templates" / "opensees_script.py.txt"

# Force in N up to which the script follows a contact law, and number of points of a nonlinear law.
LARGEST, POINTS = 1.0e7, 80
# Force in N at the edge of an open gap; it prevents a singular matrix.
OPEN = 1.0e-5


class Part(NamedTuple):
    """Beam elements of a segment."""

    component: Component  #: planar component of the segment
    free: Array  #: degrees of freedom that are not rigidly supported

    def node(self, x: float) -> int:
        """Return the index of the node nearest to x in m."""
        return int(np.argmin(np.abs(self.component.breaks - x)))

    def nodal(self, row: Array) -> list[list[float]]:
        """Return number, force in N and moment in N·m of each loaded node."""
        whole = np.zeros(2 * self.component.breaks.size)
        whole[self.free] = row
        pairs = whole.reshape(-1, 2)
        return [[int(n), *map(float, pairs[n])] for n in np.flatnonzero(pairs.any(axis=1))]


def script(
    case: Case, model_boom: ModelBoom, model: BeamElements, calibration: Calibration | None
) -> str:
    """Return the OpenSeesPy script of a model.

    The boom is planar, with the contact laws of the model; ``calibration`` is that of the model.

    Raises:
        BoomError: the boom has a feature that the script does not support.
    """
    _check(case, model_boom)
    boom = model_boom.boom
    # Segment and x in m of each contact point.
    touching = [(stop.segment, stop.x) for stop in boom.stops]
    for pad in pads(boom):
        touching += [(pad.joint.inner, pad.midpoint), (pad.joint.outer, pad.midpoint)]
    stiff = boom if calibration is None else with_stiffnesses(boom, calibration.segments)
    parts = [_part(stiff, number, model, touching) for number in range(len(boom.segments))]
    data = {
        "TITLE": f"{case.title}: {model.name}",
        "DURATION": case.time.duration,
        "OUTPUT_STEP": case.time.output_step,
        "SEGMENTS": [_segment(stiff, n, part, model) for n, part in enumerate(parts)],
        "CONTACTS": list(_contacts(model_boom, parts, calibration)),
        "CYLINDERS": [
            {
                "node": [cylinder.segment, parts[cylinder.segment].node(cylinder.x)],
                "lug": [cylinder.x, -cylinder.depth],
                "ground": list(cylinder.ground),
                "stiffness": cylinder.axial_stiffness,
                "length": cylinder.length,
            }
            for cylinder in boom.cylinders
        ],
        # Both nodes and the friction force in N of each pad with friction.
        "FRICTIONS": [
            [*_ends(pad, parts), pad.joint.friction * pad.normal_force]
            for pad in pads(boom)
            if pad.joint.friction > 0.0 and pad.normal_force is not None
        ],
        "LOADS": list(_loads(case, boom, parts)),
    }
    lines = "\n".join(f"{name} = {value!r}" for name, value in data.items())
    return TEMPLATE.read_text(encoding="utf-8").replace("# DATA\n", f"{lines}\n")


def _check(case: Case, model_boom: ModelBoom) -> None:
    """Check that the script supports all features of the case."""
    boom = model_boom.boom
    segments = boom.segments
    for key, present in (
        ("joint.lateral_play", boom.spatial),
        ("cylinder.dashpot", any(cylinder.dashpot > 0.0 for cylinder in boom.cylinders)),
        (
            "segment.supports.depth",
            bool(boom.cylinders) and any(s.depth for segment in segments for s in segment.supports),
        ),
        ("axial", boom.compressed),
        ("hoist", case.hoist is not None),
        ("segment.head_section", any(segment.head_section is not None for segment in segments)),
        ("joint.bonded", any(joint.bonded for joint in boom.joints)),
        ("joint.drive", any(joint.drive is not None for joint in boom.joints)),
        ("joint.dashpot", any(joint.dashpot > 0.0 for joint in boom.joints)),
        (
            "segment.supports",
            any(s.dashpot > 0.0 for segment in segments for s in segment.supports),
        ),
        ("segment.viscous_damping", any(segment.viscous_damping > 0.0 for segment in segments)),
        ("damping", any(case.damping.model_dump().values())),
        ("joint.restitution", any(joint.law("z").damping > 0.0 for joint in boom.joints)),
        ("start", case.start.state != "rest" or bool(case.start.velocity)),
        (
            "load",
            any(isinstance(load.history, ReleasedLoad | InitialImpulse) for load in boom.loads),
        ),
        (
            "joint.friction",
            any(joint.friction > 0.0 and not joint.normal_forces for joint in boom.joints),
        ),
    ):
        if present:
            raise BoomError(
                key,
                "cannot be exported to OpenSees, for which a boom must be flat and undamped, start "
                "from rest, and have friction under given normal_forces only; leave it out",
            )


def _part(
    boom: Boom, number: int, model: BeamElements, touching: Sequence[tuple[int, float]]
) -> Part:
    segment = boom.segments[number]
    sheared = model.theory == "timoshenko" or model.calibrated_by is not None
    component = finite_element_segment(
        segment,
        model.element_length,
        [*boom.stations_of(number), *(x for touched, x in touching if touched == number)],
        "timoshenko" if sheared else "euler-bernoulli",
        model.rotary_inertia,
    ).components["z"]
    nodes = component.breaks
    held = []
    for support in segment.supports:
        node = int(np.argmin(np.abs(nodes - support.x)))
        held += [2 * node] if support.stiffness is None else []
        held += [2 * node + 1] if support.kind == "clamped" else []
    return Part(component, np.setdiff1d(np.arange(2 * nodes.size), held))


def _segment(boom: Boom, number: int, part: Part, model: BeamElements) -> dict[str, object]:
    """Return the data of a segment for the script, in SI units."""
    segment = boom.segments[number]
    material = segment.material
    sheared = model.theory == "timoshenko" or model.calibrated_by is not None
    shear = segment.shear_stiffness if sheared else None
    return {
        "name": segment.name,
        "x": [float(x) for x in part.component.breaks],
        "E": material.youngs_modulus,
        "G": material.shear_modulus,
        "I": segment.second_moment_of_area,
        # None means rigid in shear.
        "shear_area": None if shear is None else shear / material.shear_modulus,
        "mass_per_length": segment.mass_per_length,
        "rotary_inertia": segment.rotary_inertia if model.rotary_inertia else 0.0,
        "supports": [
            {
                "node": part.node(support.x),
                "clamped": support.kind == "clamped",
                "stiffness": support.stiffness,
                "rotation_stiffness": support.rotation_stiffness,
            }
            for support in segment.supports
        ],
        "masses": [[part.node(mass.x), mass.mass] for mass in segment.all_masses],
    }


def _contacts(
    model_boom: ModelBoom, parts: Sequence[Part], calibration: Calibration | None
) -> Iterator[dict[str, object]]:
    """Yield two nodes and the points (m, N) of the contact law for each contact."""
    boom, rows = model_boom.boom, count()

    def points(law: ContactLaw) -> list[list[float]]:
        spring = None if calibration is None else calibration.spring(next(rows))
        return _points(law, 0.0 if spring is None else 1.0 / spring)

    for pad in pads(boom):
        outer, inner = _ends(pad, parts)
        for side in (pad.side,) if pad.side else (1, -1):
            law = pad.station.law.one_sided(side)
            if law is None:
                continue
            law = law.with_weight(pad.weight)
            law = law.with_clearance(-pad.shim) if pad.shim else law
            yield {"outer": outer, "inner": inner, "points": points(law)}
    for stop in boom.stops:
        node = [stop.segment, parts[stop.segment].node(stop.x)]
        for law in filter(None, map(stop.law.one_sided, (1, -1))):
            yield {"outer": None, "inner": node, "points": points(law)}


def _points(law: ContactLaw, compliance: float) -> list[list[float]]:
    """Return approaches in m and forces in N of a one-sided law and a compliance in series."""
    side, onset = law.terms[0].side, min(term.onset for term in law.terms)
    straight = len(law.terms) == 1 and law.terms[0].exponent == 1.0
    deepest = 1.0
    while abs(float(law.force(np.array(side * (onset + deepest))))) > LARGEST:
        deepest *= 0.7
    parts = np.array([1.0]) if straight else (np.arange(1, POINTS + 1) / POINTS) ** 2
    forces = np.abs(law.force(side * (onset + deepest * parts)))
    approaches = onset + deepest * parts + forces * compliance
    along = np.concatenate([[onset - 1.0, onset], approaches])
    contact_forces = np.concatenate([[-OPEN, 0.0], forces])
    order = 1 if side > 0.0 else -1
    return [(side * along)[::order].tolist(), (side * contact_forces)[::order].tolist()]


def _loads(case: Case, boom: Boom, parts: Sequence[Part]) -> Iterator[dict[str, object]]:
    """Yield the nodal loads, with their factors at all output times."""
    for number, part in enumerate(parts):
        nodal_loads = part.nodal(part.component.load)
        if nodal_loads:
            yield {"segment": number, "nodes": nodal_loads, "values": None}
    num_times = round(case.time.duration / case.time.output_step) + 2
    times = case.time.output_step * np.arange(num_times)
    for load in boom.loads:
        part = parts[load.segment]
        values = np.asarray(load.history(times), dtype=float)
        constant = bool(np.ptp(values) == 0.0)
        nodes = part.nodal((values[0] if constant else 1.0) * load.push(part.component.beam))
        yield {
            "segment": load.segment,
            "nodes": nodes,
            "values": None if constant else values.tolist(),
        }


def _ends(pad: ContactPair, parts: Sequence[Part]) -> list[list[int]]:
    """Return segment and node of both segments at a pad, the outer segment first."""
    return [
        [number, parts[number].node(pad.midpoint)] for number in (pad.joint.outer, pad.joint.inner)
    ]


def select_model(case: Case, file: str, name: str | None = None) -> BeamElements:
    """Return the model with a name, by default the last beam-element model with play.

    The name ``file`` of the case is for messages.

    Raises:
        BadInput: the model does not exist.
    """
    of = {m.name: m for m in select_kind(BeamElements, case.models) if not m.bonded}
    if not of:
        raise BadInput(file, "--model", "must be beam elements with play, and there are none")
    if name is not None and name not in of:
        names = choices(list(of))
        raise BadInput(file, "--model", f"{name!r} is no beam elements with play; give {names}")
    return of[name or [*of][-1]]


def write(
    case: Case, file: str, comm: MPI.Intracomm | None, path: Path, cache: Cache | None
) -> None:
    """Write the script of the model of :func:`select_model`.

    The name ``file`` of the case is for messages, and ``cache`` has reduced shells. A model that a
    shell calibrates needs a communicator.

    Raises:
        BadInput: the model does not exist, or has a feature that the script does not support.
    """
    # Beam elements of OpenSees have no section fields.
    model = select_model(case, file).model_copy(update={"section_fields": False})
    boom = build_boom(case)
    calibration = None
    if model.needs_shell:
        assert comm is not None
        calibration = build(case, boom, model, BuildContext(comm, cache=cache)).calibration
    with translated_errors(file):
        text = script(case, model.model_boom(boom), model, calibration)
    write_atomically(path, text)

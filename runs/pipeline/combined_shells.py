# SPDX-License-Identifier: LGPL-3.0-or-later
"""Static states of all combinations of a case by a shell.

Combinations with the same geometry share one reduced shell. The reduction includes the unit loads
of all of these combinations and the largest axial forces. For a combination with other axial forces
the geometric stiffness is corrected, from the deflections of the axes of the segments. The part of
walls is not, so that buckling factors of the boom are on the safe side.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from protractile.analysis.measure import measure_walls
from protractile.analysis.model import AnalysisModel
from protractile.analysis.plate_buckling import measure_plates
from protractile.analysis.states import States
from protractile.analysis.wall_buckling import buckle_shell
from protractile.dynamics.excitation import InitialImpulse, PiecewiseLinear, ReleasedLoad, Step
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.geometry.arrays import Array
from protractile.geometry.axial import AxialChange
from protractile.geometry.boom import Boom
from protractile.geometry.load import Load
from protractile.runs.case.build import build_boom
from protractile.runs.case.combinations import CombinedCase, combined_cases
from protractile.runs.case.kinds.model import BuildContext, BuiltModel, ModelBoom
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.combinations import CombinationState
from protractile.runs.pipeline.model_output import force_places

# History of a released load in static states: 1 at t = 0, then 0.
_RELEASE = PiecewiseLinear((0.0, 1.0e-6), (1.0, 0.0))


def shell_states(case: Case, model: Shell, context: BuildContext) -> list[CombinationState]:
    """Return the static states of all combinations by a shell, on rank 0. Collective.

    With the table ``buckling``, buckling factors are computed in one state of each geometry: the
    state for which panel formulas give the lowest buckling factor.
    """
    combined = list(combined_cases(case))
    booms = [
        model.model_boom(build_boom(combination.case)).boom.without_drives
        for combination in combined
    ]
    groups: dict[str, list[int]] = {}
    for number, boom in enumerate(booms):
        places = [segment.ends for segment in boom.segments]
        groups.setdefault(repr((places, boom.cylinders)), []).append(number)
    states_by_number: dict[int, CombinationState] = {}
    for numbers in groups.values():
        shared = _shared([booms[number] for number in numbers])
        built = model.build(ModelBoom(shared[0]), context)
        states = [
            _state(combined[number], boom, shared[0], model, built)
            for number, boom in zip(numbers, shared[1:], strict=True)
            if context.comm.rank == 0
        ]
        if case.buckling is not None:
            states = _with_buckling(case, shared, states, model, built, context)
        states_by_number |= dict(zip(numbers, states, strict=False))
    return [states_by_number[number] for number in sorted(states_by_number)]


def _shared(booms: Sequence[Boom]) -> list[Boom]:
    """Return one boom with a unit load for each load of any boom, then all booms in order.

    The returned booms have the same list of loads; a load that a boom lacks has magnitude 0 there.
    The given booms differ only in loads and axial forces.
    """
    from protractile.shell_model.standard import standard_boom

    of_booms = [_by_kind(boom) for boom in booms]
    kinds = {kind: load for loads in of_booms for kind, load in loads.items()}
    zero = {kind: replace(load, magnitude=0.0, history=Step()) for kind, load in kinds.items()}
    unit = [replace(load, magnitude=1.0) for load in zero.values()]

    def largest_compression(boom: Boom) -> float:
        ends = [
            force
            for segment in boom.segments
            for piece in segment.compression.ends
            for force in piece
        ]
        return max(ends, default=0.0)

    most = max(booms, key=largest_compression)
    # A segment may have a load in only one of the booms.
    of_segments = (boom.segments for boom in booms)
    heaviest = [
        max(parts, key=lambda part: abs(part.load)) for parts in zip(*of_segments, strict=True)
    ]
    segments = [
        replace(segment, load=loaded.load, lateral=loaded.lateral)
        for segment, loaded in zip(most.segments, heaviest, strict=True)
    ]
    whole = standard_boom(replace(most, segments=tuple(segments), loads=tuple(unit)))
    return [
        whole,
        *(
            replace(boom, loads=tuple((zero | loads).values()))
            for boom, loads in zip(booms, of_booms, strict=True)
        ),
    ]


def _by_kind(boom: Boom) -> dict[str, Load]:
    """Return the loads of a boom at rest; a key is a place, a direction and a running number."""
    loads_by_key: dict[str, Load] = {}
    numbers: Counter[str] = Counter()
    for load in boom.loads:
        if isinstance(load.history, InitialImpulse):
            continue
        if isinstance(load.history, ReleasedLoad):
            load = replace(load, history=_RELEASE)
        kind = repr(replace(load, magnitude=1.0, history=Step()))
        loads_by_key[f"{kind}#{numbers[kind]}"] = load
        numbers[kind] += 1
    return loads_by_key


def _state(
    combined: CombinedCase, boom: Boom, shared: Boom, model: Shell, built: BuiltModel
) -> CombinationState:
    """Return the static states and wall stresses of a combination, on rank 0.

    ``shared`` is the boom of the reduced shell, with the largest axial forces.
    """
    from protractile.shell_model.standard import with_plays_and_loads
    from protractile.shell_model.stress.history import stress_near_places
    from protractile.shell_model.stress.stresses import ShellStress

    assert built.shell is not None
    shell = with_plays_and_loads(built.shell, boom)
    lines = model.lines(boom, replace(built, shell=shell))
    deflections = [dict(line.deflections) for line in lines]
    forces, largest = (
        AxialChange(
            Step(), [segment.compression for segment in each.segments], leads=each.leads
        ).geometric_stiffness(deflections)
        for each in (boom, shared)
    )
    system = replace(shell.system.gather_loads(), geometric_stiffness=forces - largest)
    factor = None
    try:
        with np.errstate(all="ignore"):
            loaded = AnalysisModel.of(boom, system, lines)
            states = States.at_rest(loaded, combined.case.time.duration)
            if boom.compressed:
                loads = map(system.load_at, states.time.tolist())
                factor = min(shell.critical_factor_at(system, load) for load in loads)
    except NUMERICAL_ERRORS:
        return CombinationState(combined, None, model.name)
    assert shell.fields is not None
    fields = shell.fields.assign(
        state=(("time", "mode"), states.positions.astype(np.float32)),
        time=("time", states.time),
    )
    names = [segment.name for segment in boom.segments]
    stresses = stress_near_places(ShellStress.from_fields(fields), force_places(boom), names)
    walls = [*measure_walls(boom, stresses)]
    return CombinationState(combined, states, model.name, walls, critical_factor=factor)


def _with_buckling(
    case: Case,
    shared: Sequence[Boom],
    states: Sequence[CombinationState],
    model: Shell,
    built: BuiltModel,
    context: BuildContext,
) -> list[CombinationState]:
    """Return the states, with buckling results of the governing one. Collective.

    The governing state has the lowest buckling factor by panel formulas.
    """
    from protractile.shell_model.buckling import ShellState
    from protractile.shell_model.standard import with_plays_and_loads

    assert case.buckling is not None
    assert built.shell is not None
    states, state, governing = list(states), None, 0
    if context.comm.rank == 0 and built.shell.fields is not None:
        factors = [
            (float(factor), number, state.states.positions[step])
            for number, state in enumerate(states)
            if state.states is not None
            for step, factor in enumerate(_lowest_factors(state.states))
        ]
        if factors:
            _, governing, position = min(factors, key=lambda entry: entry[0])
            shell = with_plays_and_loads(built.shell, shared[1 + governing])
            extensions = dict.fromkeys(range(len(shared[0].joints)), 0.0)
            state = ShellState.from_fields(built.shell.fields, shell.system, position, extensions)
    count, meshes = case.buckling.modes, built.shell.meshes
    buckled = buckle_shell(shared[0], meshes, state, model.options(), count, context.comm)
    if buckled:
        states[governing] = replace(states[governing], buckling=buckled)
    return states


def _lowest_factors(states: States) -> Array:
    """Return the lowest buckling factor (num_states,) by panel formulas; infinite without one."""
    none = np.full(states.time.size, np.inf)
    lowest = [none, *(plate.values.min(axis=1) for plate in measure_plates(states))]
    return np.asarray(np.min(lowest, axis=0))

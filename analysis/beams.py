# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results of a boom at rest by beam elements with elastic plates under pads."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import partial

from protractile.analysis.curves import diagrams
from protractile.analysis.equilibria import vibrating_system
from protractile.analysis.evaluation import Findings
from protractile.analysis.measure import measure
from protractile.analysis.model import AnalysisModel
from protractile.analysis.modes import mode_curves, mode_rows
from protractile.analysis.modes import modes as modes_about
from protractile.analysis.proofs import BY_BEAMS, ReductionCurve, Resistance, governing, proofs
from protractile.analysis.rows import BEAM, COMBINATION, REST, Row, Rows, extremes, static_rows
from protractile.analysis.states import States
from protractile.beam_model.boom_modes import BoomModes
from protractile.beam_model.lines import lines_of_modes
from protractile.beam_model.static_model import StaticModel, estimate_critical_factor
from protractile.beam_model.statics import (
    Completion,
    Elements,
    loaded_system,
)
from protractile.dynamics.failure import NumericsError
from protractile.geometry.boom import Boom
from protractile.geometry.fields import BoomError, format_value, is_positive
from protractile.geometry.load import Load
from protractile.geometry.typography import choices

# Elements of the longest segment. The error of stresses under a uniform load is below 0.1 %.
_ELEMENTS = 20


# Resistances without factors.
_UNREDUCED = Resistance()


def beam_of(boom: Boom, complete: Completion | None = None) -> AnalysisModel:
    """Return beam elements of a boom at its initial extension, under all constant loads.

    The theory is Timoshenko's if all segments have sections. ``complete`` adds what the boom lacks,
    such as a load on a rope.
    """
    boom = boom.without_drives
    modes = BoomModes(boom, Elements(boom, _ELEMENTS).segments)
    system = loaded_system(boom, modes, complete=complete)
    # The coordinates of wall springs come after the coordinates of the segments.
    along = [line.extend(system.num_modes) for line in lines_of_modes(boom, modes)]
    return AnalysisModel.of(boom, system, along)


def static_beam(boom: Boom, complete: Completion | None = None) -> AnalysisModel:
    """Return the model of :func:`beam_of` for static states only, whose masses do not act.

    Booms of one shape share its elements, so that a state takes milliseconds.
    """
    boom = boom.without_drives
    return AnalysisModel.of(boom, *StaticModel.of(boom).loaded(boom, complete))


def statics(boom: Boom, duration: float = 10.0) -> Findings:
    """Return deflections, forces, stresses and pads at rest at t = 0 and under extreme loads.

    >>> rows, curves = pt.statics(boom)
    >>> tip = rows.where(quantity="tip", state="rest").largest
    >>> f"{1e3 * tip.value:.1f} mm"
    '-76.6 mm'

    Args:
        boom: boom with its loads.
        duration: duration in s of the histories of the loads.

    Raises:
        NumericsError: there is no equilibrium at t = 0.
    """
    states = States.at_rest(static_beam(boom), duration)
    return Findings.of(static_rows(states, BEAM), diagrams(states, BEAM, REST))


def modes(boom: Boom) -> Findings:
    """Return natural frequencies and mode shapes with the contacts that are closed at t = 0.

    >>> [f"{row.value:.2f} Hz" for row in pt.modes(boom).rows[:2]]
    ['2.71 Hz', '13.26 Hz']

    Raises:
        NumericsError: there is no equilibrium at t = 0.
    """
    model = beam_of(boom)
    found = vibrating_system(model.system, 1.0)
    if found is None:
        raise NumericsError("the boom has no static equilibrium under the loads at t = 0")
    system, rest = found
    first = modes_about(AnalysisModel(model.boom, system, model.lines), rest)
    return Findings.of(mode_rows(first, BEAM), mode_curves(model.boom, first, BEAM))


def prove(
    boom: Boom,
    combinations: Mapping[str, Sequence[Load]],
    *,
    requested: Collection[str] = BY_BEAMS,
    resistance: Resistance = _UNREDUCED,
    curve: ReductionCurve = (),
    permitted_tip: float | None = None,
    duration: float = 10.0,
) -> Rows:
    """Return the governing proof of each part of a boom under combinations of loads.

    >>> (arm, fly), (joint,) = boom.segments, boom.joints
    >>> weight = pt.Load("fly", "z", -2000.0, x=fly.end, history=pt.Step())
    >>> pt.prove(boom, {"work": [weight]}, permitted_tip=0.3)[0].quantity
    'deflection'

    Args:
        boom: boom with the loads that all combinations have.
        combinations: further loads by the name of the combination.
        requested: kinds of proofs.
        resistance: factors on resistances.
        curve: reduction factors of plates; those of EN 1993-1-5 unless given.
        permitted_tip: permitted tip deflection in m; without it the deflection is not proved.
        duration: duration in s of the histories of the loads.

    Raises:
        BoomError: a kind of proof is unknown, a limit or a factor is not above 0, or a load is not
            one of the boom.
        NumericsError: a combination has no equilibrium at t = 0.
    """
    _check_request(requested, resistance, permitted_tip)
    proved = list[Row]()
    for name, loads in combinations.items():
        loaded = replace(boom, loads=(*boom.loads, *loads))
        try:
            states = States.at_rest(static_beam(loaded), duration)
        except NumericsError as error:
            raise NumericsError(f"{name}: {error}") from error
        names = BEAM, COMBINATION + name
        rows = partial(Rows, [*extremes(measure(states), *names)])
        factor = estimate_critical_factor(loaded) if loaded.compressed else None
        found = proofs(states, rows, requested, resistance, curve, permitted_tip, factor)
        proved += [row._replace(model=names[0], state=names[1]) for row in found]
    return governing(proved)


def _check_request(
    requested: Collection[str], resistance: Resistance, permitted_tip: float | None
) -> None:
    for kind in requested:
        if kind not in BY_BEAMS:
            what = f"{kind!r} is no kind of proof by beams; give {choices(BY_BEAMS)}"
            raise BoomError("requested", what)
    numbers = {f"resistance.{name}": factor for name, factor in resistance._asdict().items()}
    for name, value in (numbers | {"permitted_tip": permitted_tip}).items():
        if value is not None and not is_positive(value):
            raise BoomError(name, f"must be a number above 0, got {format_value(value)}")

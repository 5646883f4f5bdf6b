# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results of a beam for the live page: static results, then the motion, and a figure of the boom.

If the cache has a shell of the same geometry, the beam is calibrated by it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import xarray as xr

from protractile.analysis.curves import Curves, diagrams
from protractile.analysis.equilibria import extended_equilibria
from protractile.analysis.evaluation import evaluate_motion, evaluate_rest
from protractile.analysis.rows import REST, Rows
from protractile.analysis.states import States
from protractile.dynamics.integrator import FixedStep
from protractile.geometry.boom import Boom
from protractile.geometry.typography import TO_MILLI, number
from protractile.runs.case.build import build_boom
from protractile.runs.case.kinds.calibration import OF_MOTION, CalibratedTable
from protractile.runs.case.kinds.model import BuiltModel
from protractile.runs.case.kinds.shell import Shell
from protractile.runs.case.reading import CheckedCase
from protractile.runs.case.schema import Case
from protractile.runs.cautions.context import Context
from protractile.runs.cautions.rules import OF_INPUTS, cautions
from protractile.runs.folder.cache import Cache, key
from protractile.runs.live.controls import Draft
from protractile.runs.pipeline.design_results import DesignResults, ModelDesignResults
from protractile.runs.pipeline.estimates import Cost, motion_cost
from protractile.runs.pipeline.evaluation import life_of
from protractile.runs.pipeline.model_run import summarise_motion
from protractile.runs.pipeline.models import MotionPlan, build_on, complete_system
from protractile.runs.pipeline.results import Results, label
from protractile.runs.pipeline.summary import Summary
from protractile.runs.process.bad_input import BadInput
from protractile.runs.report import theme
from protractile.runs.report.charts import Chart, Curve
from protractile.runs.report.marks import SYMBOL, elevation
from protractile.runs.report.rest_figures import chart_along, rest_curves
from protractile.runs.report.scene import Scene
from protractile.runs.report.summary_table import summary_table, utilisation_verdict

if TYPE_CHECKING:
    from protractile.beam_model.calibration import Calibration


# Heights in pixels: of a panel of a chart, and of the axis below the panels.
_PANEL, _BELOW = 150, 60

# Memory in bytes and time in s of the longest motion, which a designer waits for.
MAX_MEMORY, MAX_TIME = 1.0e9, 120.0

# Tables that change masses, loads and axial forces, and no stiffness of the unloaded shell.
_LOADS = ("payload", "gravity", "loads", "axial", "base", "hoist", "slew", "luff")

# The last calibration, by the cache key of its shell.
_LAST: dict[str, Calibration] = {}

# Smallest deflection of the tip in the figure, as a fraction of the length of the boom.
_SHOWN = 0.03


def beam_results(
    checked: CheckedCase, draft: Draft, check_current: Callable[[], None]
) -> Iterator[Any]:
    """Yield the results of the only model of a case as JSON values.

    The static results come first, then a preview of the motion, then the motion with error control.

    Shells of the draft may calibrate the beam. ``check_current`` raises an error to end an outdated
    computation.

    Raises:
        BadInput: the motion exceeds :data:`MAX_MEMORY` or :data:`MAX_TIME`.
        NumericsError: the beam has no equilibrium, or its motion cannot be computed.
    """
    case, built, stiffness = build_beam(checked, draft.case, draft.shells)
    boom, (model,) = checked.boom, case.models
    loaded = model.analysis_model(boom, built)
    check_current()
    rests = States.at_rest(loaded, case.time.duration)
    check_current()
    plan = MotionPlan.of(built.system, case, model)
    _check_cost(motion_cost(checked, model, plan.motion, built.system.num_modes), case, draft.file)
    extended = States.of(loaded, extended_equilibria(loaded.system, case.time.duration))
    at_rest = evaluate_rest(model.name, rests, extended, case.buckling is not None)
    static, curves, first = Rows(at_rest[0]), Curves(at_rest[1]), at_rest[2]
    none = xr.Dataset(coords={"model": [model.name]})
    results = _results(case, none, static, curves)
    table, farthest = summary_table(results), (rests + extended).farthest
    assert table is not None
    shown = Curves(diagrams(farthest, model.name, REST))
    hertz = ", ".join(number(mode.frequency) for mode in first[1:3])
    more = [("Second and third natural frequency, Hz", hertz), ("Stiffness of the beam", stiffness)]
    utilisation = utilisation_verdict(results, model.name)
    yield {
        "stage": "rest",
        "rows": [*table.rows, *more],
        "utilisation": utilisation and f"At rest: {utilisation}",
        "cautions": cautions(Context(case, boom), OF_INPUTS),
        "boom": boom_figure(case, boom, shown, float(farthest.observed("tip")[0])),
        "forces": _plotly_figure(chart_along(rest_curves(shown, "", theme.PALETTE[0]))),
    }
    check_current()
    # A constant step gives a preview long before the motion with error control.
    for stage, integrator in (
        ("preview", FixedStep(case.time.output_step)),
        ("motion", plan.integrator),
    ):
        trajectory = replace(plan, integrator=integrator).trajectory(lambda _: check_current())
        check_current()
        rows, _ = evaluate_motion(
            States.in_motion(loaded, trajectory), model.name, life_of(case, boom)
        )
        data = label(boom, {model.name: trajectory})
        results = _results(case, data, Rows([*static, *rows]), curves)
        tip = float(rests.observed("tip")[0])
        summary = summarise_motion(model, plan.motion.system, trajectory, built.num_dofs, tip)
        results.summary.models = {model.name: summary}
        whole = summary_table(results)
        assert whole is not None
        limits = [
            (f"Limit: {check.limit}", f"{check.limit.format(value)} {'✓' if check.holds else '✗'}")
            for check in results.check_limits()
            for value in check.values.values()
        ]
        tips = [
            Curve(name.replace("_", " "), TO_MILLI * trajectory.data[name].values, theme.PALETTE[k])
            for k, name in enumerate(("tip", "tip_lateral"))
            if name in trajectory.data
        ]
        tip_chart = Chart(trajectory.time, tips, ["tip deflection (mm)"])
        yield {
            "stage": stage,
            "rows": [*(row for row in whole.rows if row not in table.rows), *limits],
            "notes": whole.notes,
            "utilisation": utilisation_verdict(results),
            "cautions": cautions(Context.of_run(results)),
            "tip": _plotly_figure(tip_chart),
        }


def _check_cost(cost: Cost, case: Case, file: str) -> None:
    """Check that the motion of a case is short enough for the page."""
    if cost.memory > MAX_MEMORY or cost.seconds > MAX_TIME:
        raise BadInput(
            file,
            "time.duration",
            f"{number(case.time.duration)} s are too long for this page, since the motion may take "
            f"{cost}; make it shorter or time.output_step longer, or use `protractile run`",
        )


def _results(case: Case, data: xr.Dataset, rows: Rows, curves: Curves) -> Results:
    """Return the results of a run with one model."""
    design = DesignResults({case.models[0].name: ModelDesignResults()})
    summary = Summary(
        title=case.title, case_hash="", versions={}, models={}, failures={}, design=design
    )
    return Results(case, data, summary, rows=rows, curves=curves)


def _plotly_figure(chart: Chart) -> Any:
    """Return a chart as JSON values for plotly, without a legend if it has only one curve."""
    figure = chart.plain
    names = {trace["name"] for trace in figure["data"]}
    for trace in figure["data"]:
        trace.setdefault("x", chart.time)
        trace["showlegend"] = trace["showlegend"] and len(names) > 1
    height = _BELOW + _PANEL * len(chart.panels)
    figure["layout"] |= {"height": height, "margin": {"l": 62, "r": 12, "t": 26, "b": 50}}
    return figure


def build_beam(
    checked: CheckedCase, original: Case, shells: Sequence[Shell]
) -> tuple[Case, BuiltModel, str]:
    """Return the case, its built beam, and a text that says how its stiffness is determined.

    If the cache has one of the shells with the geometry of the case or of the ``original``, the
    case of the file, the beam is calibrated by it.
    """
    case, boom, (model,) = checked.case, checked.boom, checked.case.models
    with_loads = case.model_copy(update={name: getattr(original, name) for name in _LOADS})
    plates = all(segment.section is not None for segment in boom.segments)
    for shell in shells if plates and not boom.telescopes else ():
        unused: dict[str, object] = dict.fromkeys(OF_MOTION)
        by_shell = shell.model_copy(update=unused)
        beam = model.model_copy(update={"calibrated_by": by_shell, "contact": shell.contact})
        assert isinstance(beam, CalibratedTable)
        if by_shell.contact_line != "near webs":
            continue
        with suppress(ImportError):
            for geometry in (boom, build_boom(with_loads)):
                if calibration := _calibration(beam, by_shell, beam.model_boom(geometry).boom):
                    built = beam.build_calibrated(beam.model_boom(boom), calibration)
                    system = complete_system(built.system, case, boom, built.lines)
                    calibrated = case.model_copy(update={"models": (beam,)})
                    return calibrated, replace(built, system=system), f"calibrated by {shell.name}"
    plain = build_on(checked.model_boom(model), case, model)
    return case, plain, "of its sections;\nrun the shell to calibrate it"


def _calibration(beam: CalibratedTable, shell: Shell, boom: Boom) -> Calibration | None:
    """Return the calibration of a beam by a shell; None if the shell is not in the cache."""
    from protractile.beam_model.calibration import calibrate
    from protractile.shell_model.reduced_shell import ReducedShell
    from protractile.shell_model.standard import with_plays_and_loads

    name, cache = key([*shell.content(boom)]), Cache.of_user()
    if name not in _LAST and cache is not None and (cached := cache.load(name, ReducedShell)):
        loaded_shell = with_plays_and_loads(cached, boom)
        _LAST.clear()
        _LAST[name] = calibrate(
            boom, loaded_shell.system, loaded_shell.probe_responses, beam.segments
        )
    return _LAST.get(name)


def boom_figure(case: Case, boom: Boom, shown: Curves, tip: float) -> dict[str, Any]:
    """Return the figure of the deflected boom at its luffing angle.

    ``shown`` has the curves of all segments in a static state, ``tip`` is its deflection in m.
    """
    visible = _SHOWN * boom.length / max(abs(tip), 1e-12)
    factor = max(1.0, float(f"{min(visible, 1e6):.1g}"))
    scene = Scene.at_rest(case, boom, shown)
    places = scene.points + factor * scene.displacement(0.0) * [0.0, 0.0, 1.0]
    angle = 0.0 if case.gravity is None else case.gravity.angle
    figure = elevation(scene, places, factor, angle, SYMBOL).plain
    for trace in figure["data"]:
        trace |= {"text": trace["name"], "hoverinfo": "text", "hovertemplate": None}
    title = "to scale" if factor == 1.0 else f"to scale, deflection × {factor:g}"
    figure["layout"] |= {
        "title": {"text": f"At rest under the maximum load, {title}", "font": {"size": 14}},
        "hovermode": "closest",
        "showlegend": False,
        "margin": {"l": 50, "r": 12, "t": 36, "b": 30},
        "height": 380,
    }
    for axis in ("xaxis", "yaxis"):
        figure["layout"][axis] |= {"showgrid": False, "zeroline": False, "ticksuffix": " m"}
    return figure

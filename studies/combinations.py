# SPDX-License-Identifier: LGPL-3.0-or-later
"""Study of combinations and proofs, compared with calculations by hand."""

from __future__ import annotations

from collections.abc import Iterator
from math import hypot, inf, sqrt

from geometry.boom import Boom
from runs import CASES
from runs.case import reading as case_file
from runs.case.build import build_boom
from runs.case.load_tables import SpectrumTable
from runs.case.schema import Case
from runs.pipeline.combinations import combination_states
from runs.pipeline.fatigue import detail_damages
from runs.pipeline.proofs import winter
from studies.study import Criterion, Progress, Verification, define_study

GRAVITY = 9.80665
# Masses in kg, the hand force in N, and the factors of the combination "work" of the lift.
CAGE, PEOPLE, HANDS, DEAD, PAYLOAD = 150.0, 230.0, 400.0, 1.1, 1.1
# Repetitions of a load.
REPEATS = 1_000_000

MOMENTS: Criterion = ("analytic", "moments about the pin, ground at 45°", 1.0e-3)
WINTER: Criterion = ("external", "Winter 1947, EN 1993-1-5, (4.2)", 1.0e-9)
MINER: Criterion = ("external", "EN 1993-1-9, 7.1, by hand", 0.01)


@define_study("combinations", "Combinations and proofs")
def study(progress: Progress) -> Iterator[Verification]:
    """Compare combinations, fatigue damage and Winter's curve with calculations by hand."""
    progress("the lift")
    case = case_file.load(str(CASES / "lift.toml"))
    states = {one.combined.name: one for one in combination_states(case)}
    level = states["work, level"].beam
    assert level is not None
    force = level.rests[0].cylinders["cylinder_force"]
    what = "cylinder force of the lift, level, with factors"
    yield Verification(what, 1e-3 * force, 1e-3 * _cylinder_force(level.boom), "kN", *MOMENTS)
    progress("fatigue")
    yield from _damage(case)
    progress("Winter's curve")
    for slenderness, ratio, reduction in ((1.0, 1.0, 0.78), (2.0, 1.0, 0.445), (2.0, -1.0, 0.4725)):
        what = f"reduction of a wall, slenderness {slenderness:g}, stress ratio {ratio:g}"
        yield Verification(what, float(winter(slenderness, ratio)), reduction, "", *WINTER)


def _cylinder_force(boom: Boom) -> float:
    """Return the cylinder force in N of the lift with a level boom, by moment equilibrium."""
    moment = boom.tip * (GRAVITY * (DEAD * CAGE + PAYLOAD * PEOPLE) + HANDS)
    for segment in boom.segments:
        weight = GRAVITY * segment.mass_per_length * segment.length
        moment += DEAD * weight * 0.5 * (segment.start + segment.end)
    # The ground of the case at 45 degrees, in level axes; the lug is 0.25 m below the axis.
    x, z = (0.7 + 1.1) / sqrt(2.0), (0.7 - 1.1) / sqrt(2.0)
    along, up = 2.4 - x, -0.25 - z
    return moment * hypot(along, up) / (2.4 * up + 0.25 * along)


def _damage(case: Case) -> Iterator[Verification]:
    """Yield the fatigue damage at the fly's station, as people enter the level lift repeatedly."""
    level = next(one for one in case.load_cases if one.name == "level")
    empty = level.model_copy(update={"name": "empty", "payload": 0.0, "loads": ()})
    cycle = {"name": "people", "load_cases": ("empty", "level"), "repeats": REPEATS}
    loaded = case.model_copy(
        update={
            "load_cases": (empty, level),
            "spectra": (SpectrumTable.model_validate(cycle),),
        }
    )
    found = {detail.name: (detail, damage) for detail, damage in detail_damages(loaded)}
    detail, damage = found["station, fly"]
    fly = build_boom(case).segments[-1]
    moment = (GRAVITY * PEOPLE + HANDS) * (fly.end - detail.x)
    size = 1e-6 * moment * 0.5 * (0.218 + 0.004) / fly.second_moment_of_area
    # The limits at 5e6 and 1e8 cycles are 0.737 and 0.405 times the category.
    slope = 3.0 if size >= 0.737 * detail.category else 5.0
    cycles = 5e6 * (0.737 * detail.category / size) ** slope
    cycles = cycles if size >= 0.405 * detail.category else inf
    what = "fatigue damage of the lift, station of the fly"
    yield Verification(what, damage.sum, REPEATS / cycles, "", *MINER)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""The compiled loops over time, for which most tests of motions would wait each by itself."""

from __future__ import annotations

from pathlib import Path

from runs import CASES
from runs.case import reading
from runs.case.build import build_boom
from runs.pipeline.models import build
from runs.pipeline.motion import Plan
from studies.then.modal_integrators import NEWMARK
from studies.then.scheme_errors import own_root
from tests import rubbing


def compile_loops(rubbed: Path) -> None:
    """A motion that rubs, told to a file, one by the numerics of 1997, and one output each of few
    modes that jump and of what is drawn out.
    """
    rubbing.compile_loop(rubbed)
    own_root(NEWMARK, 0.1)
    for name in ("coarse", "drawn-out"):
        case = reading.load(str(CASES / f"{name}.toml"))
        model = case.models[0]
        Plan.of(build(case, build_boom(case), model).system, case, model).warm()

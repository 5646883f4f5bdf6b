# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is known of a case when it is checked, and after its run."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, Self

from protractile.analysis.plate_buckling import PanelBuckling
from protractile.analysis.states import StaticResult
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.geometry.boom import Boom
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.drives import StickSlipEstimate, stick_slip_estimates
from protractile.runs.pipeline.largest_loads import BeamStates, StaticExtreme
from protractile.runs.pipeline.pad_walls import wall_part
from protractile.runs.pipeline.statics import boom_with_play

if TYPE_CHECKING:
    import xarray as xr

    from protractile.runs.pipeline.summary import ModelSummary, Summary


class State(NamedTuple):
    """Results at rest of a model, or of the beam that estimates it."""

    where: str  #: source of the results, for example ``in MODEL``
    #: buckling factor of the axial forces; None without them, or if it is not computed
    critical_factor: float | None = None
    tip: float | None = None  #: static tip deflection in m
    frequencies: Sequence[float] = ()  #: natural frequencies in Hz, with closed contacts
    rest: StaticResult | None = None  #: the state at t = 0


@dataclass
class Context:
    """A case with its known results; a rule whose results are unknown yields nothing."""

    case: Case
    boom: Boom
    states: Sequence[State] = ()
    #: extremes of the beam of ``check``, empty without an equilibrium; None after a run
    extremes: Sequence[StaticExtreme] | None = None
    panels: Sequence[PanelBuckling] = ()  #: weakest walls of this beam
    #: trajectories of a run, with the dimensions ``model`` and ``time``
    data: Mapping[Hashable, xr.DataArray] = field(default_factory=dict)
    models: Mapping[str, ModelSummary] = field(default_factory=dict)  #: models of a run
    failures: Mapping[str, str] = field(default_factory=dict)  #: reasons of failed models

    @classmethod
    def of_run(cls, case: Case, boom: Boom, data: xr.Dataset, summary: Summary) -> Self:
        """Return the results of a run, from the trajectories of its models and its summary."""
        states = []
        for name, model in summary.models.items():
            design = summary.design.models.get(name)
            rests, modes = (design.static, design.modes) if design else ([], [])
            tip = max((rest.tip for rest in rests), key=abs, default=model.static_tip)
            hertz = [mode.frequency for mode in modes]
            rest = next(iter(rests), None)
            states.append(State(f"in {name}", model.critical_factor, tip, hertz, rest))
        return cls(case, boom, states, data=data, models=summary.models, failures=summary.failures)

    @cached_property
    def drives(self) -> list[StickSlipEstimate]:
        """The estimates of elastic drives."""
        return list(stick_slip_estimates(self.case, self.boom))

    @cached_property
    def beam(self) -> BeamStates | None:
        """The static states of a beam; None without an equilibrium."""
        with suppress(*NUMERICAL_ERRORS):
            return BeamStates.of(self.case, boom_with_play(self.case, self.boom))
        return None

    @cached_property
    def wall_part(self) -> float | None:
        """The share of :func:`.pad_walls.wall_part`; None without an equilibrium."""
        with suppress(*NUMERICAL_ERRORS):
            return None if self.beam is None else wall_part(self.case, self.beam)
        return None


class Sentence(str):
    """Line of a rule that is no caution."""

    __slots__ = ()


# A rule yields the texts of its cautions, and other lines as sentences.
Rule = Callable[[Context], Iterator[str]]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What is known of a case when it is checked, and after its run."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple, Self

from protractile.analysis.rows import COMBINATION, INITIAL, REST, Row, Rows
from protractile.analysis.states import States
from protractile.dynamics.failure import NUMERICAL_ERRORS
from protractile.geometry.boom import Boom
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.beam_states import static_states
from protractile.runs.pipeline.drives import StickSlipEstimate, stick_slip_estimates
from protractile.runs.pipeline.pad_walls import wall_part
from protractile.runs.pipeline.statics import boom_with_play

if TYPE_CHECKING:
    import xarray as xr

    from protractile.runs.pipeline.results import Results
    from protractile.runs.pipeline.summary import ModelSummary


class State(NamedTuple):
    """Results at rest of a model, or of the beam that estimates it."""

    where: str  #: source of the results, for example ``in MODEL``
    #: buckling factor of the axial forces; None without them, or if it is not computed
    critical_factor: float | None = None
    tip: float | None = None  #: static tip deflection in m
    frequencies: Sequence[float] = ()  #: natural frequencies in Hz, with closed contacts
    closed: Sequence[Row] = ()  #: largest lateral plays that bulging walls close


@dataclass
class Context:
    """A case with its known results; a rule whose results are unknown yields nothing."""

    case: Case
    boom: Boom
    states: Sequence[State] = ()
    #: results of the beam of ``check``, empty without an equilibrium; None after a run
    rows: Rows | None = None
    combined: Rows = field(default_factory=Rows)  #: results of load cases and combinations
    #: trajectories of a run, with the dimensions ``model`` and ``time``
    data: Mapping[Hashable, xr.DataArray] = field(default_factory=dict)
    models: Mapping[str, ModelSummary] = field(default_factory=dict)  #: models of a run
    failures: Mapping[str, str] = field(default_factory=dict)  #: reasons of failed models

    @classmethod
    def of_run(cls, results: Results) -> Self:
        """Return what is known after a run."""
        summary, states = results.summary, list[State]()
        for name, model in summary.models.items():
            of_model = results.rows.where(model=name, play=True)
            tip = of_model.where(state=REST, quantity="tip").largest
            at_start = of_model.where(state=INITIAL)
            state = State(
                f"in {name}",
                model.critical_factor,
                model.static_tip if tip is None else tip.value,
                [row.value for row in at_start.where(quantity="frequency")],
                of_model.where(state=REST, quantity="closed_play"),
            )
            states.append(state)
        known = results.trajectories, summary.models, summary.failures
        combined = [row for row in results.rows if row.state.startswith(COMBINATION)]
        return cls(results.case, results.boom, states, None, Rows(combined), *known)

    @cached_property
    def drives(self) -> list[StickSlipEstimate]:
        """The estimates of elastic drives."""
        return list(stick_slip_estimates(self.case, self.boom))

    @cached_property
    def beam(self) -> States | None:
        """The static states of a beam; None without an equilibrium."""
        with suppress(*NUMERICAL_ERRORS):
            return static_states(self.case, boom_with_play(self.case, self.boom))
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

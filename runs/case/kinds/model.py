# SPDX-License-Identifier: LGPL-3.0-or-later
"""Interface of the kinds of models, and their common keys in the case file."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from time import perf_counter
from types import EllipsisType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Self, TypeVar, get_args

import numpy as np
from pydantic import PrivateAttr, ValidationError

from protractile.beam_model.boom_modes import critical_factor
from protractile.beam_model.component import SegmentModel
from protractile.beam_model.segment_model import gap_system
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.line import Line
from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.fields import In, Name, Positive, error_in_python, format_value
from protractile.runs.case.contact import ContactTable
from protractile.runs.case.limits import CaseTable
from protractile.runs.case.part_ranges import check_parts

if TYPE_CHECKING:
    from concurrent.futures import Executor

    from mpi4py import MPI

    from protractile.analysis.evaluation import Findings
    from protractile.analysis.model import AnalysisModel
    from protractile.beam_model.calibration import Calibration
    from protractile.dynamics.trajectory import Trajectory
    from protractile.runs.folder.cache import Cache
    from protractile.shell_model.reduced_shell import ReducedShell


@dataclass(frozen=True)
class BeamSegments:
    """Segments of a beam model, and their buckling factor. Each is computed on first use."""

    boom: Boom  #: boom with the contact laws of the model
    model: BeamTable  #: beam model

    @cached_property
    def segments(self) -> list[SegmentModel]:
        """The segments of the model, with rows in its generalised coordinates."""
        return self.model.segments(self.boom)

    @cached_property
    def lines(self) -> list[Line]:
        """The rows of deflections and section forces along each segment."""
        from protractile.beam_model.lines import lines

        return lines(self.boom.bonded if self.model.bonded else self.boom, self.segments)

    @cached_property
    def critical_factor(self) -> float | None:
        """The buckling factor, see :class:`BuiltModel`; None if it cannot be computed."""
        if not self.boom.compressed:
            return float("inf")
        try:
            with np.errstate(all="ignore"):
                return critical_factor(self.boom, self.segments)
        except (ArithmeticError, np.linalg.LinAlgError, ValueError):
            # With extreme numbers this fails. The run then fails too, and reports it.
            return None


@dataclass(frozen=True, slots=True)
class ModelBoom:
    """The boom of a case with the contact laws of one model, and its beam segments."""

    boom: Boom  #: boom of the case, with the model's contact laws in its joints
    _beams: dict[BeamTable, BeamSegments] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def beams(self, model: BeamTable) -> BeamSegments:
        """Return the beam segments of a model; equal models share one object."""
        return self._beams.setdefault(model, BeamSegments(self.boom, model))


@dataclass(frozen=True, slots=True)
class BuildContext:
    """Ranks, progress reporter and cache for the reduction of a shell."""

    comm: MPI.Comm  #: the ranks that share the work
    #: callback that receives the stage and its completed fraction
    progress: Callable[[str, float], None] = lambda *_: None
    cache: Cache | None = None  #: cache of reduced shells; without one, every shell is computed
    #: second process that shares the reduction if there is only one rank
    helper: Executor | None = None


@dataclass(frozen=True, slots=True)
class BuiltModel:
    """The gap system of a model, with data for estimates and results."""

    system: GapSystem  #: gap system of all segments
    num_dofs: int  #: number of degrees of freedom before any reduction
    seconds: dict[str, float] = field(default_factory=dict)  #: wall time of each stage in s
    #: Buckling factor of the axial forces with closed contacts, from
    #: :func:`.dynamics.second_order.buckling_factor`; infinite without axial forces.
    critical_factor: float | None = float("inf")
    shell: ReducedShell | None = None  #: the reduced shell, of a shell model
    calibration: Calibration | None = None  #: calibration of a beam by a shell
    lines: Sequence[Line] = ()  #: rows of section forces along segments, on the first rank
    beams: BeamSegments | None = None  #: beam segments of a model without calibration


@dataclass(frozen=True, slots=True)
class Surrogate:
    """A cheap beam model that replaces a model in estimates of its cost."""

    beam: ModelTable  #: the beam model
    coordinates: int  #: number of coordinates of the replaced model
    memory: float = 0.0  #: memory in bytes to build the replaced model
    seconds: float = 0.0  #: time in s to build the replaced model


class ModelTable(CaseTable):
    """Keys of every kind of model."""

    name: Name
    """the name of the model in the results"""
    contact: ContactTable | None = None
    """the contact law of this model; the joints' laws unless given"""
    step: Annotated[Positive, In("s")] | None = None
    """the time step of this model in s; the case's unless given"""
    kind: str
    """the kind of model"""
    _boom: Boom | None = PrivateAttr(None)

    def __init__(self, boom: Boom | EllipsisType = ..., /, **keys: Any) -> None:
        """Make a model of a boom.

        Args:
            boom: the boom of the model.
            keys: keys of the model in a case file; the default name is the kind.

        Raises:
            BoomError: an object that is no boom, an unknown key, or an invalid value.
        """
        name = type(self).__name__
        if not isinstance(boom, Boom | EllipsisType):
            raise BoomError(f"{name}.boom", f"must be a Boom, got {format_value(boom)}")
        kind = get_args(type(self).model_fields["kind"].annotation)[0]
        try:
            super().__init__(**{"name": kind, "kind": kind, **keys})
        except ValidationError as error:
            raise error_in_python(type(self), error) from None
        self._boom = boom if isinstance(boom, Boom) else None

    # With this private attribute pydantic validates without __init__: a case file must give name
    # and kind. Functions are typed without attributes.
    __init__.__pydantic_base_init__ = True  # type: ignore[attr-defined] # for pydantic

    def __init_subclass__(cls, init: bool = True) -> None:
        """Accept ``init=False``, by which type checkers take the constructor from this class."""

    # True if the model has a mesh of the plates and writes fields.
    meshed: ClassVar[bool] = False

    # True if section forces are smooth at point loads, as with a series of smooth functions.
    smooth: ClassVar[bool] = False

    @property
    def needs_shell(self) -> bool:
        """True if the model needs FEniCSx and a :class:`BuildContext`."""
        return self.meshed

    @property
    def needs_plates(self) -> bool:
        """True if the model needs the sections of the segments."""
        return self.needs_shell

    @property
    def plates_remedy(self) -> str:
        """The end of the message on missing sections: another remedy than giving them."""
        return ""

    def with_shells(self, update: Mapping[str, object]) -> Self:
        """Return the model with changed keys of its shell, or of the shell that calibrates it."""
        return self.model_copy(update=update) if self.meshed else self

    def coarsen(self, boom: Boom) -> Self:
        """Return a coarse model for fast checks; the model itself if it is coarse enough."""
        return self

    @property
    def bonded(self) -> bool:
        """True if the segments are bonded, without play."""
        return False

    @property
    def cannot_telescope(self) -> str | None:
        """The reason why the model cannot telescope, with the remedy; None if it can."""
        if self.bonded:
            return f"{self.name!r} is bonded, and cannot telescope; leave the model out"
        return None

    def check(self, where: str, model_boom: ModelBoom) -> None:
        """Check that the model is valid for this boom.

        Args:
            where: key of the model, for example ``model[2]``.
            model_boom: the boom with the contact laws of the model.

        Raises:
            BoomError: the model is not valid for the boom.
        """
        for number, segment in enumerate(model_boom.boom.segments, start=1):
            if self.needs_plates and segment.section is None:
                raise BoomError(
                    f"segment[{number}].section",
                    f"missing, and {self.name!r} needs it; give section or height_to_width"
                    f"{self.plates_remedy}",
                )
        driven = [i for i, j in enumerate(model_boom.boom.joints, start=1) if j.drive is not None]
        if driven and self.cannot_telescope is not None:
            raise BoomError(where, f"{self.cannot_telescope}, or joint[{driven[0]}].drive")
        factor = self.coarsen(model_boom.boom).critical_factor(model_boom)
        if factor is not None and factor <= 1.0:
            raise BoomError(
                where,
                f"the boom of {self.name!r} buckles under {factor:.3g} times its axial forces, and "
                "has no motion; it must bear more than all of them: make these smaller, or the "
                "sections larger",
            )

    @abstractmethod
    def describe(self) -> str:
        """Return a short description of the discretisation, for a table."""

    @abstractmethod
    def build(self, model_boom: ModelBoom, context: BuildContext | None = None) -> BuiltModel:
        """Return the gap system of the model with further data. For a shell all ranks must call it.

        Args:
            model_boom: the boom with the contact laws of the model.
            context: ranks, progress reporter and cache, for a meshed model.

        Raises:
            BoomError: the boom lacks what the model needs.
        """

    def model_boom(self, boom: Boom) -> ModelBoom:
        """Return the boom with the contact laws of the model in place of the laws of the joints.

        Raises:
            BoomError: a joint has no contact law, or its law does not admit shims.
        """
        if self.contact is not None:
            along_z, along_y = self.contact.law("z"), self.contact.law("y")
            joints = (replace(j, contact=along_z, lateral_contact=along_y) for j in boom.joints)
            boom = replace(boom, joints=tuple(joints))
        for number, joint in enumerate(boom.joints, start=1):
            if joint.contact is None and (joint.bonded or self.bonded):
                continue
            try:
                for law in (joint.law(direction) for direction in boom.directions):
                    for pad in joint.pads:
                        law.with_clearance(-pad.shim)
            except BoomError as error:
                raise BoomError(f"joint[{number}].contact", error.what) from None
            except ValueError:
                key = "interference" if not joint.pads else "pads"
                raise BoomError(
                    f"joint[{number}].{key}",
                    f"contact on both sides of a joint at once needs a law of the exponent 1, and "
                    f"model {self.name!r} has another; give it one, or leave interference out",
                ) from None
        return ModelBoom(boom)

    def system(self) -> GapSystem:
        """Return the gap system of the model.

        >>> pt.BeamElements(boom).system().num_modes
        66

        Raises:
            BoomError: the model is not valid for the boom.
        """
        return self._built()[1].system

    def _built(self) -> tuple[Boom, BuiltModel]:
        """Return the boom with the contact laws of the model, and the built model."""
        if self._boom is None:
            raise BoomError(self.name, "missing; give the boom that it is a model of")
        check_parts(self._boom)
        model_boom = self.model_boom(self._boom)
        self.check(self.name, model_boom)
        context = None
        if self.needs_shell:
            from mpi4py import MPI

            from protractile.runs.folder.cache import Cache

            context = BuildContext(MPI.COMM_SELF, cache=Cache.of_user())
        return model_boom.boom, self.build(model_boom, context)

    def simulate(
        self,
        duration: float,
        output_step: float = 1.0e-3,
        *,
        at_rest: bool = False,
        damping_ratio: float = 0.0,
        rayleigh: tuple[float, float] = (0.0, 0.0),
        tolerance: float = 1.0e-3,
    ) -> Trajectory:
        """Return the motion of the model, as the run of a case file computes it.

        >>> motion = pt.BeamElements(boom).simulate(0.5)
        >>> print(f"{motion.first_contact:.3f} s")
        0.032 s

        Args:
            duration: simulated time in s.
            output_step: output interval in s.
            at_rest: True to start in static equilibrium.
            damping_ratio: ratio of modal damping.
            rayleigh: mass and stiffness factors of Rayleigh damping in 1/s and s.
            tolerance: permitted error of the deflections by the time step, as a fraction of their
                range; not used if the model has a ``step``.

        Raises:
            BoomError: the model is not valid for the boom.
            NumericsError: the motion cannot be computed.
        """
        from protractile.dynamics.integrator import AdaptiveStep, FixedStep
        from protractile.dynamics.motion import build_motion

        motion = build_motion(
            self.system(), duration, output_step, at_rest, damping_ratio, rayleigh
        )
        return (AdaptiveStep(tolerance) if self.step is None else FixedStep(self.step))(motion)

    def evaluate(self, motion: Trajectory) -> Findings:
        """Return rows and curves of the model at rest and in a motion.

        >>> beam = pt.BeamElements(boom)
        >>> rows, curves = beam.evaluate(beam.simulate(0.1))
        >>> f"{1e3 * rows.where(quantity='tip', state='motion').largest.value:.0f} mm"
        '-59 mm'

        Args:
            motion: motion of :meth:`simulate`.
        """
        from protractile.analysis.evaluation import Findings, evaluate
        from protractile.analysis.fatigue import Life

        model, duration = self.analysis_model(*self._built()), float(motion.time[-1])
        rows, curves, _ = evaluate(model, self.name, motion, duration, panels=True, life=Life())
        return Findings.of(rows, curves)

    def analysis_model(self, boom: Boom, built: BuiltModel) -> AnalysisModel:
        """Return the built model of a boom under all constant loads."""
        from protractile.analysis.model import AnalysisModel

        boom_of_model = boom.bonded if self.bonded else boom
        return AnalysisModel.of(boom_of_model, built.system, self.lines(boom, built), self.smooth)

    @abstractmethod
    def critical_factor(self, model_boom: ModelBoom) -> float | None:
        """Return the buckling factor (see :class:`BuiltModel`), estimated for a meshed model."""

    @abstractmethod
    def lines(self, boom: Boom, built: BuiltModel) -> list[Line]:
        """Return rows of deflections and section forces along each segment, on the first rank."""

    def system_without_play(self, boom: Boom) -> tuple[GapSystem, list[Line]] | None:
        """Return the system of the bonded boom, and its lines; None if the model has none."""
        return None

    @abstractmethod
    def surrogate(self, boom: Boom) -> Surrogate:
        """Return the cheap beam model from which the cost of the model is estimated."""


class BeamTable(ModelTable, init=False):
    """Keys of a model whose segments are elements, series or rigid bodies along one axis."""

    @abstractmethod
    def segments(self, boom: Boom) -> list[SegmentModel]:
        """Return the matrices of each segment in its own coordinates."""

    def build(self, model_boom: ModelBoom, context: BuildContext | None = None) -> BuiltModel:
        start = perf_counter()
        beams = model_boom.beams(self)
        boom = model_boom.boom.bonded if self.bonded else model_boom.boom
        system = gap_system(boom, beams.segments)
        factor, seconds = beams.critical_factor, {"build": perf_counter() - start}
        return BuiltModel(system, system.num_modes, seconds, factor, beams=beams)

    def lines(self, boom: Boom, built: BuiltModel) -> list[Line]:
        return list(built.lines) if built.beams is None else built.beams.lines

    def system_without_play(self, boom: Boom) -> tuple[GapSystem, list[Line]] | None:
        from protractile.beam_model.lines import lines

        segments = self.segments(boom)
        return gap_system(boom.bonded, segments), lines(boom.bonded, segments)

    def critical_factor(self, model_boom: ModelBoom) -> float | None:
        return model_boom.beams(self).critical_factor


_Kind = TypeVar("_Kind", bound=ModelTable)


def select_kind(kind: type[_Kind], models: Iterable[ModelTable]) -> list[_Kind]:
    """Return the models of one kind."""
    return [model for model in models if isinstance(model, kind)]

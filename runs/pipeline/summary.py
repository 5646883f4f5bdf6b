# SPDX-License-Identifier: LGPL-3.0-or-later
"""The content of ``summary.json``: results of a run and of each model.

Fields are the file's keys, in its order; SI units. A field that was never set has no key; one that
is None stands in the file as null.
"""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Annotated, NamedTuple

from pydantic import BaseModel, BeforeValidator, ConfigDict
from pydantic_core import to_jsonable_python

from dynamics.drive.stick_slip import StickSlip
from dynamics.failure import NumericsError
from geometry.typography import TO_KILO, TO_PERCENT
from runs.case.schema import EnsembleTable
from runs.pipeline.comparison import Comparison
from runs.pipeline.design_results import DesignResults
from runs.pipeline.low_pass import SlowPeaks
from runs.pipeline.metrics import Metric
from runs.pipeline.pads import PadLoad
from shell_model.stress.history import StressSummary

# A number, and None for NaN and infinity, which JSON does not have.
Known = Annotated[
    float | None,
    BeforeValidator(lambda n: None if isinstance(n, float) and not math.isfinite(n) else n),
]


class SummaryTable(BaseModel):
    """A table of the summary, which has no other keys than its own."""

    model_config = ConfigDict(extra="forbid", validate_assignment=True)


class FirstPeak(NamedTuple):
    """Time in s and height in m; None where there is no peak."""

    time: Known
    height: Known


class EnsembleSummary(SummaryTable):
    """Summary of a model's ensemble.

    ``horizons`` has the time in s from which the members are a part of the tip's range apart, by
    that part; ``energy_residual`` is the largest of all members.
    """

    horizons: dict[str, Known]
    energy_residual: float
    slow_peaks: SlowPeaks | None

    def horizon(self, share: float) -> float | None:
        """Return the horizon in s for one of :data:`dynamics.predictability.horizon.SHARES`."""
        return self.horizons[f"{share:g}"]


class Predictability(SummaryTable):
    """Times at which changes of several sizes have grown to parts of the tip's range.

    ``times`` (relatives, shares) and ``of_step`` (shares) in s; ``rate`` (shares) in 1/s;
    ``limits`` (shares) as :class:`dynamics.predictability.horizon.Horizons` has them.
    """

    relatives: list[float]
    shares: list[float]
    times: list[list[Known]]
    of_step: list[Known]
    rate: list[Known]
    step_change: Known
    limits: list[str]


class Trial(SummaryTable):
    """A motion in longer steps: ``step`` in s, and whether it keeps the slow peaks."""

    step: float
    steps: int
    energy_residual: float
    holds: bool


class StepsForPeaks(SummaryTable):
    """Fewest steps that keep a number of slow peaks ``within`` a part; ``duration`` in s.

    ``fewest`` is None where no trial holds.
    """

    peaks: int
    within: float
    duration: float
    fewest: int | None
    trials: list[Trial]


class BeamStiffness(SummaryTable):
    """Stiffness of a segment as a beam, taken from its shell.

    E I in N·m² and G A_s in N, along z and in space along y, and G J_t in N·m² in space; parts are
    ratios to the stiffness that follows from the section.
    """

    segment: str
    bending: list[float]
    shear: list[float]
    torsion: Known = None
    bending_part: list[float]
    shear_part: list[float]
    torsion_part: Known = None


class StationSpring(SummaryTable):
    """The local compliance of a pressed place beyond the beams, in series with the contact there.

    ``x`` is its station's in m, ``side`` that of the outer segment's walls which the inner one
    presses, ``stiffness`` in N/m; none where it is rigid.
    """

    x: float
    side: str
    stiffness: Known


class CalibrationCard(SummaryTable):
    """Stiffness that a calibrated beam takes from its shell, for other programs."""

    segments: list[BeamStiffness]
    springs: list[StationSpring]


class ModelSummary(SummaryTable):
    """Results of one model: ``frequencies`` in Hz, ``seconds`` of wall time by the stage.

    ``wall_time`` in s is what has passed without the compilation of the time loop, while a stage
    whose results earlier runs have kept has the seconds that it took then.
    ``first_peak`` by the place; ``peak_contact_force`` in N is a mean over a step where
    ``resolving_step`` names the step in s that would resolve the blow; ``step_error`` is the change
    of the tip by the time step, as a part of its range;
    ``static_tip`` in m is where the tip rests under the constant loads; ``critical_factor`` is that
    of the axial forces at which the boom with its joints pressed buckles; ``stick_slip`` is what
    drives of a given stiffness do, by the names of what trajectories hold of their forces. Four are
    a shell's: ``reduction_errors`` by their kind, ``local_compliance`` in m/N, ``mesh_error`` as a
    part of it, ``stress``.
    """

    kind: str
    degrees_of_freedom: int
    modes: int
    frequencies: list[float]
    seconds: dict[str, float]
    step: float
    steps: int
    first_contact: Annotated[Known, Metric("first_contact", "s", "first contact", 1.0, "s")]
    contact_changes: int
    energy_residual: Annotated[
        float,
        Metric(
            "energy_residual",
            "1",
            "energy residual",
            1.0,
            "–",
            charted=False,
            heading="energy residual\nof the work",
            form=".1g",
        ),
    ]
    first_peak: dict[str, FirstPeak]
    peak_contact_force: Annotated[
        Known,
        Metric("peak_contact_force", "N", "peak of a blow", TO_KILO, "kN", charted=False),
    ]
    wall_time: Annotated[
        float | None, Metric("", "s", "wall time", 1.0, "s", heading="wall time", form=".1f")
    ] = None
    step_error: Annotated[
        Known,
        Metric("step_error", "1", "error by the time step", TO_PERCENT, "%", charted=False),
    ] = None
    resolving_step: Known = None
    ensemble: EnsembleSummary | None = None
    horizons: Predictability | None = None
    steps_for_peaks: StepsForPeaks | None = None
    static_tip: Known = None
    critical_factor: Known = None
    reduction_errors: dict[str, Known] = {}
    local_compliance: list[Known] = []
    mesh_error: Known = None
    stress: StressSummary | None = None
    calibration: CalibrationCard | None = None
    stick_slip: dict[str, StickSlip] = {}


class Whole(SummaryTable):
    """Two tips until several times in s, as parts of the larger range."""

    until: list[float]
    largest: list[Known]
    rms: list[Known]


class Comparisons(SummaryTable):
    """Each model against the reference, by its name; ``whole`` where segments rub."""

    reference: str
    ensembles: dict[str, Comparison] = {}
    whole: dict[str, Whole] = {}


class Ensembles(EnsembleTable):
    """Ensembles as the case requests them, and the cut-off of the slow motion in Hz."""

    slow_below: float | None


class Snapshots(SummaryTable):
    """Names of the pictures, or why there are none."""

    written: list[str]
    skipped: str | None


class Summary(SummaryTable):
    """Content of ``summary.json``: ``models`` that ran, ``failures`` with the reasons of others.

    ``pads`` are those of all models and stations, ``cautions`` lines on the limits of the
    results.
    """

    title: str
    case_hash: str
    versions: dict[str, str | None]
    models: dict[str, ModelSummary]
    failures: dict[str, str]
    ensemble: Ensembles | None = None
    design: DesignResults = DesignResults({})
    pads: list[PadLoad] = []
    cautions: list[str] = []
    comparisons: Comparisons | None = None
    snapshots: Snapshots = Snapshots(written=[], skipped=None)

    @classmethod
    def load(cls, path: Path) -> Summary:
        """Read a file.

        Raises:
            OSError, ValidationError: it cannot be read, or holds something else.
        """
        return cls.model_validate_json(path.read_bytes())

    def __str__(self) -> str:
        """Return the file's content."""
        content = self.model_dump(exclude_unset=True)
        return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def check_finite(part: object) -> None:
    """Refuse a part of a summary with numbers that JSON cannot hold.

    Raises:
        NumericsError: a number is infinite, or none.
    """
    try:
        json.dumps(to_jsonable_python(part), allow_nan=False)
    except ValueError:
        raise NumericsError(
            "a result is not finite; look for a number of the case that is out of proportion, in "
            "another unit say"
        ) from None

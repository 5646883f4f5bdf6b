# SPDX-License-Identifier: LGPL-3.0-or-later
"""Content of ``summary.json``: results of a run and of each model, in SI units.

Fields are the keys of the file, in its order. A field that was never set has no key; None becomes
null.
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

# Type of numbers in JSON: None replaces NaN and infinity.
Known = Annotated[
    float | None,
    BeforeValidator(lambda n: None if isinstance(n, float) and not math.isfinite(n) else n),
]


class SummaryTable(BaseModel):
    """Table of the summary, without unknown keys."""

    model_config = ConfigDict(extra="forbid", validate_assignment=True)


class FirstPeak(NamedTuple):
    """First peak: time in s and height in m; both None without a peak."""

    time: Known
    height: Known


class EnsembleSummary(SummaryTable):
    """Summary of a model's ensemble.

    ``horizons`` has the times in s from which members differ by a share of the tip's range, by
    share; ``energy_residual`` is the largest one of all members.
    """

    horizons: dict[str, Known]
    energy_residual: float
    slow_peaks: SlowPeaks | None

    def horizon(self, share: float) -> float | None:
        """Return the horizon in s for one of :data:`dynamics.predictability.horizon.SHARES`."""
        return self.horizons[f"{share:g}"]


class Predictability(SummaryTable):
    """Times at which changes of several sizes have grown to shares of the tip's range.

    ``times`` (relatives, shares) and ``of_step`` (shares) in s; ``rate`` (shares) in 1/s;
    ``limits`` (shares) as in :class:`dynamics.predictability.horizon.Horizons`.
    """

    relatives: list[float]
    shares: list[float]
    times: list[list[Known]]
    of_step: list[Known]
    rate: list[Known]
    step_change: Known
    limits: list[str]


class Trial(SummaryTable):
    """Motion with longer steps: ``step`` in s, and whether it preserves the slow peaks."""

    step: float
    steps: int
    energy_residual: float
    holds: bool


class StepsForPeaks(SummaryTable):
    """Fewest steps that preserve a number of slow peaks ``within`` a tolerance.

    ``duration`` in s; ``fewest`` is None if no trial preserves them.
    """

    peaks: int
    within: float
    duration: float
    fewest: int | None
    trials: list[Trial]


class BeamStiffness(SummaryTable):
    """Stiffness of a segment as a beam, determined from its shell.

    E I in N·m² and G A_s in N, along z and in space along y, and G J_t in N·m² in space. ``part``
    fields are ratios to the stiffness that follows from the section.
    """

    segment: str
    bending: list[float]
    shear: list[float]
    torsion: Known = None
    bending_part: list[float]
    shear_part: list[float]
    torsion_part: Known = None


class StationSpring(SummaryTable):
    """Spring of a station: the local compliance of walls, in series with the contact.

    ``x`` is the position of the station in m, ``side`` the loaded wall of the outer segment,
    ``stiffness`` in N/m; None for rigid walls.
    """

    x: float
    side: str
    stiffness: Known


class CalibrationCard(SummaryTable):
    """Stiffness of a calibrated beam, for use in other programs."""

    segments: list[BeamStiffness]
    springs: list[StationSpring]


class ModelSummary(SummaryTable):
    """Results of one model: ``frequencies`` in Hz, ``seconds`` of wall time by the stage.

    ``wall_time`` in s excludes the compilation of the time loop. A stage whose results come from an
    earlier run has the time of that run. ``first_peak`` by place; ``peak_contact_force`` in N is
    the mean over a step if the step does not resolve the impact, and ``resolving_step`` in s would
    resolve it; ``step_error`` is the error of the tip by the time step, as a fraction of its range;
    ``static_tip`` in m is the tip deflection under the constant loads; ``critical_factor``
    multiplies the axial forces up to buckling with closed joints; ``stick_slip`` has the results of
    elastic drives, by the names of their forces in trajectories. Shells have ``reduction_errors``
    by kind, ``local_compliance`` in m/N, ``mesh_error`` as a fraction of it, and ``stress``.
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
    """Differences between two tips until several times in s, as fractions of the larger range."""

    until: list[float]
    largest: list[Known]
    rms: list[Known]


class Comparisons(SummaryTable):
    """Comparisons of models with the reference, by name; ``whole`` with friction."""

    reference: str
    ensembles: dict[str, Comparison] = {}
    whole: dict[str, Whole] = {}


class Ensembles(EnsembleTable):
    """Data of the ensembles in the case, and the cut-off of the slow motion in Hz."""

    slow_below: float | None


class Snapshots(SummaryTable):
    """Names of the pictures, or the reason why there are none."""

    written: list[str]
    skipped: str | None


class Summary(SummaryTable):
    """Content of ``summary.json``.

    ``models`` has the models that ran, ``failures`` the reasons why others failed; ``pads`` has the
    pads of all models and stations, ``cautions`` lines on the limits of the results.
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
        """Read ``summary.json``.

        Raises:
            OSError, ValidationError: the file cannot be read, or has other content.
        """
        return cls.model_validate_json(path.read_bytes())

    def __str__(self) -> str:
        """Return the content of the file."""
        content = self.model_dump(exclude_unset=True)
        return json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def check_finite(part: object) -> None:
    """Check that all numbers of a part of a summary are finite.

    Raises:
        NumericsError: a number is NaN or infinite.
    """
    try:
        json.dumps(to_jsonable_python(part), allow_nan=False)
    except ValueError:
        raise NumericsError(
            "a result is not finite; look for an extreme number of the case, for example in "
            "another unit"
        ) from None

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Content of ``summary.json``: results of a run and of each model, in SI units.

The fields are the keys of the file, in this order. A field that is not set has no key in the file;
None becomes null.
"""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Annotated, NamedTuple, Self

from pydantic import BaseModel, BeforeValidator, ConfigDict
from pydantic_core import to_jsonable_python

from protractile.analysis.comparison import Comparison
from protractile.analysis.low_pass import SlowPeaks
from protractile.analysis.quantities import Quantity
from protractile.dynamics.failure import NumericsError
from protractile.dynamics.predictability import Horizons
from protractile.dynamics.stick_slip import StickSlip
from protractile.runs.case.schema import EnsembleTable
from protractile.runs.pipeline.design_results import DesignResults
from protractile.shell_model.stress.history import StressSummary

# Number in JSON: None replaces NaN and infinity.
FiniteNumber = Annotated[
    float | None,
    BeforeValidator(lambda n: None if isinstance(n, float) and not math.isfinite(n) else n),
]


class SummaryTable(BaseModel):
    """Table of the summary, without unknown keys."""

    # Only a run has a summary; others need the quantities of its classes alone.
    model_config = ConfigDict(extra="forbid", validate_assignment=True, defer_build=True)


class FirstPeak(NamedTuple):
    """Time in s and height in m of the first peak; both None without a peak."""

    time: FiniteNumber
    height: FiniteNumber


class EnsembleSummary(SummaryTable):
    """Summary of the ensemble of a model.

    ``horizons`` has the times in s at which the tips of the members differ by shares of the range
    of the tip; the shares are the keys. ``energy_residual`` is the maximum over the members.
    """

    horizons: dict[str, FiniteNumber]
    energy_residual: float
    slow_peaks: SlowPeaks | None

    def horizon(self, share: float) -> float | None:
        """Return the horizon in s for one of :data:`.dynamics.predictability.SHARES`."""
        return self.horizons[f"{share:g}"]


class Predictability(SummaryTable):
    """Times until small changes of a motion grow to shares of the range of the tip.

    ``times`` (num_relatives, num_shares) in s belong to relative changes of the data, ``of_step``
    (num_shares,) in s to a finer time step. ``rate`` (num_shares,) is the growth rate in 1/s. The
    other fields are those of :class:`.dynamics.predictability.Horizons`.
    """

    relatives: list[float]
    shares: list[float]
    times: list[list[FiniteNumber]]
    of_step: list[FiniteNumber]
    rate: list[FiniteNumber]
    step_change: FiniteNumber
    limits: list[str]

    @classmethod
    def of(cls, horizons: Horizons) -> Self:
        """Return the horizons as numbers of the summary."""
        return cls(
            relatives=horizons.relatives.tolist(),
            shares=horizons.shares.tolist(),
            times=horizons.times.tolist(),
            of_step=horizons.of_step.tolist(),
            rate=[growth.rate for growth in horizons.growth],
            step_change=horizons.step_change,
            limits=list(horizons.limits),
        )


class Trial(SummaryTable):
    """Motion with a step of ``step`` in s; ``holds`` is true if it preserves the slow peaks."""

    step: float
    steps: int
    energy_residual: float
    holds: bool


class StepsForPeaks(SummaryTable):
    """Fewest steps of a motion that preserve the first slow peaks within the tolerance ``within``.

    ``duration`` in s is that of the trials. ``fewest`` is None if no trial preserves the peaks.
    """

    peaks: int
    within: float
    duration: float
    fewest: int | None
    trials: list[Trial]


class BeamStiffness(SummaryTable):
    """Beam stiffness of a segment, determined from its shell.

    ``bending`` is E I in N·m² and ``shear`` is G A_s in N, along z and in space also along y.
    ``torsion`` is G J_t in N·m² in space. Fields that end in ``part`` are ratios to the stiffness
    of the section.
    """

    segment: str
    bending: list[float]
    shear: list[float]
    torsion: FiniteNumber = None
    bending_part: list[float]
    shear_part: list[float]
    torsion_part: FiniteNumber = None


class StationSpring(SummaryTable):
    """Spring in series with the contact of a station, for the local compliance of walls.

    ``x`` is the position of the station in m, ``side`` the loaded wall of the outer segment, and
    ``stiffness`` in N/m is None for rigid walls.
    """

    x: float
    side: str
    stiffness: FiniteNumber


class CalibrationCard(SummaryTable):
    """Stiffness of a calibrated beam, for use in other programs."""

    segments: list[BeamStiffness]
    springs: list[StationSpring]


class ModelSummary(SummaryTable):
    """Results of one model: ``frequencies`` in Hz, wall times in ``seconds`` by stage.

    ``wall_time`` in s excludes the compilation of the time loop. If a stage reuses results of an
    earlier run, it has the wall time of that run. ``first_peak`` has the first peak of each output.
    If the step is too long for an impact, ``peak_contact_force`` in N is a mean over a step, and
    ``resolving_step`` in s is short enough. ``step_error`` is the error of the tip by the step, as
    a fraction of its range. ``static_tip`` in m is the static tip deflection at t = 0. The
    axial forces times ``critical_factor`` cause buckling with closed joints. ``stick_slip`` has the
    results of elastic drives by the names of their forces in trajectories. Shells have
    ``reduction_errors`` by kind, ``local_compliance`` in m/N, ``mesh_error`` as a fraction of it,
    and ``stress``. ``reduction_error`` is the error of the tip's motion by the reduction of a shell
    with friction, as a fraction of its range.
    """

    kind: str
    degrees_of_freedom: int
    modes: int
    frequencies: list[float]
    seconds: dict[str, float]
    step: float
    steps: int
    first_contact: Annotated[FiniteNumber, Quantity("first_contact", "s", "first contact")]
    contact_changes: int
    energy_residual: Annotated[
        float,
        Quantity(
            "energy_residual", "1", "energy residual",
            heading="energy residual\n/ largest work", form=".1g", charted=False,
        ),
    ]  # fmt: skip
    first_peak: dict[str, FirstPeak]
    peak_contact_force: Annotated[
        FiniteNumber,
        Quantity("peak_contact_force", "N", "peak force of an impact", shown="kN", charted=False),
    ]
    wall_time: Annotated[
        float | None, Quantity("", "s", "computing time", heading="computing time", form=".1f")
    ] = None
    step_error: Annotated[
        FiniteNumber,
        Quantity("step_error", "1", "time-step error of deflections", shown="%", charted=False),
    ] = None
    resolving_step: FiniteNumber = None
    ensemble: EnsembleSummary | None = None
    horizons: Predictability | None = None
    steps_for_peaks: StepsForPeaks | None = None
    static_tip: FiniteNumber = None
    critical_factor: FiniteNumber = None
    reduction_errors: dict[str, FiniteNumber] = {}
    reduction_error: Annotated[
        FiniteNumber,
        Quantity("reduction_error", "1", "reduction error of the tip", shown="%", charted=False),
    ] = None
    local_compliance: list[FiniteNumber] = []
    mesh_error: FiniteNumber = None
    stress: StressSummary | None = None
    calibration: CalibrationCard | None = None
    stick_slip: dict[str, StickSlip] = {}


class WholeRun(SummaryTable):
    """Differences between the tips of two models, as fractions of the larger range.

    ``largest`` and ``rms`` are the differences up to each of the times ``until`` in s.
    """

    until: list[float]
    largest: list[FiniteNumber]
    rms: list[FiniteNumber]


class Comparisons(SummaryTable):
    """Comparisons of models with the reference, by model name.

    ``ensembles`` compares chaotic motions, ``whole`` motions that friction makes regular.
    """

    reference: str
    ensembles: dict[str, Comparison] = {}
    whole: dict[str, WholeRun] = {}


class Ensembles(EnsembleTable):
    """Table ``ensemble`` of the case; ``slow_below`` is the low-pass cut-off in Hz."""

    slow_below: float | None


class Snapshots(SummaryTable):
    """Titles and captions of the ``written`` pictures by file name, or why they are ``skipped``."""

    written: dict[str, tuple[str, str]]
    skipped: str | None


class Summary(SummaryTable):
    """Content of ``summary.json``.

    ``models`` has the completed models, ``failures`` the reasons why others failed, ``cautions``
    texts on the validity of the results.
    """

    title: str
    case_hash: str
    versions: dict[str, str | None]
    models: dict[str, ModelSummary]
    failures: dict[str, str]
    ensemble: Ensembles | None = None
    design: DesignResults = DesignResults({})
    cautions: list[str] = []
    comparisons: Comparisons | None = None
    snapshots: Snapshots = Snapshots(written={}, skipped=None)

    @classmethod
    def load(cls, path: Path) -> Summary:
        """Read ``summary.json``.

        Raises:
            OSError, ValidationError: the file cannot be read, or is invalid.
        """
        return cls.model_validate_json(path.read_bytes())

    def __str__(self) -> str:
        """Return the summary as JSON."""
        content = self.model_dump(exclude_unset=True)
        text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False)
        # A list of numbers is one line. No text of JSON has a line break.
        return re.sub(r"\[\n([^][{}\"]+)\]", lambda of: f"[{' '.join(of[1].split())}]", text) + "\n"


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

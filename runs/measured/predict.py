# SPDX-License-Identifier: LGPL-3.0-or-later
"""Prediction: scatter of results by the covariance of identified numbers."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from protractile.runs.measured.identify import Identification
from protractile.runs.process import workers
from protractile.runs.process.terminal import Progress, Terminal
from protractile.runs.sweep.run import prepare, run_points
from protractile.runs.sweep.sampling import conclude_samples, normal_points, plan_points


def predict(found: Identification, count: int, folder: Path, progress: Progress) -> None:
    """Run samples of the identified numbers, print the scatter of results, and write its files.

    Samples have the identified values as means and the covariance of the fit; those beyond a bound
    are moved to it.

    Args:
        found: identified numbers of a case.
        count: number of samples, checked by :func:`.runs.sweep.sampling.check_count`.
        folder: folder of the files of :mod:`.runs.sweep.sampling`.
        progress: callback that receives model, stage and completed fraction.

    Raises:
        BadInput: a sample is invalid.
    """
    fit, experiment = found.found, found.residuals.experiment
    root = np.linalg.cholesky(fit.covariance_with())
    points = normal_points(fit.values.size, count)
    values = np.clip(fit.values + points @ root.T, fit.low, fit.high)
    # The time offset of a channel does not change the boom.
    settings = experiment.variations(found.residuals.settings(fit.values))
    of_boom = [found.keys.index(variation.key) for variation, _ in settings]
    plan, samples = plan_points(
        found.case, experiment.file, [experiment.whole.models[0].name], None,
        [variation for variation, _ in settings], values[:, of_boom],
    )  # fmt: skip
    with TemporaryDirectory() as temporary, workers.workers(None) as pool:
        prepare(Path(temporary), experiment.file)
        outcomes = run_points(plan, Path(temporary), pool, progress)
    conclude_samples(samples, plan, outcomes, folder, Terminal())

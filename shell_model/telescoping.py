# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells of telescoping booms: modes of segments, and springs that move with pads.

A Krylov basis for pad forces at all extensions would be large. But pads excite few modes of
segments, and springs represent the remaining compliance of walls
(:func:`springs`). Rows and springs are sampled at extensions one mesh size
apart, with splines between them. The geometric stiffness of a moving axial force follows from the
slope of the mean deflection, a spline between mesh lines. Local bending of walls has the geometric
stiffness of the initial extension.

At the extension s, pads with the rows B(s) have the compliance B (K + σ M)⁻¹ Bᵀ at the shift σ.
Modes of the circular frequencies ω_i and the rows b_i(s) contribute Σ_i b_i b_iᵀ / (ω_i² + σ). The
difference Γ(s, σ) is a compliance of walls, with small inertia up to about 1000 Hz. Springs with
the diagonal matrix Ω_p of circular frequencies and the rows L(s) = Γ^½ X (Ω_p² + σ)^½ represent it:
L (Ω_p² + σ)⁻¹ Lᵀ = Γ for all s at one σ (residual flexibility; MacNeal 1971). Ω_p and the
orthogonal matrix X represent the inertia Γ′ = −dΓ/dσ by the mean of Γ^−½ Γ′ Γ^−½ = X (Ω_p² + σ)⁻¹
Xᵀ over all extensions (Rubin 1975). The symmetric root Γ^½ is smooth in s.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from mpi4py import MPI

from protractile.dynamics.gap_builder import GapBuilder
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.motion_laws import HistorySum
from protractile.dynamics.reduction import reduce_modes, with_coordinates
from protractile.dynamics.travel import ROW_KINDS, MovingAxialForce, RowKind, RowTable, Travel
from protractile.geometry.arrays import Array, Mask
from protractile.geometry.axial import joint_thrust, moving_force
from protractile.geometry.boom import SAME_PLACE, Boom
from protractile.geometry.telescoping import TelescopingStations, reach, telescoping_stations
from protractile.shell_model.boom_shell import BoomShell
from protractile.shell_model.reduction.coordinates import BoomCoordinates
from protractile.shell_model.reduction.segment import ReducedSegment
from protractile.shell_model.reduction.symmetry import Job, SymmetryReduction
from protractile.shell_model.segment.cross_section import Operator, Row
from protractile.shell_model.segment.segment_shell import SegmentShell
from protractile.shell_model.segment.solver import ShiftedSolver, exact_product, squared, times
from protractile.shell_model.stress.stresses import lines_around

# Maximum frequency of modes in Hz, frequency in Hz up to which all modes are kept, and minimum
# contribution of a higher mode as a fraction of the compliance of springs.
_CUTOFF, _SLOWEST, _PART = 1500.0, 100.0, 0.003

# Number of moments of the reduction, which includes pad forces at every fourth extension.
MOMENTS = 2
_EVERY = 4

# Minimum number of extensions at which rows are sampled.
_FEWEST = 4

# Frequencies in Hz: of the shift σ, between rigid and residual modes, and maximum of springs.
SLOW, _FASTEST = 50.0, 10000.0

# Fraction of the largest compliance below which the compliance of a force pattern is neglected.
_NEGLIGIBLE = 1.0e-4


@dataclass(frozen=True, slots=True)
class _SampledRows:
    """Rows of a group of stations at several extensions."""

    group: TelescopingStations | None  #: stations and drives; None for rows that do not move
    moving: Sequence[tuple[RowKind, int]]  #: (kind, index) of each row in the gap system
    extensions: Array  #: extensions (num_extensions,) in m, ascending
    touching: Sequence[GapBuilder[Operator]]  #: contacts, friction and dashpots at each extension

    @property
    def start(self) -> int:
        """The index of the extension 0."""
        return int(np.abs(self.extensions).argmin())

    @property
    def count(self) -> int:
        """The number of rows at all extensions."""
        return self.extensions.size * len(self.moving)

    def columns(self, shell: SegmentShell, number: int, step: int = 1) -> Array:
        """Return rows as columns (num_owned, num_columns), at each ``step``-th extension."""
        rows = [
            contact.evaluate_rows(
                self.moving, lambda operator: shell.row(operator.get(number, Row()))
            )
            for contact in self.touching[::step]
        ]
        return np.asarray(np.concatenate(rows).T)

    def moving_and_constant_rows(self, comm: MPI.Comm, columns: Array) -> tuple[Mask, Mask]:
        """Return masks (num_extensions · num_moving,) of moving and constant rows. Collective.

        ``columns`` are the rows of one segment. Constant rows do not depend on the extension on
        this segment, and are marked at the first extension only.
        """
        rows = columns.T.reshape(self.extensions.size, len(self.moving), -1)
        same = comm.allreduce((rows[0] == rows[-1]).all(axis=1), MPI.LAND)
        here = comm.allreduce(rows[0].any(axis=1), MPI.LOR)
        first = np.arange(self.count) < len(self.moving)
        size = self.extensions.size
        return np.tile(~same, size), np.tile(same & here, size) & first

    def rows(self, coordinates: BoomCoordinates) -> Array:
        """Return the rows (num_extensions, num_moving, num_modes)."""
        return np.array(
            [contact.evaluate_rows(self.moving, coordinates.row) for contact in self.touching]
        )


def _sample_rows(boom: Boom, full: BoomShell, size: float) -> list[_SampledRows]:
    """Return all rows of a boom: moving ones at extensions about ``size`` apart, others once."""
    samples = []
    for group in telescoping_stations(boom):
        pieces = [
            np.linspace(start, end, max(round((end - start) / size), _FEWEST) + 1)
            for start, end in pairwise(sorted({*reach(group.drives), 0.0}))
        ]
        moving, extensions = full.rows.rows_at(group.stations), np.unique(np.concatenate(pieces))
        touching = [
            full.touching.rows(group.extensions(extension)) for extension in extensions.tolist()
        ]
        samples.append(_SampledRows(group, moving, extensions, touching))
    moving_rows = {row for sampled in samples for row in sampled.moving}
    every = full.rows.rows_at(range(len(boom.stations)))
    if fixed_rows := [row for row in every if row not in moving_rows]:
        samples.append(_SampledRows(None, fixed_rows, np.zeros(1), [full.rows]))
    return samples


class TelescopingShell:
    """Shell of a telescoping boom. Collective.

    Args:
        boom: boom whose joints have drives.
        full: shells of the boom.
        size: edge length of the meshes in m.
        reduce: function that returns all reduced segments from the load vectors
            (num_owned, num_columns) of pads at several extensions on each segment.
        test: frequency in Hz at which the error of springs is measured.

    Attributes:
        reduced: reduced segments, without springs.
    """

    def __init__(
        self,
        boom: Boom,
        full: BoomShell,
        size: float,
        reduce: Callable[[Sequence[Array]], list[ReducedSegment]],
        test: float,
    ) -> None:
        self._boom, self._full, self._test = boom, full, test
        self._sampled = _sample_rows(boom, full, size)
        self.reduced: list[ReducedSegment] = []
        self._responses: list[PadResponses] = []
        segments = reduce([self._columns(number, _EVERY) for number in range(len(full.shells))])
        for number, (symmetry, segment) in enumerate(zip(full.symmetries, segments, strict=True)):
            columns = self._columns(number)
            self._responses.append(pad_responses(symmetry, columns, test))
            self.reduced.append(self._with_few_modes(number, segment, columns))
        # Springs represent the residual response, without axial forces.
        free = [replace(segment, geometric=0.0 * segment.geometric) for segment in self.reduced]
        self._segment_coordinates = BoomCoordinates(full, free, ())
        self._rows = [sampled.rows(self._segment_coordinates) for sampled in self._sampled]
        self._springs = [springs(*self._residuals(k)) for k in range(len(self._sampled))]

    def compliance_error(self, contacts: int) -> Array:
        """Return the largest error (num_contacts,) in m/N of the compliance over all extensions."""
        sigma, errors = squared(self._test), np.zeros(contacts)
        for k, sampled in enumerate(self._sampled):
            omega2, pulls = self._springs[k]
            parts = (self._rows[k], self._segment_coordinates.omega2), (pulls, omega2)
            reduced = sum(rows**2 @ (1.0 / (of + sigma)) for rows, of in parts)
            whole = np.einsum("wjj->wj", self._compliance(k, "tested"))
            off = np.abs(whole - reduced).max(axis=0)
            for (kind, row), most in zip(sampled.moving, off.tolist(), strict=True):
                if kind == "rows":
                    errors[row] = most
        return errors

    def with_springs(self, system: GapSystem, coordinates: BoomCoordinates) -> GapSystem:
        """Return ``system``, which is in the coordinates of the boom, with springs and travels."""
        first_of, stacked = {}, 0
        for kind in ROW_KINDS:
            first_of[kind] = stacked
            stacked += len(getattr(system, kind))
        behind = np.cumsum([0, *(omega2.size for omega2, _ in self._springs)])
        spring_rows, travels = np.zeros((stacked, behind[-1])), []
        for k, (sampled, (_, pulls)) in enumerate(zip(self._sampled, self._springs, strict=True)):
            beside = np.zeros((*pulls.shape[:2], behind[-1]))
            beside[..., behind[k] : behind[k + 1]] = pulls
            at = [first_of[kind] + position for kind, position in sampled.moving]
            spring_rows[at] = beside[sampled.start]
            if sampled.group is not None:
                rows = np.concatenate([coordinates.of_rows(self._rows[k]), beside], axis=2)
                travel = Travel(
                    HistorySum(tuple(drive.history for drive in sampled.group.drives)),
                    RowTable.spline(sampled.extensions, rows),
                    sampled.moving,
                    sampled.group.suffix,
                    _moving_axial_forces(
                        self._boom, self._full, coordinates, sampled.group, int(behind[-1])
                    ),
                    joint_thrust(self._boom.segments, self._boom.joints, sampled.group.joints[0]),
                )
                travels.append(travel)
        omega2 = np.concatenate([omega2 for omega2, _ in self._springs])
        return replace(with_coordinates(system, omega2, spring_rows), travels=travels)

    def _columns(self, number: int, step: int = 1) -> Array:
        shell = self._full.shells[number]
        return np.hstack([sampled.columns(shell, number, step) for sampled in self._sampled])

    def _with_few_modes(
        self, number: int, segment: ReducedSegment, columns: Array
    ) -> ReducedSegment:
        """Return a segment with the modes that pads excite, and responses to all other forces.

        ``columns`` (num_owned, num_columns) are the rows of pads at all extensions.
        """

        def project(columns: Array) -> Array:
            """Return columns (num_owned, num_columns) as modal rows (num_columns, num_modes)."""
            rows = [exact_product(self._full.comm, column, segment.shapes) for column in columns.T]
            return np.array(rows).reshape(-1, segment.omega2.size)

        bounds = np.cumsum([sampled.count for sampled in self._sampled])[:-1]
        masks = [
            sampled.moving_and_constant_rows(self._full.comm, part)
            for sampled, part in zip(self._sampled, np.split(columns, bounds, axis=1), strict=True)
        ]
        moving, constant = (np.concatenate(which) for which in zip(*masks, strict=True))
        outputs = [observer.operator for observer in self._full.observed.values()]
        rows, observed = project(columns), project(self._full.columns(number, outputs))
        parts = rows[moving] ** 2 / (segment.omega2 + squared(SLOW))
        below = segment.omega2 < squared(_CUTOFF)
        local = np.diag(self._responses[number].compliance)[moving]
        residual = local - parts[:, below].sum(axis=1)
        slow = segment.omega2 < squared(_SLOWEST)
        slow |= below & (parts > _PART * residual[:, None]).any(axis=0)
        fixed = self._full.fixed_loads(number), self._full.columns(number, self._full.ties)
        pushes = [*(project(some) for some in fixed), observed, rows[constant]]
        modes = np.flatnonzero(slow), np.flatnonzero(~slow)
        omega2, shapes = reduce_modes(segment.omega2, np.vstack(pushes), *modes, MOMENTS)
        order = np.argsort(omega2, kind="stable")
        omega2, shapes = omega2[order], shapes[:, order]
        error = self._transfer_error((segment.omega2, rows, observed), (omega2, shapes))
        return replace(
            segment,
            omega2=omega2,
            shapes=segment.shapes @ shapes,
            geometric=shapes.T @ segment.geometric @ shapes,
            coarser=np.eye(omega2.size),
            output_error=max(segment.output_error, error),
        )

    def _transfer_error(self, many: tuple[Array, Array, Array], few: tuple[Array, Array]) -> float:
        """Return the largest error of the response of an output to a pad force.

        It is relative to the geometric mean of the compliances of output and pad. ``many`` has ω²,
        the rows of pads and the rows of outputs in all modes, ``few`` ω² and shapes of kept modes.
        """
        omega2, rows, observed = many
        shifted, shapes = (
            (1.0 / (squares + squared(self._test)) for squares in (omega2, few[0])),
            few[1],
        )
        of_many, of_few = shifted
        error = (observed * of_many) @ rows.T
        error -= ((observed @ shapes) * of_few) @ (rows @ shapes).T
        sizes = (np.sqrt(operator**2 @ of_many) for operator in (observed, rows))
        scale = np.maximum(np.outer(*sizes), np.finfo(float).tiny)
        return float((np.abs(error) / scale).max(initial=0.0))

    def _residuals(self, k: int) -> tuple[Array, Array]:
        """Return the parts of compliance and inertia that the modes do not represent.

        Both are (num_extensions, num_moving, num_moving), in m/N and in m s²/N.
        """
        rows, shifted = self._rows[k], self._segment_coordinates.omega2 + squared(SLOW)
        compliance, inertia = (rows / shifted**power @ rows.swapaxes(1, 2) for power in (1, 2))
        return self._compliance(k, "compliance") - compliance, self._compliance(
            k, "inertia"
        ) - inertia

    def _compliance(self, k: int, kind: str) -> Array:
        """Return a response (num_extensions, num_moving, num_moving) of all full segments."""
        first, sampled = sum(sample.count for sample in self._sampled[:k]), self._sampled[k]
        block = slice(first, first + sampled.count)
        whole = np.sum(
            [getattr(response, kind)[block, block] for response in self._responses], axis=0
        )
        size = sampled.extensions.size
        return np.asarray(
            np.einsum("wiwj->wij", whole.reshape(size, len(sampled.moving), size, -1))
        )


def _moving_axial_forces(
    boom: Boom,
    full: BoomShell,
    coordinates: BoomCoordinates,
    group: TelescopingStations,
    behind: int,
) -> list[MovingAxialForce]:
    """Return the axial force that moves with a telescoping joint, if any. Collective.

    Its rows are zero for the ``behind`` coordinates of springs.
    """
    axial = moving_force(boom.segments, boom.joints, group.joints[0])
    if axial is None or len(group.joints) > 1:
        return []
    shell, lines = full.shells[axial.segment], np.zeros(0)
    if shell.mesh is not None:
        along = shell.mesh.points[shell.mesh.triangles, 0]
        around = lines_around(np.stack([along.min(axis=1), along.max(axis=1)], axis=1))
        # Mesh lines are rounded; nodes on them have the exact x.
        x = np.unique(along)
        lines = x[np.searchsorted(0.5 * (x[1:] + x[:-1]), around)]
    # Extensions at which the force passes mesh lines.
    extensions = np.sort(axial.direction * (full.comm.bcast(lines) - axial.x))
    (low, high), near = group.drives[0].reach, SAME_PLACE * boom.length
    extensions = extensions[(extensions > low - near) & (extensions < high + near)]
    rows = []
    for extension in extensions.tolist():
        outline = shell.outline(axial.x + axial.direction * extension)
        operators = [Operator({axial.segment: outline.mean_deflection(d)}) for d in boom.directions]
        rows.append([coordinates.row(operator) for operator in operators])
    beside = np.zeros((len(rows), len(boom.directions), behind))
    table = RowTable.spline(extensions, np.concatenate([np.array(rows), beside], axis=2))
    return [MovingAxialForce(axial.force, table)]


class PadResponses(NamedTuple):
    """Responses (num_columns, num_columns) of a full segment to pad forces."""

    compliance: Array  #: B (K + σ M)⁻¹ Bᵀ in m/N at the shift of springs
    inertia: Array  #: B (K + σ M)⁻¹ M (K + σ M)⁻¹ Bᵀ in m s²/N, the negative derivative by σ
    tested: Array  #: compliance in m/N at the shift for the test of springs


def pad_responses(symmetry: SymmetryReduction, columns: Array, test: float) -> PadResponses:
    """Return the responses to columns (num_owned, num_columns) of pads. Collective.

    ``test`` is the frequency in Hz of the shift for ``tested``.
    """

    def of_class(_: int, job: Job) -> Array:
        shell = job.shell(symmetry.cell)
        solve = ShiftedSolver(shell, SLOW)
        # Pads press on few nodes, so that columns are sparse.
        loaded_rows = np.flatnonzero((job.forces != 0.0).any(axis=1))
        forces = job.forces[loaded_rows]
        response = solve(job.forces)
        slow = forces.T @ response[loaded_rows], response.T @ times(shell.mass, response)
        solve.move(test)
        tested = forces.T @ solve(job.forces)[loaded_rows]
        solve.destroy()
        return np.array([*slow, tested])

    start = np.zeros((3, columns.shape[1], columns.shape[1]))
    return PadResponses(*symmetry.sum_classes(columns, start, of_class))


def springs(residual: Array, inertia: Array) -> tuple[Array, Array]:
    """Return springs that replace a residual compliance: ω² and rows.

    ω² (num_springs,) is in rad²/s², rows (num_extensions, num_rows, num_springs) are in 1/√kg.
    ``residual`` Γ (num_extensions, num_rows, num_rows) is in m/N, ``inertia`` Γ′ in m s²/N.
    """
    sizes = np.sqrt(np.einsum("wjj->j", residual) / len(residual))
    scale = np.outer(sizes, sizes)
    values, patterns = np.linalg.eigh(residual / scale)
    values[values < _NEGLIGIBLE * values.max()] = 0.0
    inverse = np.divide(1.0, np.sqrt(values), out=np.zeros_like(values), where=values > 0.0)
    root, back = (
        np.einsum("wij,wj,wkj->wik", patterns, factor, patterns)
        for factor in (np.sqrt(values), inverse)
    )
    slowness, turn = np.linalg.eigh((back @ (inertia / scale) @ back).mean(axis=0))
    # No residual mode is below the slowest frequency. Round-off may say so of a small compliance.
    slowest = squared(_SLOWEST) + squared(SLOW)
    shifted = 1.0 / np.clip(slowness, 1.0 / squared(_FASTEST), 1.0 / slowest)
    pulls = root @ turn
    kept = np.abs(pulls).max(axis=(0, 1)) > _NEGLIGIBLE
    rows = sizes[:, None] * pulls * np.sqrt(shifted)
    return (shifted - squared(SLOW))[kept], rows[..., kept]

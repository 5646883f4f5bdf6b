# SPDX-License-Identifier: LGPL-3.0-or-later
"""Shells of a boom that is drawn out: modes for all of the way, and springs that go with the pads.

A basis of what forces at every place of the way bend would be as long as the way. But segments have
few modes that pads feel anywhere, and what walls give way beyond these is springs
(:mod:`shell_model.reduction.pad_springs`). Rows and springs are read where pads pass the rings of
the mesh, and are splines between these, so that no ring is felt.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dynamics.drive.row_table import RowTable
from dynamics.drive.travel import KINDS, Travel
from dynamics.gap_system import GapSystem
from dynamics.reduction.condensation import fewer
from dynamics.reduction.residual import with_coordinates
from geometry.arrays import Array, Mask
from geometry.axial import borne
from geometry.boom import Boom
from shell_model.boom_shell import BoomShell
from shell_model.drive.moving_thrusts import moving_thrusts
from shell_model.drive.passage import Passage, passages
from shell_model.reduction.coordinates import BoomCoordinates, exact_product
from shell_model.reduction.pad_springs import SLOW, Answers, answers, springs, squared
from shell_model.reduction.segment import ReducedSegment

# Modes up to so many Hz are kept: the slow ones, and those that somewhere give way by more than a
# part of what springs take.
_CUTOFF, _SLOWEST, _PART = 1500.0, 100.0, 0.003

# Moments of what stays in its place, and of the reduction that finds the modes from forces at every
# so many places.
MOMENTS = 2
_EVERY = 4


class _Read(NamedTuple):
    """What is read of a segment.

    Args:
        columns: (num_owned, num_columns) of pads, along all ways.
        moving: (num_columns,) which of these read other places of it as it is drawn.
        staying: (num_columns,) one of all that read the same place.
        observed: (num_owned, num_observed).
    """

    columns: Array
    moving: Mask
    staying: Mask
    observed: Array


class DrawnShell:
    """The shell of a boom that is drawn out. Collective.

    Args:
        boom: its joints have drives.
        full: its shells.
        size: edge length of their meshes in m.
        reduce: of the position of a segment and (num_owned, num_columns) forces on it along the
            way, the segment in coordinates that answer these.
        test: Hz of the shift at which the answers of springs are measured.

    Attributes:
        reduced: the segments, without springs.
    """

    def __init__(
        self,
        boom: Boom,
        full: BoomShell,
        size: float,
        reduce: Callable[[int, Array], ReducedSegment],
        test: float,
    ) -> None:
        self._boom, self._full, self._test = boom, full, test
        self._passages = passages(boom, full, size)
        self.reduced: list[ReducedSegment] = []
        self._answers: list[Answers] = []
        for number in range(len(full.shells)):
            own = reduce(number, self._columns(number, _EVERY))
            read = self._read(number)
            self._answers.append(answers(full.foldings[number], read.columns, test))
            self.reduced.append(self._kept(number, own, read))
        # Springs are what forces move beyond modes of the unloaded boom.
        free = [replace(one, geometric=0.0 * one.geometric) for one in self.reduced]
        self._apart = BoomCoordinates(full.comm, full.shells, free, ())
        self._rows = [passage.rows(self._apart) for passage in self._passages]
        self._springs = [
            springs(*self._left(position, passage))
            for position, passage in enumerate(self._passages)
        ]

    def lost(self, contacts: int) -> Array:
        """(num_contacts,) the most by which each gives way wrongly on its way, in m/N."""
        sigma, found = squared(self._test), np.zeros(contacts)
        for position, passage in enumerate(self._passages):
            omega2, pulls = self._springs[position]
            parts = (self._rows[position], self._apart.omega2), (pulls, omega2)
            own = sum(rows**2 @ (1.0 / (of + sigma)) for rows, of in parts)
            whole = np.einsum("wjj->wj", self._answered(position, passage, "tested"))
            off = np.abs(whole - own).max(axis=0)
            for (kind, row), most in zip(passage.moving, off.tolist(), strict=True):
                if kind == "rows":
                    found[row] = most
        return found

    def with_springs(self, system: GapSystem, coordinates: BoomCoordinates) -> GapSystem:
        """A system in the coordinates of the boom, with its springs and what draws them along."""
        first_of, stacked = {}, 0
        for kind in KINDS:
            first_of[kind] = stacked
            stacked += len(getattr(system, kind))
        behind = np.cumsum([0, *(omega2.size for omega2, _ in self._springs)])
        pulled, travels = np.zeros((stacked, behind[-1])), []
        for k, (passage, (_, pulls)) in enumerate(zip(self._passages, self._springs, strict=True)):
            beside = np.zeros((*pulls.shape[:2], behind[-1]))
            beside[..., behind[k] : behind[k + 1]] = pulls
            at = [first_of[kind] + position for kind, position in passage.moving]
            pulled[at] = beside[passage.start]
            if passage.course is not None:
                rows = np.concatenate([coordinates.of_rows(self._rows[k]), beside], axis=2)
                histories = [drive.history for drive in passage.course.drives]
                table = RowTable.through(passage.ways, rows)
                thrusts = moving_thrusts(
                    self._boom, self._full, coordinates, passage.course, int(behind[-1])
                )
                along = passage.moving, passage.course.suffix, list(thrusts)
                boom, (joint, *_) = self._boom, passage.course.joints
                against = borne(boom.segments, boom.joints, joint)
                travels.append(Travel.of(histories, table, *along, against))
        omega2 = np.concatenate([omega2 for omega2, _ in self._springs])
        return replace(with_coordinates(system, omega2, pulled), travels=travels)

    def _columns(self, number: int, step: int = 1) -> Array:
        shell = self._full.shells[number]
        return np.hstack([passage.columns(shell, number, step) for passage in self._passages])

    def _read(self, number: int) -> _Read:
        columns = self._columns(number)
        parts = np.split(columns, np.cumsum([one.count for one in self._passages])[:-1], axis=1)
        told = [
            passage.told_apart(self._full.comm, part)
            for passage, part in zip(self._passages, parts, strict=True)
        ]
        moving, staying = (np.concatenate(which) for which in zip(*told, strict=True))
        seen = [one.reading for one in self._full.observed.values()]
        return _Read(columns, moving, staying, self._full.columns(number, seen))

    def _kept(self, number: int, own: ReducedSegment, read: _Read) -> ReducedSegment:
        """Modes that pads feel somewhere, and what else all that stays in its place bends."""
        rows, observed = (self._modal(own, some) for some in (read.columns, read.observed))
        parts = rows[read.moving] ** 2 / (own.omega2 + squared(SLOW))
        below = own.omega2 < squared(_CUTOFF)
        local = np.diag(self._answers[number].compliance)[read.moving]
        left = local - parts[:, below].sum(axis=1)
        slow = own.omega2 < squared(_SLOWEST)
        slow |= below & (parts > _PART * left[:, None]).any(axis=0)
        stays = self._full.pushed(number), self._full.columns(number, self._full.ties)
        pushes = [*(self._modal(own, some) for some in stays), observed, rows[read.staying]]
        modes = np.flatnonzero(slow), np.flatnonzero(~slow)
        omega2, shapes = fewer(own.omega2, np.vstack(pushes), *modes, MOMENTS)
        order = np.argsort(omega2, kind="stable")
        omega2, shapes = omega2[order], shapes[:, order]
        off = self._transfer_error((own.omega2, rows, observed), (omega2, shapes))
        return replace(
            own,
            omega2=omega2,
            shapes=own.shapes @ shapes,
            geometric=shapes.T @ own.geometric @ shapes,
            reading_error=max(own.reading_error, off),
        )

    def _transfer_error(self, many: tuple[Array, Array, Array], few: tuple[Array, Array]) -> float:
        """Of what pads move at the readings, relative to the geometric mean of both compliances.

        ``many`` are ω², rows of the pads and of the readings; ``few`` ω², and shapes in these.
        """
        omega2, rows, observed = many
        shifted, shapes = (1.0 / (one + squared(self._test)) for one in (omega2, few[0])), few[1]
        of_many, of_few = shifted
        missed = (observed * of_many) @ rows.T
        missed -= ((observed @ shapes) * of_few) @ (rows @ shapes).T
        sizes = (np.sqrt(one**2 @ of_many) for one in (observed, rows))
        scale = np.maximum(np.outer(*sizes), np.finfo(float).tiny)
        return float((np.abs(missed) / scale).max(initial=0.0))

    def _modal(self, own: ReducedSegment, columns: Array) -> Array:
        """(num_columns, num_modes) of a segment."""
        rows = [exact_product(self._full.comm, column, own.shapes) for column in columns.T]
        return np.array(rows).reshape(-1, own.omega2.size)

    def _left(self, position: int, passage: Passage) -> tuple[Array, Array]:
        """What modes leave of a passage's compliance, and of its inertia."""
        rows, shifted = self._rows[position], self._apart.omega2 + squared(SLOW)
        taken = [rows / shifted**power @ rows.swapaxes(1, 2) for power in (1, 2)]
        return (
            self._answered(position, passage, "compliance") - taken[0],
            self._answered(position, passage, "inertia") - taken[1],
        )

    def _answered(self, position: int, passage: Passage, what: str) -> Array:
        """(num_ways, num_moving, num_moving) of a passage in the full model, by all segments."""
        first = sum(one.count for one in self._passages[:position])
        own = slice(first, first + passage.count)
        whole = np.sum([getattr(one, what)[own, own] for one in self._answers], axis=0)
        blocks = whole.reshape(passage.ways.size, len(passage.moving), passage.ways.size, -1)
        return np.asarray(np.einsum("wiwj->wij", blocks))

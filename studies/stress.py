# SPDX-License-Identifier: LGPL-3.0-or-later
"""Accuracy of stresses: compared with a beam away from contacts, on finer meshes near contacts.

The inner segment of the paper's boom is in equilibrium under its load and contact forces, so that
its moments and contact forces are statically determinate.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from mpi4py import MPI

from protractile.geometry.boom import Boom
from protractile.geometry.contact_places import pads
from protractile.runs.case.build import build_boom
from protractile.shell_model.boom_shell import ShellOptions
from protractile.shell_model.contact.wall_rows import CornerLines
from protractile.shell_model.reduced_shell import reduce_boom
from protractile.shell_model.stress.fields import gather_stress_modes
from protractile.shell_model.stress.history import stress_near_places
from protractile.shell_model.stress.stresses import ShellStress
from studies.motions import friction_case, model_of
from studies.reference_models.shell_readings import wall_forces
from studies.reference_models.single_segment import at_rest, shell_alone
from studies.refined import Refined, refined_table
from studies.study import Criterion, Piece, Progress, Verification, define_study

INNER = 1

# Permitted relative errors of a stress: away from contacts, over a patch, and of
# the reduction.
BEAM, PATCH, REDUCED = 0.01, 0.05, 0.001

NOTE = (
    "The force enters along a length of the corner of a flange and a web. The stress of the "
    "nearest triangle grows as the mesh refines, and is no design stress. The mean over a patch of "
    "half a wall and 0.5 m settles."
)


class Sizes(NamedTuple):
    """Parameters of the study."""

    #: Edge lengths in m, each half the one before, three at least.
    meshes: Sequence[float] = (0.2, 0.1, 0.05, 0.025)
    default: float = 0.1  #: default edge length of a run
    places: Sequence[float] = (12.0, 14.0, 16.0)  #: x in m away from contacts


class InnerSegmentState(NamedTuple):
    """Static state of the inner segment under its load and contact forces."""

    boom: Boom  #: boom of the paper
    stress: ShellStress  #: stresses of the inner segment, which has the index 0 there

    @classmethod
    def on_mesh(cls, boom: Boom, size: float) -> InnerSegmentState:
        """Create the state from a static solution of the full shell, on a mesh of a size in m."""
        segment = boom.segments[INNER]
        shell = shell_alone(segment, size, boom.stations_of(INNER))
        force = segment.load * shell.unit_loads["z"]
        corners = CornerLines(shell)
        pressed = {pad.station.x: pad.intervals[0] for pad in pads(boom)}
        for x, (side, strength) in contact_forces(boom).items():
            row = corners.deflection(pressed[x], "z", 0.0, side)
            force -= side * strength * shell.row(row)
        modes = gather_stress_modes(shell, at_rest(shell, force[:, None]))
        assert modes is not None
        assert shell.mesh is not None
        return cls(boom, ShellStress.at_rest(shell.mesh, modes))

    @classmethod
    def reduced(cls, boom: Boom, size: float) -> InnerSegmentState:
        """Create the same state from the reduced coordinates of a run, for a mesh size in m."""
        shell = reduce_boom(boom, ShellOptions(size), MPI.COMM_SELF)
        system, fields = shell.system, shell.fields
        assert fields is not None
        needed = contact_forces(boom)
        force = system.load.copy()
        for row, law, station in zip(system.rows, system.laws, system.station_of_row, strict=True):
            side, strength = needed[system.stations[station]]
            if side == law.terms[0].side:
                force -= side * strength * row
        elastic = system.omega2 > 0.0
        state = np.divide(force, system.omega2, out=np.zeros_like(force), where=elastic)
        own = fields[f"coordinates_{INNER + 1}"].values @ state
        modes = np.tensordot(own, fields[f"stress_{INNER + 1}"].values, axes=1)[None]
        return cls(boom, ShellStress.at_rest(shell.meshes[INNER], modes.astype(np.float32)))

    def top(self, x: float) -> tuple[float, float]:
        """Return the mean σ_x over the width of the top flange in Pa, and the value of a beam.

        The beam has σ = M z / J, with the mean of M over the row of elements that contains x.
        """
        segment = self.boom.segments[INNER]
        assert segment.section is not None
        row = self.stress.row(0, x)
        row = row[self.stress.wall[row] == self.stress.plates[0].index("top")]
        found = np.average(self.stress.at(0.0).membrane[row, 0], weights=self.stress.areas[row])
        begin, end = self.stress.spans[row, 0].min(), self.stress.spans[row, 1].max()
        arms = segment.end - np.array([begin, end])
        moment = -segment.load * (arms**3).dot([1.0, -1.0]) / (6.0 * (end - begin))
        section = segment.section
        return float(found), moment * 0.5 * section.size("z") / section.second_moment_of_area

    def shear(self, x: float) -> tuple[float, float]:
        """Return the shear force of the webs in N at x, and the shear force from equilibrium."""
        segment = self.boom.segments[INNER]
        forces = wall_forces(self.stress, 0.0, 0, x)
        row = self.stress.row(0, x)
        middle = 0.5 * (self.stress.spans[row, 0].min() + self.stress.spans[row, 1].max())
        found = forces["left"].shear + forces["right"].shear
        return found, segment.load * (segment.end - middle)

    def near(self, x: float) -> tuple[float, float]:
        """Return the largest von Mises stress of a triangle and of a patch near x, in Pa."""
        found = stress_near_places(self.stress, [x], [self.boom.segments[INNER].name]).isel(time=0)
        return float(found["von_mises"].item()), float(found["von_mises_patch"].item())


def contact_forces(boom: Boom) -> dict[float, tuple[int, float]]:
    """Return side and magnitude in N of the contact forces on the inner segment, by x in m.

    They follow from equilibrium. Under the upward load the inner segment presses upwards at the
    head of the outer segment, and downwards at its own tail.
    """
    segment, (tail, head) = boom.segments[INNER], boom.joints[0].stations
    lift = segment.load * segment.length
    lever = 0.5 * (segment.start + segment.end) - tail
    at_head = lift * lever / (head - tail)
    return {tail: (-1, at_head - lift), head: (1, at_head)}


def stresses(
    pressed: Sequence[InnerSegmentState], sizes: Sizes
) -> dict[tuple[float, str], Refined]:
    """Return x of each contact, and the largest stress of a triangle or a patch near it in Pa."""
    return {
        (x, what): Refined(
            f"largest {what} at {x:g} m",
            "MPa",
            sizes.meshes,
            [one.near(x)[place] / 1.0e6 for one in pressed],
        )
        for x in pressed[0].boom.joints[0].stations
        for place, what in enumerate(("triangle", "patch"))
    }


def verifications(
    default: InnerSegmentState,
    reduced: InnerSegmentState,
    near: Mapping[tuple[float, str], Refined],
    sizes: Sizes,
) -> Iterator[Verification]:
    """Compare the default mesh with a beam, with equilibrium and with the limit of refinement.

    The reduced shell is compared with the full shell.
    """
    mesh, finest = (f"mesh of {size:g} m" for size in (sizes.default, sizes.meshes[-1]))
    for x in sizes.places:
        value, reference = (stress / 1.0e6 for stress in default.top(x))
        what = f"stress of the top at {x:g} m, {mesh}"
        yield Verification(what, value, reference, "MPa", "analytic", "σ = M z / J", BEAM)
    what = f"shear force of the webs at {sizes.places[0]:g} m, {mesh}"
    yield Verification(what, *default.shear(sizes.places[0]), "N", "analytic", "equilibrium", BEAM)
    unreduced: Criterion = ("other code", "the unreduced shell, of the same mesh", REDUCED)
    for x in default.boom.joints[0].stations:
        at = f"at the contact at {x:g} m"
        what = f"von Mises stress of a patch {at}, {mesh}"
        yield near[x, "patch"].against_limit(what, sizes.default, finest, PATCH)
        what = f"largest von Mises stress of a triangle {at}, reduced"
        reference = near[x, "triangle"].values[sizes.meshes.index(sizes.default)]
        yield Verification(what, reduced.near(x)[0] / 1.0e6, reference, "MPa", *unreduced)


@define_study("stress", "Stresses of the inner segment between its contacts")
def study(progress: Progress, sizes: Sizes | None = None) -> Iterator[Piece]:
    """Compare stresses of the inner segment of the paper's boom on successively finer meshes."""
    sizes = sizes or Sizes()
    case = friction_case()
    boom = build_boom(case)
    pressed = []
    for size in sizes.meshes:
        progress(f"mesh of {size:g} m")
        pressed.append(InnerSegmentState.on_mesh(boom, size))
    progress(f"mesh of {sizes.default:g} m, reduced")
    seen = model_of(case, "shell").model_boom(boom).boom
    reduced = InnerSegmentState.reduced(seen, sizes.default)
    near = stresses(pressed, sizes)
    title = "Von Mises stress where the inner segment is pressed"
    yield refined_table("stress", title, list(near.values()), "{:g} m", (NOTE,))
    yield from verifications(pressed[sizes.meshes.index(sizes.default)], reduced, near, sizes)

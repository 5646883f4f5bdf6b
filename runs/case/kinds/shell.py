# SPDX-License-Identifier: LGPL-3.0-or-later
"""Keys of shell models. FEniCSx is imported only when a model is built."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import numpy as np

from protractile.beam_model.component import SegmentModel
from protractile.beam_model.finite_element import finite_element_segments
from protractile.dynamics.line import Line
from protractile.geometry.boom import Boom, BoomError
from protractile.geometry.fields import In, Length, Positive
from protractile.geometry.refinement import refinement_zones
from protractile.runs.case.kinds.model import (
    BeamTable,
    BuildContext,
    BuiltModel,
    ModelBoom,
    ModelTable,
    Surrogate,
)
from protractile.runs.case.limits import ContactTolerance, Count, Modes, Part

if TYPE_CHECKING:
    from protractile.shell_model.boom_shell import ShellOptions

# Maximum number of triangles: a finer mesh is an input error.
MOST_TRIANGLES = 20_000_000
# Maximum number of contact points on half a wall: each costs time in reduction and time loop.
MOST_POINTS = 256

# Typical number of coordinates of each reduced segment, of planar and of 3-D booms.
_FLAT, _SPATIAL = 60, 210
# Measured costs. Number of dofs per area / (mesh size)²: of a uniform mesh, and of a graded mesh
# outside and inside refinement zones. Bytes per dof, and per dof and coordinate; s per dof.
_DOFS, _GRADED_DOFS, _DOFS_AT_ZONES = 21.0, 42.0, 35.0
_OF_DOF, _OF_DOF_AND_COORDINATE, _REDUCTION = 2000.0, 5.0, 0.45e-4
# A single process reduces a shell of fewer dofs in a few seconds.
_SMALL = 5.0e4
# Number of elements of the longest segment in the surrogate of a shell.
_ELEMENTS = 20


class _ShellSurrogate(BeamTable):
    """Shear-flexible beam elements that replace a shell in estimates of its cost."""

    kind: Literal["beam of a shell"] = "beam of a shell"
    """the kind of model"""
    element_length: Length
    """the greatest length of an element in m"""

    def describe(self) -> str:
        return self.kind

    def segments(self, boom: Boom) -> list[SegmentModel]:
        return finite_element_segments(boom, self.element_length, "timoshenko", True)

    def surrogate(self, boom: Boom) -> Surrogate:
        return Surrogate(self, 0)


class Shell(ModelTable, init=False):
    """Flat shell elements on the walls of the segments, reduced to fewer coordinates."""

    meshed: ClassVar[bool] = True

    kind: Literal["shell"]
    """the kind of model"""
    mesh_size: Length = 0.1
    """the edge length of the triangles in m, outside contacts and loads"""
    contact_tolerance: ContactTolerance = 0.02
    """the permitted relative error of the local compliance of walls, for which the mesh is refined
    at contacts, or 'any' for a uniform mesh"""
    modes: Modes = "auto"
    """the greatest number of coordinates of each segment, or 'auto' for what the tolerance needs"""
    tolerance: Part = 5.0e-4
    """with modes = 'auto', the largest relative error of the reduced shell's response to contact
    forces and loads; telescoping shells and contact over a surface do not use it"""
    contact_line: Literal["near webs", "across", "surface"] = "near webs"
    """where the walls may touch: at the stations near the webs, at the stations across the flanges,
    or over the surface of the whole overlap"""
    surface_stiffness: Annotated[Positive, In("N/m^(n+2)")] | None = None
    """the contact stiffness of a surface per area in N/m^(n+2), on the stiffer side; unless given,
    the sum of the joint's stations over the area"""
    surface_points: tuple[Count, Count] | None = None
    """the number of contact points along the overlap, and across each half of a wall; 8 and 4
    unless given"""

    def check(self, where: str, model_boom: ModelBoom) -> None:
        super().check(where, model_boom)
        check_mesh_size(f"{where}.mesh_size", self.mesh_size, model_boom.boom)
        self._check_contact(where, model_boom)
        for number, segment in enumerate(model_boom.boom.segments, start=1):
            if segment.viscous_damping > 0.0:
                raise BoomError(
                    f"segment[{number}].viscous_damping",
                    f"the shell {self.name!r} has none; leave it out, or run beams alone",
                )

    @property
    def cannot_telescope(self) -> str | None:
        if self.contact_line == "surface":
            return (
                f"the shell {self.name!r} touches over the whole overlap, which changes as it "
                "telescopes; leave contact_line out"
            )
        if self.modes != "auto":
            return (
                f"the shell {self.name!r} needs its own number of coordinates for all extensions; "
                "leave modes out"
            )
        return super().cannot_telescope

    def describe(self) -> str:
        places = {
            "near webs": "at pads (without pads: lines near webs)",
            "across": "on lines across flanges",
        }
        line = places.get(self.contact_line, "over the surface of the overlap")
        return f"mesh {self.mesh_size:g} m, contact {line}"

    def build(self, model_boom: ModelBoom, context: BuildContext | None = None) -> BuiltModel:
        from protractile.runs.folder.cache import load_or_compute
        from protractile.shell_model.reduced_shell import reduce_boom
        from protractile.shell_model.standard import with_plays_and_loads

        assert context is not None
        boom, options = self.content(model_boom.boom)
        # A small shell does not repay the seconds that a second process takes to load FEniCSx.
        helper = context.helper if self.estimate_dofs(boom) > _SMALL else None
        compute = partial(reduce_boom, boom, options, context.comm, context.progress, helper)
        standard_shell = load_or_compute(context.cache, (boom, options), context.comm, compute)
        shell = with_plays_and_loads(standard_shell, model_boom.boom)
        factor = shell.critical_factor
        if (boom.telescopes or model_boom.boom.axial_changes) and factor is not None:
            # The reduced shell gives the factor at t = 0, the beam over the whole motion.
            beam_factor = self.critical_factor(model_boom)
            factor = min(factor, beam_factor or factor)
        return BuiltModel(shell.system, shell.num_dofs, shell.seconds, factor, shell)

    def content(self, boom: Boom) -> tuple[Boom, ShellOptions]:
        """Return all inputs of the reduced shell: a standard boom, and options."""
        from protractile.shell_model.standard import standard_boom

        return standard_boom(boom), self.options()

    def options(self) -> ShellOptions:
        """Return the options of mesh, contact and reduction."""
        from protractile.shell_model.boom_shell import ShellOptions
        from protractile.shell_model.contact.surface import POINTS, SurfaceOptions
        from protractile.shell_model.reduction.krylov import KrylovOptions

        if self.modes == "auto":
            krylov = KrylovOptions(tolerance=self.tolerance)
        else:
            krylov = KrylovOptions(most=self.modes)
        return ShellOptions(
            mesh_size=self.mesh_size,
            contact_line=self.contact_line,
            surface=SurfaceOptions(self.surface_points or POINTS, self.surface_stiffness),
            krylov=krylov,
            contact_tolerance=None if self.contact_tolerance == "any" else self.contact_tolerance,
        )

    def lines(self, boom: Boom, built: BuiltModel) -> list[Line]:
        from protractile.shell_model.stress.lines import lines

        assert built.shell is not None
        assert built.shell.fields is not None
        return lines(built.shell.fields, boom)

    def critical_factor(self, model_boom: ModelBoom) -> float | None:
        from protractile.beam_model.static_model import estimate_critical_factor

        return estimate_critical_factor(model_boom.boom)

    def surrogate(self, boom: Boom) -> Surrogate:
        dofs = self.estimate_dofs(boom)
        coordinates = (_SPATIAL if boom.spatial else _FLAT) * len(boom.segments)
        if isinstance(self.modes, int):
            coordinates = min(coordinates, self.modes * len(boom.segments))
        beam = _ShellSurrogate(
            name=self.name,
            contact=self.contact,
            step=self.step,
            element_length=max(segment.length for segment in boom.segments) / _ELEMENTS,
        )
        memory = dofs * (_OF_DOF + _OF_DOF_AND_COORDINATE * coordinates)
        return Surrogate(beam, coordinates, memory, _REDUCTION * dofs)

    def estimate_dofs(self, boom: Boom) -> float:
        """Return the approximate number of degrees of freedom, without meshing."""
        squares = _surface(boom) / self.mesh_size**2
        if self.contact_tolerance == "any" or self.contact_line == "surface":
            return _DOFS * squares
        graded = self.contact_tolerance, self.contact_line
        return _GRADED_DOFS * squares + _DOFS_AT_ZONES * sum(
            (1 << len(segment.mirrors)) * zone.num_squares(self.mesh_size)
            for number, segment in enumerate(boom.segments)
            if segment.section is not None
            for zone in refinement_zones(boom, number, *graded)
        )

    def _check_contact(self, where: str, model_boom: ModelBoom) -> None:
        """Check that the contact line suits the boom, and that all keys apply to this line."""
        line = self.contact_line
        if model_boom.boom.spatial and line == "across":
            raise BoomError(
                f"{where}.contact_line",
                "'across' is for a flat boom; in space the segments touch 'near webs' or by "
                "'surface'",
            )
        for number, joint in enumerate(model_boom.boom.joints, start=1):
            if joint.padded and line != "near webs":
                raise BoomError(
                    f"{where}.contact_line",
                    f"{line!r} leaves no place to the pads of joint[{number}]; give 'near webs', "
                    "or leave pad out",
                )
        if line == "surface":
            self._check_surface(where, model_boom)
            return
        for key in ("surface_stiffness", "surface_points"):
            if getattr(self, key) is not None:
                raise BoomError(
                    f"{where}.{key}",
                    f"the segments touch at their stations, {line!r}; leave it out, or give "
                    "contact_line = 'surface'",
                )

    def _check_surface(self, where: str, model_boom: ModelBoom) -> None:
        """Check the number of contact points, and that all laws admit one surface stiffness."""
        if self.surface_points is not None:
            along, across = self.surface_points
            if along * across > MOST_POINTS:
                raise BoomError(
                    f"{where}.surface_points",
                    f"{along} times {across} points on half a wall are more than {MOST_POINTS}, "
                    "which a reduced model can bear; give fewer",
                )
        boom = model_boom.boom
        laws = [joint.law(along) for along in boom.directions for joint in boom.joints]
        exponents = sorted({term.exponent for law in laws for term in law.terms})
        if self.surface_stiffness is not None and len(exponents) > 1:
            raise BoomError(
                f"{where}.surface_stiffness",
                f"its unit depends on the exponent, and the joints have {exponents[0]:g} and "
                f"{exponents[-1]:g}; leave it out, or give the model its own contact",
            )
        sides = [[term.side for term in law.terms] for law in laws]
        if self.surface_stiffness is not None and any(len({*s}) < len(s) for s in sides):
            raise BoomError(
                f"{where}.surface_stiffness",
                "is one number, and a force_table has as many as lines; leave it out, or give the "
                "model its own contact",
            )


def check_mesh_size(where: str, size: float, boom: Boom) -> None:
    """Check that a mesh of triangles of a size in m is not too fine.

    Raises:
        BoomError: the mesh would have too many triangles.
    """
    smallest = float(np.sqrt(2.0 * _surface(boom) / MOST_TRIANGLES))
    if size < smallest:
        raise BoomError(
            where,
            f"{size:g} m makes more than {MOST_TRIANGLES:.0e} triangles; it must be at least "
            f"{smallest:.3g} m",
        )


def _surface(boom: Boom) -> float:
    """Return the area of all walls in m²."""
    return sum(
        segment.section.perimeter * segment.length
        for segment in boom.segments
        if segment.section is not None
    )

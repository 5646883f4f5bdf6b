# SPDX-License-Identifier: LGPL-3.0-or-later
"""The public names, imported when they are used: ``import protractile as pt``.

Examples in their docstrings have numpy as ``np``, ``dataclasses.replace``, the ``ball`` of
``GapSystem`` and the ``boom`` of ``Boom`` at hand.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from beam_model.segment_model import tied_system as tied_system
    from beam_model.systems import finite_element_system as finite_element_system
    from beam_model.systems import kantorovich_system as kantorovich_system
    from dynamics.contact import ContactLaw as ContactLaw
    from dynamics.contact import PowerContact as PowerContact
    from dynamics.contact import restitution_damping as restitution_damping
    from dynamics.contact_table import TableContact as TableContact
    from dynamics.contact_term import Term as Term
    from dynamics.damping import with_ratio as with_ratio
    from dynamics.drive.moving_thrust import MovingThrust as MovingThrust
    from dynamics.drive.row_table import RowTable as RowTable
    from dynamics.drive.stick_slip import Pulled as Pulled
    from dynamics.drive.travel import SCurve as SCurve
    from dynamics.drive.travel import Stroke as Stroke
    from dynamics.drive.travel import Travel as Travel
    from dynamics.energy import ENERGIES as ENERGIES
    from dynamics.equilibrium import equilibrium as equilibrium
    from dynamics.excitation import Excitation as Excitation
    from dynamics.excitation import History as History
    from dynamics.excitation import Ramp as Ramp
    from dynamics.excitation import Sine as Sine
    from dynamics.excitation import Step as Step
    from dynamics.excitation import Table as Table
    from dynamics.failure import NumericsError as NumericsError
    from dynamics.friction import DryFriction as DryFriction
    from dynamics.gap_system import GapSystem as GapSystem
    from dynamics.gap_system import Observer as Observer
    from dynamics.integrator import AdaptiveStep as AdaptiveStep
    from dynamics.integrator import FixedStep as FixedStep
    from dynamics.integrator import Integrator as Integrator
    from dynamics.integrator import simulate as simulate
    from dynamics.motion import Motion as Motion
    from dynamics.predictability.ensemble import integrate_ensemble as integrate_ensemble
    from dynamics.predictability.horizon import measure_horizons as measure_horizons
    from dynamics.sided_contact import SidedContact as SidedContact
    from dynamics.trajectory import Trajectory as Trajectory
    from geometry.axial import Thrust as Thrust
    from geometry.axial import with_compression as with_compression
    from geometry.boom import Boom as Boom
    from geometry.boom import BoomError as BoomError
    from geometry.boom import Cylinder as Cylinder
    from geometry.boom import Joint as Joint
    from geometry.boom import Load as Load
    from geometry.boom import PadSize as PadSize
    from geometry.boom import SlidePad as SlidePad
    from geometry.boom import Stop as Stop
    from geometry.compression import Compression as Compression
    from geometry.drive import Drive as Drive
    from geometry.observation import Observation as Observation
    from geometry.polygon import PolygonSection as PolygonSection
    from geometry.polygon import closed_polygon as closed_polygon
    from geometry.profiles import hexagon as hexagon
    from geometry.profiles import octagon as octagon
    from geometry.profiles import u_section as u_section
    from geometry.section import BoxSection as BoxSection
    from geometry.section import Section as Section
    from geometry.segment import Collar as Collar
    from geometry.segment import Diaphragm as Diaphragm
    from geometry.segment import Lateral as Lateral
    from geometry.segment import Material as Material
    from geometry.segment import PointMass as PointMass
    from geometry.segment import Segment as Segment
    from geometry.shear_flow import shear_centre as shear_centre
    from geometry.support import Support as Support
    from protractile.cases import change as change
    from protractile.cases import load_case as load_case
    from protractile.cases import run_case as run_case
    from runs import CASES as CASES
    from runs.case.messages import BadInput as BadInput
    from runs.case.schema import Case as Case
    from runs.pipeline.results import Results as Results
    from shell_model.boom_shell import ShellOptions as ShellOptions
    from shell_model.reduced_shell import ReducedShell as ReducedShell
    from shell_model.reduced_shell import reduce_boom as reduce_boom

# Where each name is at home.
_HOMES = {
    name: module
    for module, names in {
        "beam_model.segment_model": "tied_system",
        "beam_model.systems": "finite_element_system kantorovich_system",
        "dynamics.contact": "ContactLaw PowerContact restitution_damping",
        "dynamics.contact_term": "Term",
        "dynamics.contact_table": "TableContact",
        "dynamics.sided_contact": "SidedContact",
        "dynamics.damping": "with_ratio",
        "dynamics.energy": "ENERGIES",
        "dynamics.equilibrium": "equilibrium",
        "dynamics.excitation": "Excitation History Ramp Sine Step Table",
        "dynamics.failure": "NumericsError",
        "dynamics.friction": "DryFriction",
        "dynamics.gap_system": "GapSystem Observer",
        "dynamics.integrator": "AdaptiveStep FixedStep Integrator simulate",
        "dynamics.motion": "Motion",
        "dynamics.drive.moving_thrust": "MovingThrust",
        "dynamics.predictability.ensemble": "integrate_ensemble",
        "dynamics.predictability.horizon": "measure_horizons",
        "dynamics.drive.row_table": "RowTable",
        "dynamics.drive.stick_slip": "Pulled",
        "dynamics.trajectory": "Trajectory",
        "dynamics.drive.travel": "SCurve Stroke Travel",
        "geometry.axial": "Thrust with_compression",
        "geometry.boom": "Boom BoomError Cylinder Joint Load PadSize SlidePad Stop",
        "geometry.compression": "Compression",
        "geometry.drive": "Drive",
        "geometry.observation": "Observation",
        "geometry.polygon": "PolygonSection closed_polygon",
        "geometry.profiles": "hexagon octagon u_section",
        "geometry.section": "BoxSection Section",
        "geometry.segment": "Collar Diaphragm Lateral Material PointMass Segment",
        "geometry.support": "Support",
        "geometry.shear_flow": "shear_centre",
        "protractile.cases": "change load_case run_case",
        "runs": "CASES",
        "runs.case.messages": "BadInput",
        "runs.case.schema": "Case",
        "runs.pipeline.results": "Results",
        "shell_model.boom_shell": "ShellOptions",
        "shell_model.reduced_shell": "ReducedShell reduce_boom",
    }.items()
    for name in names.split()
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = globals()[name] = getattr(import_module(_HOMES[name]), name)
    return value


def __dir__() -> list[str]:
    return sorted(_HOMES)

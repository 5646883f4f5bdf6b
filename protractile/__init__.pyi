# SPDX-License-Identifier: LGPL-3.0-or-later
# ruff: isort: skip_file

# What a boom is made of
from protractile.geometry.boom import Boom as Boom
from protractile.geometry.cylinder import Cylinder as Cylinder
from protractile.geometry.cylinder import EarthPoint as EarthPoint
from protractile.geometry.place import Distance as Distance
from protractile.geometry.place import Level as Level
from protractile.geometry.joint import Drive as Drive
from protractile.geometry.joint import Joint as Joint
from protractile.geometry.joint import Pad as Pad
from protractile.geometry.joint import SlidePad as SlidePad
from protractile.geometry.joint import Stop as Stop
from protractile.geometry.observation import Observation as Observation
from protractile.geometry.stiffeners import Collar as Collar
from protractile.geometry.stiffeners import Diaphragm as Diaphragm
from protractile.geometry.material import Material as Material
from protractile.geometry.segment import PointMass as PointMass
from protractile.geometry.segment import Segment as Segment
from protractile.geometry.support import Pin as Pin
from protractile.geometry.support import Support as Support

# Sections
from protractile.geometry.polygon import PolygonSection as PolygonSection
from protractile.geometry.polygon import bent as bent
from protractile.geometry.polygon import closed_polygon as closed_polygon
from protractile.geometry.profiles import hexagon as hexagon
from protractile.geometry.profiles import octagon as octagon
from protractile.geometry.profiles import u_section as u_section
from protractile.geometry.box import BoxSection as BoxSection

# Contact laws
from protractile.dynamics.contact import ContactLaw as ContactLaw
from protractile.dynamics.contact import PowerContact as PowerContact
from protractile.dynamics.contact import restitution_damping as restitution_damping
from protractile.dynamics.contact_table import TableContact as TableContact

# Loads, and how they change over time
from protractile.dynamics.motion_laws import SCurve as SCurve
from protractile.dynamics.motion_laws import Shaped as Shaped
from protractile.dynamics.motion_laws import Stroke as Stroke
from protractile.dynamics.excitation import Ramp as Ramp
from protractile.dynamics.excitation import Sine as Sine
from protractile.dynamics.excitation import Step as Step
from protractile.dynamics.excitation import PiecewiseLinear as PiecewiseLinear
from protractile.geometry.axial import Lead as Lead
from protractile.geometry.axial import Thrust as Thrust
from protractile.geometry.chassis import Chassis as Chassis
from protractile.geometry.chassis import CraneForce as CraneForce
from protractile.geometry.head import Head as Head
from protractile.geometry.load import Load as Load
from protractile.geometry.load import Moment as Moment
from protractile.geometry.load import PartialLoad as PartialLoad
from protractile.geometry.load import Torque as Torque
from protractile.geometry.wind import wind_direction as wind_direction
from protractile.geometry.wind import wind_loads as wind_loads
from protractile.runs.case.actions import with_weight as with_weight

# Models, and how they move
from protractile.dynamics.trajectory import Trajectory as Trajectory
from protractile.runs.case.kinds.finite_element import BeamElements as BeamElements
from protractile.runs.case.kinds.kantorovich import Kantorovich as Kantorovich
from protractile.runs.case.kinds.kantorovich import Rigid as Rigid
from protractile.runs.case.kinds.shell import Shell as Shell

# Results of a boom
from protractile.analysis.beams import modes as modes
from protractile.analysis.beams import prove as prove
from protractile.analysis.beams import statics as statics
from protractile.analysis.curves import Curves as Curves
from protractile.analysis.proofs import Resistance as Resistance
from protractile.analysis.rows import Rows as Rows

# Case files, and what their runs leave
from protractile.cases import change as change
from protractile.cases import check as check
from protractile.cases import frequencies as frequencies
from protractile.cases import load_case as load_case
from protractile.cases import report as report
from protractile.cases import run_case as run_case
from protractile.cases import sweep as sweep
from protractile.cases import tables as tables
from protractile.runs import CASES as CASES
from protractile.runs.chart.run import chart as chart
from protractile.runs.case.schema import Case as Case
from protractile.runs.pipeline.results import Results as Results

# Cases with measured channels
from protractile.runs.measured.compare import Comparison as Comparison
from protractile.runs.measured.compare import compare as compare
from protractile.runs.measured.identify import Identification as Identification
from protractile.runs.measured.identify import identify as identify

# Errors
from protractile.dynamics.failure import NumericsError as NumericsError
from protractile.geometry.fields import BoomError as BoomError
from protractile.runs.process.bad_input import BadInput as BadInput

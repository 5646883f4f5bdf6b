# SPDX-License-Identifier: LGPL-3.0-or-later
# ruff: isort: skip_file

# What a boom is made of
from geometry.boom import Boom as Boom
from geometry.cylinder import Cylinder as Cylinder
from geometry.fields import Distance as Distance
from geometry.joint import Drive as Drive
from geometry.joint import Joint as Joint
from geometry.joint import PadSize as PadSize
from geometry.joint import SlidePad as SlidePad
from geometry.joint import Stop as Stop
from geometry.observation import Observation as Observation
from geometry.stiffeners import Collar as Collar
from geometry.stiffeners import Diaphragm as Diaphragm
from geometry.material import Material as Material
from geometry.segment import PointMass as PointMass
from geometry.segment import Segment as Segment
from geometry.support import Pin as Pin
from geometry.support import Support as Support

# Sections
from geometry.polygon import PolygonSection as PolygonSection
from geometry.polygon import closed_polygon as closed_polygon
from geometry.profiles import hexagon as hexagon
from geometry.profiles import octagon as octagon
from geometry.profiles import u_section as u_section
from geometry.section import BoxSection as BoxSection

# Contact laws
from dynamics.contact import ContactLaw as ContactLaw
from dynamics.contact import PowerContact as PowerContact
from dynamics.contact import restitution_damping as restitution_damping
from dynamics.contact_table import TableContact as TableContact

# Loads, and how they change over time
from dynamics.excitation import SCurve as SCurve
from dynamics.excitation import Shaped as Shaped
from dynamics.excitation import Stroke as Stroke
from dynamics.excitation import Ramp as Ramp
from dynamics.excitation import Sine as Sine
from dynamics.excitation import Step as Step
from dynamics.excitation import PiecewiseLinear as PiecewiseLinear
from geometry.axial import Thrust as Thrust
from geometry.load import Load as Load
from geometry.load import Moment as Moment
from geometry.load import PartialLoad as PartialLoad
from runs.case.actions import with_weight as with_weight

# Models, and how they move
from dynamics.trajectory import Trajectory as Trajectory
from runs.case.kinds.finite_element import BeamElements as BeamElements
from runs.case.kinds.kantorovich import Kantorovich as Kantorovich
from runs.case.kinds.kantorovich import Rigid as Rigid
from runs.case.kinds.shell import Shell as Shell

# Case files, and what their runs leave
from protractile.cases import change as change
from protractile.cases import check as check
from protractile.cases import frequencies as frequencies
from protractile.cases import load_case as load_case
from protractile.cases import report as report
from protractile.cases import run_case as run_case
from protractile.cases import sweep as sweep
from protractile.cases import tables as tables
from runs import CASES as CASES
from runs.case.schema import Case as Case
from runs.pipeline.results import Results as Results

# Errors
from dynamics.failure import NumericsError as NumericsError
from geometry.fields import BoomError as BoomError
from runs.case.messages import BadInput as BadInput

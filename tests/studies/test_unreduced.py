# SPDX-License-Identifier: LGPL-3.0-or-later
"""Motion of the unreduced shell, timing of runs, and the benchmark of solvers."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy.sparse
from scipy.linalg import eigh

pytest.importorskip("dolfinx", reason="the study needs DOLFINx")

from mpi4py import MPI
from petsc4py import PETSc

from protractile.dynamics.contact import DryFriction, PowerContact
from protractile.dynamics.energy import energy_residual
from protractile.dynamics.gap_builder import GapBuilder, OutputOperator
from protractile.dynamics.integrator import FixedStep
from protractile.dynamics.motion import Motion
from protractile.geometry.arrays import Array
from protractile.geometry.boom import Boom, BoomError, Cylinder, Stop
from protractile.geometry.typography import repeated
from protractile.shell_model.boom_shell import BoomShell, ShellOptions, assemble_boom
from protractile.shell_model.contact.rows import ShellContacts
from protractile.shell_model.reduction.krylov import KrylovOptions
from protractile.shell_model.segment.cross_section import Operator
from protractile.shell_model.segment.segment_shell import SegmentShell
from studies.cost import other_programs
from studies.cost.bench import five_terms
from studies.cost.generic_solvers import array_rates, compiled_rates, generic
from studies.reference_models.resisting_rows import ResistingRows
from studies.reference_models.unreduced import DirectMotion, integrate_directly
from tests.other_codes import INSTALLED
from tests.runs.case_texts import shipped
from tests.shell_model.booms import (
    HELD,
    LAW,
    boom_in_space,
    flat_boom,
    reduce_quickly,
    three_segments,
)
from tests.shell_model.conftest import box_shell
from tests.touching import touching

_SOFT = replace(LAW.law, stiffness=1.0e9, exponent=1.0).with_clearance(LAW.above)


def _dense(matrix: PETSc.Mat) -> Array:
    indptr, indices, values = matrix.getValuesCSR()
    return scipy.sparse.csr_matrix((values, indices, indptr)).toarray()


class _Loaded:
    """A short box on supports, under a load that excites a few natural modes or all."""

    def __init__(self, shell: SegmentShell) -> None:
        load = 80.0 * shell.unit_loads["z"]
        tip = shell.outline(3.0).mean_deflection()
        free = np.ix_(shell.free, shell.free)
        mass = _dense(shell.mass)[free]
        omega2, shapes = eigh(_dense(shell.stiffness)[free], mass)
        # Without the slide along x, which nothing pushes.
        omega2, shapes = omega2[1:], shapes[:, 1:]
        pushes = load[shell.free] @ shapes
        gains = (shell.row(tip)[shell.free] @ shapes) * pushes / omega2
        few = np.argsort(-np.abs(gains))[:4]
        narrow = np.zeros(shell.free.size)
        narrow[shell.free] = mass @ shapes[:, few] @ pushes[few]
        self._omega, self._gains = np.sqrt(omega2[few]), gains[few]
        self.rest = float(gains.sum())
        self.period = 2.0 * np.pi / float(self._omega.max())
        observed = {"tip": OutputOperator(Operator({0: tip}))}
        touching = ShellContacts(Boom((shell.segment,), ()), "near webs", [], [], [])
        self.few, self.all = (
            BoomShell(MPI.COMM_WORLD, [shell], touching, GapBuilder(), [], [push], [], observed)
            for push in (narrow, load)
        )

    def tip(self, time: Array) -> Array:
        """Return the tip deflection (num_times,) of the few modes in m."""
        return np.asarray((1.0 - np.cos(np.outer(time, self._omega))) @ self._gains)


@pytest.fixture(scope="module")
def loaded() -> _Loaded:
    return _Loaded(box_shell(1.0, 3.0, HELD))


@cache
def _full(boom: Boom) -> BoomShell:
    return assemble_boom(touching(boom, _SOFT), ShellOptions(1.0), MPI.COMM_SELF)


def _way(
    loaded: _Loaded, shell: BoomShell, steps: float, parts: float, radius: float
) -> DirectMotion:
    """Return a motion in steps of a part of the shortest period, output after 10 at most."""
    step = loaded.period / parts
    output = max(step, min(10.0 * step, loaded.period / 8.0))
    return integrate_directly(shell, steps * step, step, output, radius, energy_bound=np.inf)


@pytest.mark.parametrize("radius", [0.5, 0.8, 1.0])
def test_free_motion_is_of_second_order(loaded: _Loaded, radius: float) -> None:
    """Reference: analytic, the natural modes of the same matrices under a step load."""
    errors = []
    for parts in (16.0, 32.0, 64.0):
        motion = _way(loaded, loaded.few, 10.0 * parts, parts, radius)
        exact = loaded.tip(motion.time)
        errors.append(float(np.abs(motion.observed["tip"] - exact).max() / np.ptp(exact)))
    assert errors[-1] < 4.0e-3
    assert np.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(2.0, abs=0.2)


def test_the_method_takes_energy_and_gives_none(loaded: _Loaded) -> None:
    """Reference: analytic. At ρ∞ = 1 energy is conserved. A smaller ρ∞ has a larger loss, and at
    ρ∞ = 0 long steps end at the static deflection.
    """
    conserved, *others = (
        energy_residual(_way(loaded, loaded.all, 200.0, 64.0, radius).energies)
        for radius in (1.0, 0.8, 0.5, 0.0)
    )
    assert np.abs(conserved).max() < 1.0e-9
    assert max(missing.max() for missing in others) < 1.0e-12
    lost = [-float(missing[-1]) for missing in others]
    assert 1.0e-6 < lost[0] < lost[1] < lost[2]
    settled = _way(loaded, loaded.all, 20.0, 1.0e-4, 0.0)
    assert settled.observed["tip"][-1] == pytest.approx(loaded.rest, rel=1.0e-8)


@pytest.mark.slow
def test_impact_follows_the_reduced_shell() -> None:
    """Reference: other code, the reduced shell in short steps of exact flow."""
    stop = Stop(0, 10.0, 0.002, PowerContact(1.0e11, 2.0, stiffness_below=0.0))
    boom = Boom(flat_boom().segments[:1], (), stops=(stop,))
    krylov = KrylovOptions((5.0, 50.0, 300.0, 1500.0, 8000.0), 4)
    reduced = reduce_quickly(boom, ShellOptions(1.0, krylov=krylov))
    reference = FixedStep(4.0e-6)(Motion(reduced.system, 0.12))
    motion = integrate_directly(_full(boom), 0.12, 1.0e-4)
    tip, exact = motion.observed["tip"], reference.data["tip"].values
    assert reference.first_contact < 0.1
    assert np.abs(tip - exact).max() < 2.0e-3 * np.ptp(exact)
    impulse, given = motion.contact_forces.sum(), float(reference.data["contact_force"].sum())
    assert given > 0.0
    assert impulse == pytest.approx(given, rel=2.0e-3)
    assert motion.energy_residual < 1.0e-3


@pytest.mark.slow
def test_friction_below_its_limit_holds_exactly() -> None:
    """Reference: analytic. Under a tenth of the load no row moves, and there is no loss."""
    held = flat_boom(friction=0.2)
    light = tuple(replace(segment, load=0.1 * segment.load) for segment in held.segments)
    motion = integrate_directly(_full(replace(held, segments=light)), 0.1, 5.0e-4)
    largest = np.abs(motion.friction_forces).max(axis=0)
    assert (largest < [900.0, 1000.0]).all()
    assert (largest > 100.0).all()
    assert np.abs(motion.slides).max() < 1.0e-15
    assert np.ptp(motion.observed["tip"]) > 1.0e-5
    assert np.abs(motion.energies[:, 5]).max() < 1.0e-12
    moving = integrate_directly(_full(held), 0.1, 5.0e-4)
    assert np.abs(moving.friction_forces[:, 1]).max() == pytest.approx(1000.0, rel=1.0e-12)
    assert np.abs(moving.slides).max() > 1.0e-5
    assert (np.diff(moving.energies[:, 5]) > -1.0e-12).all()


@pytest.mark.slow
def test_friction_and_contact_are_those_of_the_reduced_shell() -> None:
    """Reference: other code path, the reduced shell during the first impact. If a station has
    contact and sticks, only the sum of both forces is unique.
    """
    boom = flat_boom(friction=0.2)
    system = reduce_quickly(touching(boom, _SOFT), ShellOptions(1.0)).system
    reference = FixedStep(1.0e-5)(Motion(system, 0.4))
    full = _full(boom)
    motion = integrate_directly(full, 0.4, 2.5e-4)
    exact = reference.data["tip"].values
    assert reference.first_contact < 0.38
    assert np.abs(motion.observed["tip"] - exact).max() < 1.0e-3 * np.ptp(exact)
    at = [[contact.station == station for contact in full.rows.contacts] for station in (0, 1)]
    pushed = motion.friction_forces - motion.contact_forces @ np.array(at).T
    data = reference.data
    given = (data["friction_force"] - data["contact_force"]).sum("time").values
    assert (np.abs(motion.contact_forces).max(axis=0) > 0.0).any()
    assert pushed.sum(axis=0) == pytest.approx(given, rel=2.0e-3)
    assert motion.energy_residual < 1.0e-3


PLAIN = "moves in the plane, under constant loads, without bonded joints"
JACK = Cylinder(0, 4.0, depth=0.3, ground=(1.0, -2.0), stiffness=1.0e7)
DASHPOTS = (replace(flat_boom().joints[0], dashpot=1.0),)
DAMPED = replace(LAW.law, damping=0.5).with_clearance(LAW.above)


@pytest.mark.parametrize(
    ("boom", "law", "message"),
    [
        (boom_in_space(), LAW, PLAIN),
        (three_segments(bonded=True), LAW, PLAIN),
        (flat_boom(), DAMPED, "takes contacts without damping"),
        (replace(flat_boom(), joints=DASHPOTS), LAW, "takes joints without dashpots"),
        (replace(flat_boom(), cylinders=(JACK,)), LAW, "takes neither cylinders nor dashpots"),
    ],
)
def test_unsupported_booms_are_refused(boom: Boom, law: PowerContact, message: str) -> None:
    """Reference: exact words."""
    full = assemble_boom(touching(boom, law, law), ShellOptions(2.0), MPI.COMM_SELF)
    with pytest.raises(BoomError, match=f"the unreduced shell {message}$"):
        integrate_directly(full, 1.0e-3, 1.0e-3)


def test_a_block_on_a_rough_floor_stays_or_slides() -> None:
    """Reference: analytic. Below μN nothing moves. Above it, the excess times the compliance is the
    displacement s, with the loss μN s.
    """
    rows = ResistingRows([], [DryFriction(0.5, 0, 20.0)], np.array([[1.0e-3]]), onward=2.0)
    assert rows.forces(np.array([9.0e-3])) == pytest.approx([9.0], rel=1.0e-14)
    assert rows.displacements == pytest.approx([0.0], abs=1.0e-17)
    assert rows.friction_loss == pytest.approx(0.0, abs=1.0e-15)
    assert rows.forces(np.array([14.0e-3])) == pytest.approx([10.0], rel=1.0e-14)
    assert rows.displacements == pytest.approx([2.0 * 4.0e-3], rel=1.0e-12)
    assert rows.friction_loss == pytest.approx(10.0 * 8.0e-3, rel=1.0e-12)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ((0.0151, 0.0156, 0.0165), "0.0156"), ((1.0, 1.24, 1.6), "1.2"),
        ((120.0, 134.0, 150.0), "130"), ((1.0, 4.0, 9.0), "~4"), ((0.2, 4.0, 90.0), "~4"),
        ((123.4,), "100"), ((1.0, 1.0), "1"), ((0.0, 0.0), "0"),
    ],
)  # fmt: skip
def test_digits_follow_the_noise(values: tuple[float, ...], text: str) -> None:
    """Reference: by hand. The last digit is the first digit of half the range."""
    assert repeated(values) == text


@pytest.mark.slow
@INSTALLED
def test_exudyn_moves_telescoped_beams_alike() -> None:
    """Reference: other code, with an error of 0.4 % of the range at this step."""
    problem = replace(other_programs.telescoped_beams(), steps=[5.0e-5])
    ((_, off, _),) = problem.elsewhere()
    assert 1.0e-4 < off < 0.01


@pytest.mark.slow
def test_the_rates_are_those_of_the_series() -> None:
    """Reference: other code, the time step, to 1e-5 of the tip's range."""
    system = five_terms(shipped("paper"))
    ours = FixedStep(2e-6)(Motion(system, 0.2))
    for rates in (compiled_rates(system), array_rates(system)):
        states = generic("DOP853", rates, 10, 0.2, 1e-11)
        tip = states[:, :5] @ system.observers["tip"].row
        np.testing.assert_allclose(tip, ours.data["tip"].values, atol=1e-5 * np.ptp(tip), rtol=0.0)
    assert 0.05 < ours.first_contact < 0.19

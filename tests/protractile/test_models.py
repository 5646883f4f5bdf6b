# SPDX-License-Identifier: LGPL-3.0-or-later
"""Models of a boom in Python, compared with the same models of a case file."""

import tomllib
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import protractile as pt
from protractile.runs.case.kinds.model import ModelTable
from tests.booms import telescope

# The boom of the fixture.
DECLARED = tomllib.loads("""
title = "An arm and a fly"
time = { duration = 0.2 }

[material]
youngs_modulus = 2.1e11
poissons_ratio = 0.3
density = 7850.0
yield_strength = 355e6

[[segment]]
name = "arm"
span = [0.0, 8.0]
section = { height = 0.40, width = 0.30, flange = 0.008, web = 0.006 }
supports = [{ x = 0.0, kind = "clamped" }]

[[segment]]
name = "fly"
span = [6.0, 14.0]
section = { height = 0.36, width = 0.26, flange = 0.006, web = 0.005 }
load = -500.0

[[joint]]
outer = "arm"
inner = "fly"
stations = [6.0, 8.0]
play = 0.010
stiffness = 1e9
exponent = 1.0
""")
LAW = pt.PowerContact(1.0e9, exponent=1.0)


@pytest.fixture(scope="module")
def boom() -> pt.Boom:
    return telescope(joint__pad=None, joint__contact=LAW, fly__load=-500.0)


def declared(model: ModelTable, **tables: Any) -> pt.Case:
    """Return the case from an equivalent case file."""
    table = model.model_dump(mode="json", by_alias=True, exclude_none=True)
    return pt.Case.model_validate(DECLARED | tables | {"model": [table]})


FINE = {"output_step": 2.0e-3, "tolerance": 1.0e-4}
DAMPED = {"modal": 0.02, "mass": 0.1, "stiffness": 1.0e-5}


@pytest.mark.parametrize(
    ("kind", "keys", "tables", "options"),
    [
        ("Kantorovich", {"terms": (4, 6), "base": "complete"}, {}, {}),
        ("BeamElements", {"step": 1.0e-4}, {}, {}),
        ("BeamElements", {"theory": "timoshenko", "element_length": 1.0}, {}, {}),
        ("BeamElements", {"bonded": True}, {}, {}),
        ("BeamElements", {"contact": {"stiffness": 1.0e7, "exponent": 1.5}}, {}, {}),
        ("BeamElements", {"element_length": 1.0}, {"gravity": {"angle": 30.0}}, {}),
        ("BeamElements", {"element_length": 1.0},
         {"time": {"duration": 0.2, **FINE}, "start": {"state": "equilibrium"}, "damping": DAMPED},
         {"at_rest": True, "damping_ratio": 0.02, "rayleigh": (0.1, 1.0e-5), **FINE}),
        ("Rigid", {}, {}, {}),
        pytest.param("Shell", {"mesh_size": 0.4}, {}, {}, marks=pytest.mark.slow),
        pytest.param("BeamElements", {"calibrated_by": 0.4}, {}, {}, marks=pytest.mark.slow),
    ],
)  # fmt: skip
def test_motion_equals_motion_of_case_file(
    boom: pt.Boom, kind: str, keys: dict[str, Any], tables: dict[str, Any], options: dict[str, Any]
) -> None:
    """Reference: other code path, the case file, to the last bit."""
    if "mesh_size" in keys or "calibrated_by" in keys:
        pytest.importorskip("dolfinx", reason="shells need FEniCSx")
    if "calibrated_by" in keys:
        keys = {"calibrated_by": pt.Shell(mesh_size=keys["calibrated_by"])}
    if "gravity" in tables:
        boom = pt.with_weight(boom, **tables["gravity"])
    model = getattr(pt, kind)(boom, **keys)
    results = pt.run_case(declared(model, **tables))
    motion = model.simulate(0.2, **options)
    np.testing.assert_array_equal(motion.tip, results.trajectories["tip"].sel(model=model.name))
    assert motion.data.attrs["steps"] == results.summary.models[model.name].steps


def test_pads_with_a_thickness_need_no_contact(boom: pt.Boom) -> None:
    """Reference: by hand, k = 2 E A/t of both pads of a side; a contact that is given prevails."""
    below = pt.SlidePad(0.2, 0.04, side="below", thickness=0.02, modulus=2.0e9)
    above = pt.SlidePad(0.1, 0.04, side="above", thickness=0.01, modulus=1.0e9)
    (joint,) = boom.joints
    padded = replace(joint, contact=None, pads=(below, above))
    laws = pt.BeamElements(replace(boom, joints=[padded])).system().laws
    terms = {(term.side, term.exponent): term.stiffness for law in laws for term in law.terms}
    assert terms == pytest.approx({(1.0, 1.0): 0.8e9, (-1.0, 1.0): 1.6e9})
    given = replace(padded, contact=pt.PowerContact(1.0e7, 1.5))
    assert given.law("z").law == pt.PowerContact(1.0e7, 1.5)


def test_missing_law_or_model_is_refused(boom: pt.Boom) -> None:
    loose = replace(boom, joints=[replace(boom.joints[0], contact=None)])
    assert pt.BeamElements(loose, bonded=True).system().laws == []
    with pytest.raises(pt.BoomError) as error:
        pt.BeamElements(loose).system()
    assert str(error.value) == (
        "joint[1].contact: missing; give a contact law, or pads with a thickness, or tie the "
        "segments of the joint"
    )
    with pytest.raises(pt.BoomError, match=r"^rigid: missing; give the boom that it is a model of"):
        pt.Rigid().system()


def test_keys_are_those_of_the_table(boom: pt.Boom) -> None:
    with pytest.raises(pt.BoomError, match=r"^Shell.mesh: unknown; known are name, contact, step"):
        pt.Shell(boom, mesh=0.1)
    with pytest.raises(pt.BoomError, match="must have one number for each of the 2 segments"):
        pt.Kantorovich(boom, terms=(4,)).system()


def test_impossible_parts_are_refused_as_in_a_case_file(boom: pt.Boom) -> None:
    """Reference: exact words."""
    arm = boom.segments[0]
    high = pt.BoxSection(height=1.0e9, width=0.3, flange=0.01, web=0.01)
    for change, message in (
        ({"material": pt.Material(0.5, 0.3, 7850.0)},
         "material.youngs_modulus: Young's modulus is 0.5 Pa, usual is from 1e+09 up to 1e+12 Pa"),
        ({"section": high},
         "section: the height of 'arm' is 1e+09 m, usual is from 0.016 up to 1.6 m"),
    ):  # fmt: skip
        with pytest.raises(pt.BoomError) as error:
            pt.BeamElements(pt.Boom([replace(arm, **change)])).system()
        assert str(error.value) == f"segments[0].{message}; check the number and its unit"
    nothing: Any = None
    with pytest.raises(pt.BoomError, match=r"^BeamElements.boom: must be a Boom, got None$"):
        pt.BeamElements(nothing)


@pytest.mark.parametrize("angle", [0.0, 30.0])
def test_weight_is_given_once(boom: pt.Boom, angle: float) -> None:
    heavy = pt.with_weight(boom, angle)
    with pytest.raises(pt.BoomError, match=r"^boom: has (its weight|axial forces) already; give"):
        pt.with_weight(heavy, angle)


def test_places_and_names_of_forces_are_those_of_a_boom(boom: pt.Boom) -> None:
    """Reference: other code path, indices and x in m."""
    named = [pt.Load("fly", "z", 1.0, "head", pt.Step()), pt.Thrust("fly", "head", 1e3)]  # type: ignore[arg-type]
    there = [pt.Load(1, "z", 1.0, 14.0, pt.Step()), pt.Thrust(1, 14.0, 1e3)]
    one, other = (
        pt.with_weight(replace(boom, loads=[load]), thrusts=[thrust])
        for load, thrust in (named, there)
    )
    assert one == other

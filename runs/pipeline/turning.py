# SPDX-License-Identifier: LGPL-3.0-or-later
"""Slewing and luffing with their drives, and hoisting with rope force and swing of the load."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from protractile.analysis.quantities import Quantity, Record
from protractile.dynamics.arrays import Array
from protractile.dynamics.damping import closed_contact_damping, closed_contact_modes
from protractile.dynamics.excitation import resolving_times
from protractile.dynamics.gap_system import GapSystem
from protractile.dynamics.motion_laws import HistorySum, MotionLaw, Shaped
from protractile.dynamics.trajectory import Trajectory
from protractile.geometry.axial import lumped_masses
from protractile.geometry.boom import Boom
from protractile.geometry.telescoping import drives_of
from protractile.runs.case.motions import frame_motion, hanging_load
from protractile.runs.case.schema import Case

if TYPE_CHECKING:
    import xarray as xr

# Number of modes that a shaper suppresses, and smallest share of the deflection of such a mode.
_SHAPED, _SHARE = 2, 0.05


def _kilo(unit: str, title: str, heading: str) -> Quantity:
    """Return the metric of a result that is displayed in thousands of its SI unit."""
    return Quantity(".", unit, title, shown=f"k{unit}", heading=heading, form=".3g")


@dataclass(frozen=True, slots=True)
class CraneDrives(Record):
    """Largest moments in N·m and powers in W, and the work in J, of a crane's drives.

    Values of drives that the case does not have are None.
    """

    title = "Drives of hoisting, slewing and luffing"
    notes = (
        "The winch pulls with the computed rope force. The moments about the slewing axis and the "
        "foot move a rigid boom with its load on the rope.",
    )

    winch_power: Annotated[float | None, _kilo("W", "power of the winch", "winch:\npower")] = None
    winch_work: Annotated[float | None, _kilo("J", "work of the winch", "work")] = None
    slew_moment: Annotated[float | None, _kilo("N m", "slewing moment", "slewing:\nmoment")] = None
    slew_power: Annotated[float | None, _kilo("W", "slewing power", "power")] = None
    slew_work: Annotated[float | None, _kilo("J", "work of slewing", "work")] = None
    luff_moment: Annotated[float | None, _kilo("N m", "luffing moment", "luffing:\nmoment")] = None
    luff_power: Annotated[float | None, _kilo("W", "luffing power", "power")] = None
    luff_work: Annotated[float | None, _kilo("J", "work of luffing", "work")] = None


@dataclass(frozen=True, slots=True)
class Hoisting(Record):
    """Extreme values of a load on a rope.

    Args:
        lift_off: time in s at which the rope force first reaches the weight of a load on the
            ground; None if it does not, or if the load hangs at t = 0.
        force: largest sum of the forces in all falls of the rope in N.
        factor: this force over the weight of the load.
        by_class: factor φ₂,min + β₂ v of the hoisting class; None without its constants.
        swing_out, swing_aside: largest distances in m of the load from the tip, in the plane of the
            boom and aside; None without a swing in this direction.
    """

    title = "Hoisting"
    notes = (
        "At lift-off the force of all falls reaches the weight of the load. φ₂ is their largest "
        "force over this weight. Swing is the largest distance of the load from the tip.",
    )

    lift_off: Annotated[
        float | None,
        Quantity("lift_off", "s", "lift-off", heading="lift-off", form=".3f", charted=False),
    ]
    force: Annotated[
        float,
        Quantity(
            "rope_force", "N", "force of the rope",
            shown="kN", heading="rope force,\nmaximum", form=".3g",
        ),
    ]  # fmt: skip
    factor: Annotated[
        float,
        Quantity("rope_factor", "1", "factor φ₂ of the rope", heading="factor φ₂", form=".3f"),
    ]
    by_class: Annotated[
        float | None,
        Quantity(
            "rope_factor_by_class", "1", "factor φ₂ of the hoisting class",
            heading="φ₂ of the\nclass", form=".3f",
        ),
    ]  # fmt: skip
    swing_out: Annotated[
        float | None,
        Quantity(
            "swing_out", "m", "swing in the plane of the boom",
            heading="swing\nin plane", form=".3g",
        ),
    ]  # fmt: skip
    swing_aside: Annotated[
        float | None,
        Quantity("swing_aside", "m", "swing aside", heading="swing\naside", form=".3g"),
    ]


def motion_laws(case: Case) -> Iterator[tuple[str, str, MotionLaw]]:
    """Yield key, verb and law of slewing and of luffing, of those that the case has."""
    for key, verb, table in (("slew", "Slews", case.slew), ("luff", "Luffs", case.luff)):
        if table is not None:
            yield key, verb, table.history(key)


def pendulum_frequency(case: Case) -> float:
    """Return the pendulum frequency √(g/l)/2π of the hanging load in Hz; 0 if it cannot swing."""
    if case.gravity is None or case.hoist is None or case.hoist.pendulum is None:
        return 0.0
    return float(np.sqrt(case.gravity.acceleration / case.hoist.pendulum) / (2.0 * np.pi))


def fastest_turn(law: MotionLaw) -> float:
    """Return the largest angular speed in degrees per second."""
    return float(np.abs(law.rate(resolving_times([law], max(law.kinks)), 1)).max())


def turning_lines(case: Case) -> Iterator[str]:
    """Yield a sentence on the angle, time and speed of slewing and of luffing."""
    for _, verb, law in motion_laws(case):
        kinks = law.kinks
        yield (
            f"{verb} by {float(law(np.array(max(kinks)))):g} degrees from {max(0.0, min(kinks)):g} "
            f"to {max(kinks):g} s, at {fastest_turn(law):.4g} degrees/s at most."
        )


def shaper_lines(case: Case, system: GapSystem, rest: Array | None) -> Iterator[str]:
    """Yield sentences on input shapers for the modes that slewing and luffing excite most.

    The ``load`` of the system includes all constant loads. The equilibrium (num_modes,) is None if
    the motion starts elsewhere.
    """
    omega, shapes = closed_contact_modes(system, rest)
    frequencies, ratios = closed_contact_damping(system, rest)
    for key, _, law in motion_laws(case):
        times = resolving_times([law], max(law.kinks))
        time = float(times[np.abs(law.rate(times, 2)).argmax()])
        row = system.observers["tip_lateral" if key == "slew" else "tip"].row
        load = system.load_at(time) - system.load_at(0.0)
        swings = np.abs(row @ shapes) * np.abs(load @ shapes) / omega**2
        most = np.sort(np.argsort(swings)[-_SHAPED:])
        chosen = [mode for mode in most if swings[mode] > _SHARE * swings.sum()]
        pairs = ", ".join(f"[{frequencies[m]:.4g}, {max(ratios[m], 0.0):.3g}]" for m in chosen)
        later = sum(Shaped(law, frequencies[mode], ratios[mode]).delay for mode in chosen)
        if not getattr(case, key).shaper:
            yield (
                f"{key}: shaper = [{pairs}] would leave no vibration of these modes, without play, "
                f"and takes {later:.3g} s longer."
            )


def drive_moments(case: Case, boom: Boom, data: xr.Dataset) -> dict[str, tuple[Array, Array]]:
    """Return moment (num_times,) in N·m and power in W of slewing and of luffing, by key.

    The result is empty without slewing and luffing. The boom is taken as rigid. The force of a load
    on a rope follows from the computed rope force and swing. ``data`` is the trajectory of a model.
    """
    if case.slew is None and case.luff is None:
        return {}
    frame, time, last = frame_motion(case, boom.segments), data["time"].values, len(boom.segments)
    total = np.zeros((2, time.size))
    for number, segment in enumerate(boom.segments):
        extension = HistorySum(tuple(drive.history for drive in drives_of(boom.joints, number)))
        for point in lumped_masses(segment):
            total += frame.drive_moments(time, point.x, point.mass, extension)
    if "rope_force" in data:
        extension = HistorySum(tuple(drive.history for drive in drives_of(boom.joints, last - 1)))
        out, up = frame.position(time, boom.tip, extension)
        pendulum = case.hoist.pendulum if case.hoist and case.hoist.pendulum else np.inf
        pull = data["rope_force"].attrs["weight"] / pendulum
        lateral, ahead = (
            pull * data[name].values if name in data else 0.0 * time
            for name in ("swing_aside", "swing_out")
        )
        total += -lateral * out, data["rope_force"].values * (out - frame.radius) + ahead * up
    rates = {"slew": frame.slew_angle(time, 1), "luff": frame.luff_angle(time, 1)}
    return {
        key: (moment, moment * rate)
        for moment, (key, rate) in zip(total, rates.items(), strict=True)
        if getattr(case, key) is not None
    }


def crane_drives(case: Case, boom: Boom, data: xr.Dataset) -> CraneDrives | None:
    """Return moments, powers and work of a crane's drives in a motion; None without such drives."""
    results: dict[str, float] = {}
    steps = np.diff(data["time"].values)
    load = hanging_load(case, boom)
    if load is not None and load.hoist is not None:
        # A rope force is the mean over the output interval that ends at its time.
        works = data["rope_force"].values[1:] * np.diff(load.hoist(data["time"].values))
        results |= {"winch_power": (works / steps).max(), "winch_work": works.sum()}
    for key, (moment, power) in drive_moments(case, boom, data).items():
        results[f"{key}_moment"] = moment[np.abs(moment).argmax()]
        results[f"{key}_power"] = power.max()
        results[f"{key}_work"] = 0.5 * (power[1:] + power[:-1]) @ steps
    return CraneDrives(**{key: float(value) for key, value in results.items()}) if results else None


def hoisting(case: Case, boom: Boom, trajectory: Trajectory) -> Hoisting | None:
    """Return the extreme values of the hoisted load in a motion; None without a hoist."""
    load, data = hanging_load(case, boom), trajectory.data
    if case.hoist is None or load is None:
        return None
    force = float(data["rope_force_peak"].values.max())
    swings = (
        float(np.abs(data[name].values).max()) if name in data else None
        for name in ("swing_out", "swing_aside")
    )
    lift_off = None
    if load.slack is not None:
        lift_off = _first_rise(trajectory.time, data["rope_force"].values, load.weight)
    by_class = case.hoist.factor_by_class
    return Hoisting(lift_off, force, force / load.weight, by_class, *swings)


def _first_rise(time: Array, means: Array, level: float) -> float | None:
    """Return the time in s at which a quantity first reaches a level; None if it does not.

    Means over the intervals that end at ``time`` (num_times,) are values in the middle of their
    interval up to second order; the first one is the initial value. Between them the quantity is
    linear.
    """
    reached = np.flatnonzero(means >= level)
    if not reached.size or reached[0] == 0:
        return float(time[0]) if reached.size else None
    middles = np.append(time[0], 0.5 * (time[1:] + time[:-1]))
    pair = [reached[0] - 1, reached[0]]
    return float(np.interp(level, means[pair], middles[pair]))

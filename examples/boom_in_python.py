# SPDX-License-Identifier: LGPL-3.0-or-later
"""A boom of two boxes without a case file: the inner one falls through its play."""

import protractile as pt

LOAD, CLEARANCE = -500.0, 5.0e-3
STEEL = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
LAW = pt.PowerContact(1.0e9, exponent=1.0, clearance=CLEARANCE)


def boom(tied: bool = False) -> pt.Boom:
    """A clamped arm and a fly of which the last 2 m are in it."""
    arm = pt.Segment.of_section(
        "arm", 0.0, 8.0, STEEL,
        pt.BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006),
        supports=(pt.Support(0.0, "clamped"),),
    )  # fmt: skip
    fly = pt.Segment.of_section(
        "fly", 6.0, 14.0, STEEL,
        pt.BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005), load=LOAD,
    )  # fmt: skip
    joint = pt.Joint(outer=0, inner=1, stations=(6.0, 8.0), clearance=CLEARANCE, tied=tied)
    return pt.Boom((arm, fly), (joint,))


def move() -> pt.Trajectory:
    """A second of it, by beam finite elements."""
    return pt.simulate(pt.finite_element_system(boom(), [LAW], element_length=1.0), 1.0)


if __name__ == "__main__":
    motion = move()
    print(f"touches at {motion.first_contact:.5f} s, the tip peaks at {motion.first_peak()}")

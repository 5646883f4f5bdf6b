# SPDX-License-Identifier: LGPL-3.0-or-later
"""Boom of two boxes without a case file: the inner one falls through its play."""

import protractile as pt

LOAD, PLAY = -500.0, 0.010
LAW = pt.PowerContact(1.0e9, exponent=1.0)


def boom(play: float = PLAY) -> pt.Boom:
    """Return a clamped arm and a fly with an overlap of 2 m, with a play in m."""
    steel = pt.Material(youngs_modulus=2.1e11, poissons_ratio=0.3, density=7850.0)
    boxes = (
        pt.BoxSection(height=0.40, width=0.30, flange=0.008, web=0.006),
        pt.BoxSection(height=0.36, width=0.26, flange=0.006, web=0.005),
    )
    wall = pt.Support(0.0, "clamped")
    arm = pt.Segment.of_section("arm", 0.0, 8.0, steel, boxes[0], supports=(wall,))
    fly = pt.Segment.of_section("fly", 6.0, 14.0, steel, boxes[1], load=LOAD)
    joint = pt.Joint("arm", "fly", stations=(6.0, 8.0), play=play, contact=LAW)
    return pt.Boom([arm, fly], [joint])


if __name__ == "__main__":
    motion = pt.BeamElements(boom()).simulate(1.0)
    print(f"touches at {motion.first_contact:.5f} s, the tip peaks at {motion.first_peak()}")
    motion.tip.plot()

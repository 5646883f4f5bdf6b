# SPDX-License-Identifier: LGPL-3.0-or-later
"""A boom as beams and as FEniCSx shells: what the beams miss at the tip's first peak."""

from boom_in_python import LAW, boom
from mpi4py import MPI

import protractile as pt


def shell() -> pt.Trajectory:
    """Half a second of a coarse shell."""
    options = pt.ShellOptions(mesh_size=0.4)
    reduced = pt.reduce_boom(boom(), [LAW], options, MPI.COMM_SELF)
    return pt.simulate(reduced.system, 0.5)


def beam() -> pt.Trajectory:
    """The same of Timoshenko beams."""
    return pt.simulate(pt.finite_element_system(boom(), [LAW], theory="timoshenko"), 0.5)


if __name__ == "__main__":
    for name, motion in (("shell", shell()), ("beam", beam())):
        time, height = motion.first_peak()
        print(f"{name}: {1e3 * height:.1f} mm at {time:.3f} s")

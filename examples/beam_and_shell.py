# SPDX-License-Identifier: LGPL-3.0-or-later
"""Boom as beams and as FEniCSx shells: error of the beams at the tip's first peak."""

from boom_in_python import boom

import protractile as pt

if __name__ == "__main__":
    shell = pt.Shell(boom(), mesh_size=0.4).simulate(0.5)
    beam = pt.BeamElements(boom(), theory="timoshenko").simulate(0.5)
    for name, motion in (("shell", shell), ("beam", beam)):
        time, height = motion.first_peak()
        print(f"{name}: {1e3 * height:.1f} mm at {time:.3f} s")
    print(shell.compare(beam))

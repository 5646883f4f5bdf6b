# SPDX-License-Identifier: LGPL-3.0-or-later
"""Example case of the program with more play: run and figures."""

import protractile as pt


def run(play: float) -> pt.Results:
    """Run the paper's boom as five-term series, for 0.6 s, with a play in m."""
    case = pt.load_case(pt.CASES / "coarse.toml")
    return pt.run_case(pt.change(case, **{"joint.play": play}), models=["kantorovich-5"])


if __name__ == "__main__":
    for play in (0.007, 0.014):
        results = run(play)
        summary = results.summary.models["kantorovich-5"]
        print(f"play {play} m: first contact at {summary.first_contact:.4f} s")
        results.trajectories["tip"].plot.line(x="time")

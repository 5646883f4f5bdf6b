# SPDX-License-Identifier: LGPL-3.0-or-later
"""Command lines with errors."""

from random import Random

_WORDS = (
    "", "-", "--", "-1", "0", "1", "2", "nan", "inf", "1e-9", "1e9", "0.01", "auto", "text",
    "case.toml", "nowhere.toml", ".", "/", "/dev/zero", "/dev/null", "/proc/self/mem", "../x",
    "a\nb", "\x1b[31mred", "\udcff", "é∆", "n" * 300, "n" * 100_000, "9" * 5000, "a=b=c",
    "beam-fe", "beam-fe,beam-fe", ",", "--help", "--models", "--out", "--mesh-size", "--modes",
    "--members", "--no-cache", "--large", "--vary", "--time", "--unknown",
)  # fmt: skip
_KEYS = (
    "joint.play", "joint[1].play", "joint[9].play", "segment[2].load", "segment.span[1]",
    "time.duration", "model.terms[1]", "payload.mass", "ensemble.members", "material.density",
    "title", "a.b.c", "joint", "joint[0].play", "joint[99999999999].play", "[1]", ".",
    "model[3].contact.stiffness", "demand[1]", "start.velocity.inner", "base[1].acceleration",
    "joint.play.x", "k" * 300,
)  # fmt: skip
_RANGES = (
    "0:0.01:2", "0:0.01", "0:1:1", "0:1:9999999999999", "1,2", "1", "1,1", "nan,1",
    "1e308,-1e308", "a,b", "", ":", "::", "0:1:٣", "1e-320,2e-320", "0:1:100000",
    ",".join(map(str, range(3000))),
)  # fmt: skip


def mutate(random: Random) -> list[str]:
    """Return the arguments of a command that ends soon, or is invalid."""
    kind = random.random()
    if kind < 0.25:
        return random.choices(_WORDS, k=random.randrange(5))
    if kind < 0.6:
        command = random.choice(("check", "run", "run", "report", "snapshot", "schema", "sweep"))
        return [command, *random.choices(_WORDS, k=random.randrange(4))]
    if kind < 0.8:
        option = random.choice(("--models", "--mesh-size", "--modes", "--members", "--out"))
        return ["run", "case.toml", "--models", "kantorovich-5", option, random.choice(_WORDS)]
    vary = f"{random.choice(_KEYS)}={random.choice(_RANGES)}"
    # A model that the case has not: a sweep that could be run is not.
    return ["sweep", "case.toml", "--vary", vary, "--models", random.choice(("x", "beam-fe,x"))]

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Command lines: of every command with usual options, and with errors."""

from random import Random

_WORDS = (
    "", "-", "--", "-1", "0", "1", "2", "nan", "inf", "1e-9", "1e9", "0.01", "auto", "text",
    "case.toml", "nowhere.toml", ".", "/", "/dev/zero", "/dev/null", "/proc/self/mem", "../x",
    "a\nb", "\x1b[31mred", "\udcff", "é∆", "n" * 300, "n" * 100_000, "9" * 5000, "a=b=c",
    "beam", "beam,beam", ",", "--help", "--models", "--out", "--mesh-size", "--modes",
    "--members", "--no-cache", "--large", "--vary", "--time", "--unknown", "--until", "--samples",
    "--sensitivity", "--against", "--shell", "--to", str(2**20), str(2**200),
)  # fmt: skip
_COMMANDS = ("check", "run", "prove", "report", "snapshot", "schema", "sweep", "frequencies",
             "export")  # fmt: skip
# Keys with usual values.
USUAL = {
    "joint.play": (0.002, 0.004), "joint[1].friction": (0.0, 0.2), "time.duration": (0.01, 0.015),
    "joint[1].extension": (2.6, 3.2), "gravity.angle": (0.0, 60.0), "damping.modal": (0.01, 0.03),
    "segment[2].section.height": (0.25, 0.27), "model[1].element_length": (0.4, 0.8),
}  # fmt: skip
WRONG_KEYS = (
    "joint[9].play", "segment[2].load", "segment.span[1]", "model.terms[1]", "payload.mass",
    "ensemble.members", "title", "a.b.c", "joint", "joint[0].play", "joint[99999999999].play",
    "[1]", ".", "model[3].contact.stiffness", "demand[1]", "start.velocity.inner",
    "base[1].acceleration", "joint.play.x", "k" * 300,
)  # fmt: skip
_WRONG_VALUES = (
    "0:0.01", "0:1:1", "0:1:9999999999999", "1,1", "nan,1", "1e308,-1e308", "a,b", "", ":", "::",
    "0:1:٣", "1e-320,2e-320", "0:1:100000", ",".join(map(str, range(3000))),
)  # fmt: skip
_BOUNDS = ("tip<0.01", "first_frequency>5", "tip_at_rest<0.02", "tip<0.03", "tip", "x<1", "tip<nan",
           "tip>1e300", "<", "tip<-1", "=")  # fmt: skip


def mutate(random: Random) -> list[str]:
    """Return the arguments of a command that ends soon, or is invalid."""
    if random.random() < 0.4:
        return random.choices(_WORDS, k=random.randrange(5))
    return [random.choice(_COMMANDS), *random.choices(_WORDS, k=random.randrange(4))]


def usual(random: Random) -> list[str]:
    """Return the arguments of a command for a case of two boxes; a fifth has an error."""
    beam = ["--models", random.choice(("beam", "beam", "series"))]
    key, (low, high) = random.choice(list(USUAL.items()))
    vary = ["--vary", f"{key}={low},{high}" if random.random() < 0.7 else f"{key}={low}:{high}:3"]
    (arguments,) = random.choices(
        (
            ["prove", "case.toml"],
            ["export", "case.toml", "--to", random.choice(("opensees", "opensees", "calculix"))],
            ["frequencies", "case.toml", *beam, *vary],
            ["run", "case.toml", *beam, "--no-pictures", "--members", random.choice("02")],
            ["sweep", "case.toml", *beam, *vary],
            ["sweep", "case.toml", *vary, "--models", "beam,series", "--against", "beam"],
            ["sweep", "case.toml", *beam, *vary, "--until", random.choice(_BOUNDS)],
            ["sweep", "case.toml", *beam, "--samples", random.choice("248")],
            ["sweep", "case.toml", *beam, "--sensitivity"],
        ),
        (6, 3, 2, 4, 2, 1, 1, 1, 0.5),
    )
    if random.random() < 0.2:
        wrong = (*_WORDS, *(f"{key}=0.002,0.003" for key in WRONG_KEYS),
                 *(f"joint.play={values}" for values in _WRONG_VALUES))  # fmt: skip
        arguments[random.randrange(2, len(arguments) + 1) :] = [random.choice(wrong)]
    return [*arguments, "--out", "out"] if arguments[0] != "prove" else arguments

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Invalid and extreme values, as a TOML file spells them."""

from random import Random

NUMBERS = (
    "0", "0.0", "-0.0", "-1", "1", "2", "1e-300", "5e-324", "1e-30", "1e-9", "1e9", "9.5e10",
    "1e30", "1e100", "1e150", "1e-150", "1e300", "1.7e308", "-1e300", "nan", "inf", "-inf",
    "9223372036854775807", "0xff", "1_000",
)  # fmt: skip
OTHERS = (
    "true", "false", '""', '"text"', "[]", "[[]]", "{}", "1979-05-27", "07:32:00", '"\\u0000"',
    '"\\u001b[31mred"', '"\\u202eabc"', "[1.0, [2.0]]", '["a", 1]', "{ x = 1.0 }", "'''\n'''",
    "[[[]]]", "[{}]", "[[0.0, 1e300], [1.0, 1e-300]]", "{ tail = 1e150 }", "{ a = { b = {} } }",
    '"../../etc/passwd"', '"/etc/shadow"', '"é∆𝔅"', '"a b.c+d-e_f"', '"[bold]x[/bold]"',
)  # fmt: skip


def any_value(random: Random, given: str) -> str:
    """Return a value in place of a given one: another size, sign or type, or infinite."""
    kind = random.random()
    if kind < 0.45:
        try:
            return repr(float(given) * 10.0 ** random.choice((-12, -6, -3, -1, 1, 3, 6, 12)))
        except ValueError:
            return random.choice(NUMBERS)
    if kind < 0.65:
        return random.choice(NUMBERS)
    if kind < 0.9:
        return random.choice(OTHERS)
    if kind < 0.93:
        return "9" * random.choice((18, 19, 20, 400, 5000))
    if kind < 0.95:
        return "0x" + "f" * random.choice((15, 17, 5000))
    if kind < 0.97:
        return f'"{"n" * random.choice((60, 61, 260, 5000))}"'
    return f"[{', '.join([given] * random.choice((2, 3, 50, 300, 20_000)))}]"

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Case files and histories with errors in values, keys, tables or bytes."""

import re
from collections.abc import Callable, Mapping
from functools import partial
from random import Random

from protractile.runs.case.schema import case_schema
from tests.fuzz.valid import TABLES, fill, with_table

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
    try:
        scaled = repr(float(given) * 10.0 ** random.choice((-12, -6, -3, -1, 1, 3, 6, 12)))
    except ValueError:
        scaled = random.choice(NUMBERS)
    others = {
        scaled: 45, random.choice(NUMBERS): 20, random.choice(OTHERS): 25,
        "9" * random.choice((18, 19, 20, 400, 5000)): 3,
        "0x" + "f" * random.choice((15, 17, 5000)): 2,
        f'"{"n" * random.choice((60, 61, 260, 5000))}"': 2,
        f"[{', '.join([given] * random.choice((2, 3, 50, 300, 20_000)))}]": 3,
    }  # fmt: skip
    return random.choices(list(others), list(others.values()))[0]


_LINE = re.compile(r"^(?P<key>[a-z_]+) = (?P<value>.+?)(?P<rest>\s*#.*)?$", re.MULTILINE)
_NUMBER = re.compile(r"(?P<value>-?\d+(?:\.\d*)?(?:e-?\d+)?)")
# Every key of every table that a case may have.
_KEYS = sorted(
    {key for table in case_schema()["$defs"].values() for key in table.get("properties", ())}
)


def mutate(text: str, random: Random) -> str:
    """Return a case file with one error or a few."""
    for _ in range(random.choice((1, 1, 1, 2, 3))):
        text = random.choices(list(_MUTATIONS), list(_MUTATIONS.values()))[0](text, random)
    return text


def scaled(text: str, random: Random) -> str:
    """Return a case file with one or two scaled numbers, which usually remains valid."""
    for _ in range(random.choice((1, 1, 2))):
        line = random.choice(list(_LINE.finditer(text)))
        number = random.choice(list(_NUMBER.finditer(line["value"])) or [None])
        if number is not None:
            place = line.start("value")
            factor = random.choice((1e-12, 1e-6, 1e-3, 0.1, 0.9, 10, 1e3, 1e9, 1e60))
            other = factor * float(number[0])
            text = f"{text[: place + number.start()]}{other!r}{text[place + number.end() :]}"
    return text


def _other(found: re.Pattern[str], text: str, random: Random) -> str:
    """Return the file with another value, or another number, perhaps in a list or a table."""
    given = random.choice(list(found.finditer(text)) or [None])
    if given is None:
        return text
    start, end = given.span("value")
    return text[:start] + any_value(random, given["value"]) + text[end:]


_other_value, _other_number = partial(_other, _LINE), partial(_other, _NUMBER)


def _without_a_line(text: str, random: Random) -> str:
    lines = text.splitlines(keepends=True)
    del lines[random.randrange(len(lines)) : random.randrange(len(lines))]
    return "".join(lines)


def _one_more_key(text: str, random: Random) -> str:
    lines = text.splitlines()
    key = random.choice((*_KEYS, "unknown", '"\\u001b[2J"', "k" * 300))
    lines.insert(random.randrange(len(lines) + 1), f"{key} = {any_value(random, '1.0')}")
    return "\n".join(lines) + "\n"


def _one_more_table(text: str, random: Random) -> str:
    change = random.choice((_other_value, _other_number, _one_more_key))
    return with_table(text, change(fill(random.choice(TABLES), random), random), random)


def _tables_again(text: str, random: Random) -> str:
    """Return the file with its parts in another order, or one repeated once or many times."""
    parts = re.split(r"(?m)^(?=\[)", text)
    if random.random() < 0.33:
        random.shuffle(parts)
    else:
        parts[random.randrange(len(parts))] *= random.choice((2, 3, 30, 3000))
    return "".join(parts)


def _other_letters(text: str, random: Random) -> str:
    """Replace a few characters by brackets, quotes, controls or halves of characters."""
    letters = list(text)
    for _ in range(random.choice((1, 2, 5, 100))):
        letters[random.randrange(len(letters))] = random.choice(
            "[]{}\"'=.,#\n\x00\x1b\x7f\udcffé9e-"
        )
    return "".join(letters)


def _cut(text: str, random: Random) -> str:
    return text[: random.randrange(len(text) + 1)]


def history(random: Random) -> bytes:
    """Return the file of a load history, damaged, in another layout or encoding."""
    text = "t [s],a [m/s²]\n" + "".join(f"{0.1 * i:g},{i % 3}\n" for i in range(9))
    text = text.replace(",", random.choice((",", ", ", ";", "\t", " ")))
    text = text.replace("\n", random.choice(("\n", "\r\n", "\r")))
    for _ in range(random.choice((0, 1, 1, 2))):
        text = random.choice((_other_number, _other_letters, _cut))(text, random)
    encodings = "utf-8", "utf-8", "utf-8-sig", "utf-16", "utf-32", "cp1252", "cp500"
    whole = text * random.choice((1, 1, 1, 1, 20_000))
    return whole.encode(random.choice(encodings), "replace")


_MUTATIONS: Mapping[Callable[[str, Random], str], float] = {
    _other_value: 8, _other_number: 8, _without_a_line: 1, _one_more_key: 3, _one_more_table: 6,
    _tables_again: 1.5, _other_letters: 1, _cut: 0.5,
}  # fmt: skip

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Damaged and other files in place of a load history."""

import os
from collections.abc import Callable
from pathlib import Path
from random import Random

GOOD = "0.0, 0.0\n0.2, 1.0\n0.5, -0.25\n"


def put(path: Path, random: Random) -> None:
    """Make a file, or another object at its path."""
    random.choice(_KINDS)(path, random)


def _other_numbers(path: Path, random: Random) -> None:
    words = ("nan", "inf", "1e308", "-1e308", "1e-320", "", "x", "0x10", "1_0", "1,5", "٣", "1 2")
    cells = [[f"{0.1 * i:g}", f"{i % 3}"] for i in range(random.choice((1, 2, 3, 50)))]
    for _ in range(random.choice((0, 1, 2))):
        random.choice(cells)[random.randrange(2)] = random.choice(words)
    random.choice(cells).extend(["1"] * random.choice((0, 0, 0, 1, 5000)))
    separator = random.choice((", ", ",", ";", "\t", " "))
    lines = (separator.join(row) for row in cells)
    path.write_text(random.choice(("\n", "\r\n", "\r")).join(lines), encoding="utf-8")


def _other_bytes(path: Path, random: Random) -> None:
    data = bytearray(GOOD.encode())
    for _ in range(random.choice((1, 2, 20))):
        data[random.randrange(len(data))] = random.randrange(256)
    path.write_bytes(random.choice((bytes(data), random.randbytes(random.choice((0, 1, 100_000))))))


def _another_encoding(path: Path, random: Random) -> None:
    path.write_text(GOOD, encoding=random.choice(("utf-8-sig", "utf-16", "utf-32", "cp500")))


def _many_lines(path: Path, random: Random) -> None:
    number = random.choice((1000, 100_000, 100_001, 1_000_000))
    path.write_text("".join(f"{1e-6 * i:.6f},1\n" for i in range(number)), encoding="utf-8")


def _no_file(path: Path, random: Random) -> None:
    makes: tuple[Callable[[Path], object], ...] = (
        os.mkfifo,
        os.mkdir,
        lambda p: os.symlink(random.choice(("/dev/zero", "/dev/random", p)), p),
        lambda p: os.truncate(os.open(p, os.O_CREAT | os.O_RDWR), 10**12),
        lambda p: None,
    )
    random.choice(makes)(path)


_KINDS: tuple[Callable[[Path, Random], None], ...] = (
    _other_numbers, _other_bytes, _another_encoding, _many_lines, _no_file,
)  # fmt: skip

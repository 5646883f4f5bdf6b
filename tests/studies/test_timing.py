# SPDX-License-Identifier: LGPL-3.0-or-later
"""Wall times are taken in turns, and shown with the digits that they have."""

import itertools
from functools import partial

import pytest

from runs.report.formatting import repeated
from studies.cost import timing
from studies.cost.timing import MEASURABLE, time_in_turns


class Clock:
    """Time that passes only where something sleeps: the machine's own load does not count."""

    def __init__(self) -> None:
        self.now = 0.0

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(timing, "perf_counter", lambda: made.now)
    return made


def test_runs_take_turns(clock: Clock) -> None:
    order: list[str] = []

    def slow(name: str) -> None:
        order.append(name)
        clock.sleep(1.1 * MEASURABLE)

    seconds = time_in_turns([partial(slow, "a"), partial(slow, "b")], 2, 10.0)
    assert order == ["a", "b", "a", "b"]
    assert [len(taken) for taken in seconds] == [2, 2]


def test_long_runs_are_not_repeated(clock: Clock) -> None:
    """Reference: analytic. Two sleeps pass the budget, or one does."""
    nap = 1.1 * MEASURABLE
    runs = [partial(clock.sleep, nap), partial(clock.sleep, 0.001)]
    assert [len(taken) for taken in time_in_turns(runs, 3, 1.5 * nap)] == [2, 3]
    assert [len(taken) for taken in time_in_turns(runs, 3, 0.5 * nap)] == [1, 3]


def test_short_runs_are_averaged(clock: Clock) -> None:
    """Reference: analytic. Sleeps of 5 and 15 ms by turns: six of them pass 50 ms."""
    naps = itertools.cycle((0.005, 0.015))
    ((taken,),) = time_in_turns([lambda: clock.sleep(next(naps))], 1, 10.0)
    assert taken == pytest.approx(0.06 / 6)


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ((0.0151, 0.0156, 0.0165), "0.0156"), ((1.0, 1.24, 1.6), "1.2"),
        ((120.0, 134.0, 150.0), "130"), ((1.0, 4.0, 9.0), "~4"), ((0.2, 4.0, 90.0), "~4"),
        ((123.4,), "100"), ((1.0, 1.0), "1"), ((0.0, 0.0), "0"),
    ],
)  # fmt: skip
def test_digits_follow_the_noise(values: tuple[float, ...], text: str) -> None:
    """Reference: half the range by hand; its first digit is the last shown."""
    assert repeated(values) == text

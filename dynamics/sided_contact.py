# SPDX-License-Identifier: LGPL-3.0-or-later
"""A contact that is one law above and another below: plays or pads that differ."""

from __future__ import annotations

from dataclasses import dataclass, field

from dynamics.contact import ContactLaw
from dynamics.contact_term import Term


@dataclass(frozen=True, slots=True)
class SidedContact(ContactLaw):
    """What a law says where the inner segment presses up, and another where it presses down.

    >>> close, far = (pt.PowerContact(1e6, 1.0, clearance=c) for c in (0.004, 0.010))
    >>> SidedContact(close, far).force(np.array([0.005, -0.005]))
    array([1000.,    0.])

    Args:
        above, below: each counts on its own side alone, behind its own clearance.

    Attributes:
        clearance: the smaller one in m.
        damping: of both in s/m.

    Raises:
        ValueError: one of them never touches there, or their dampings differ.
    """

    above: ContactLaw
    below: ContactLaw
    clearance: float = field(init=False)
    damping: float = field(init=False)

    def __post_init__(self) -> None:
        if self.above.one_sided(1) is None or self.below.one_sided(-1) is None:
            raise ValueError("each law must touch on its own side")
        if self.above.damping != self.below.damping:
            raise ValueError(
                f"both laws must have the same damping, got {self.above.damping} and "
                f"{self.below.damping} s/m"
            )
        object.__setattr__(self, "clearance", min(self.above.clearance, self.below.clearance))
        object.__setattr__(self, "damping", self.above.damping)

    @property
    def terms(self) -> tuple[Term, ...]:
        above = (term for term in self.above.terms if term.side > 0.0)
        below = (term for term in self.below.terms if term.side < 0.0)
        return (*above, *below)

    def one_sided(self, side: int) -> ContactLaw | None:
        return (self.above if side > 0 else self.below).one_sided(side)

    def shared(self, weight: float) -> SidedContact:
        return SidedContact(self.above.shared(weight), self.below.shared(weight))

    def behind(self, clearance: float) -> SidedContact:
        """With the smaller clearance in m; the other one stays as much larger."""
        more = clearance - self.clearance
        laws = (law.behind(law.clearance + more) for law in (self.above, self.below))
        return SidedContact(*laws)

    def scaled(self, factor: float) -> SidedContact:
        return SidedContact(self.above.scaled(factor), self.below.scaled(factor))

    def __str__(self) -> str:
        return f"{self.above} above, {self.below} below"

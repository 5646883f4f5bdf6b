# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results with labels, from which a selection is made."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Self, TypeVar

T = TypeVar("T")


class Labelled(tuple[T, ...]):
    """Results with labels such as ``model`` and ``state``."""

    __slots__ = ()

    def where(self, **labels: Hashable | list[str]) -> Self:
        """Return the results with given labels; a list permits several values."""
        wanted = [
            (name, value if isinstance(value, list) else [value]) for name, value in labels.items()
        ]
        return type(self)(
            entry for entry in self if all(getattr(entry, name) in of for name, of in wanted)
        )

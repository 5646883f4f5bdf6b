# SPDX-License-Identifier: LGPL-3.0-or-later
"""Results that are kept for as long as somebody holds them, and never on the disk."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol

from runs.folder.cache import Files, Kept


class Keeper(Protocol):
    """Where results are under the content of what they depend on."""

    def load(self, key: str, read: Callable[[Files], Kept]) -> Kept | None:
        """What ``read`` makes of the files of an entry; None where there is none."""
        ...

    def remember(self, key: str, files: Mapping[str, Sequence[bytes | memoryview]]) -> None:
        """Keep the parts of each file of an entry."""
        ...


class Memory:
    """Entries as :class:`runs.folder.cache.Cache` has them on the disk."""

    def __init__(self) -> None:
        self._entries: dict[str, Files] = {}

    def load(self, key: str, read: Callable[[Files], Kept]) -> Kept | None:
        """As of any keeper; what is read shares its numbers with the entry."""
        files = self._entries.get(key)
        return None if files is None else read(files)

    def remember(self, key: str, files: Mapping[str, Sequence[bytes | memoryview]]) -> None:
        """As of any keeper."""
        whole = {name: bytearray().join(parts) for name, parts in files.items()}
        self._entries[key] = {name: memoryview(content) for name, content in whole.items()}

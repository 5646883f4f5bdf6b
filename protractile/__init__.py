# SPDX-License-Identifier: LGPL-3.0-or-later
"""Public names, imported at the first use of one of them: ``import protractile as pt``."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from protractile.names import *  # noqa: F403
else:

    def __getattr__(name: str) -> Any:
        names = {} if name.startswith("__") else vars(import_module("protractile.names"))
        if name not in names:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return names[name]

    def __dir__() -> list[str]:
        names = vars(import_module("protractile.names"))
        return sorted(name for name in names if not name.startswith("__"))

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Registry of clients: folders of ``runs`` that nothing else imports.

A client adds to cases, reports and the command line by its modules with these names:

* ``keys``: the class ``Keys``, a table of keys at the top of every case file, and if these refer
  to the boom a function ``check`` of the case and its boom, which raises ``BoomError``.
* ``additions``: function ``judge``, and in the first client ``show``, see
  :mod:`.runs.report.additions`.
* ``commands``: the functions ``COMMANDS``, each a command.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from types import ModuleType

CLIENTS = "paper", "live", "export", "chart", "measured"


def modules(name: str) -> list[ModuleType]:
    """Return the modules with this name of all clients that have one."""
    paths = [f"protractile.runs.{client}.{name}" for client in CLIENTS]
    return [import_module(path) for path in paths if find_spec(path)]


def check(case: object, boom: object) -> None:
    """Check the keys of all clients in a case against its boom.

    Raises:
        BoomError: they do not fit.
    """
    for keys in modules("keys"):
        if hasattr(keys, "check"):
            keys.check(case, boom)

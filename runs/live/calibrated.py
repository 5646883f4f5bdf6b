# SPDX-License-Identifier: LGPL-3.0-or-later
"""The beam of the live page, calibrated by a shell of its geometry if the cache has one."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

from geometry.boom import Boom
from runs.case.build import build_boom
from runs.case.checked_case import CheckedCase
from runs.case.kinds.calibration import OF_MOTION, CalibratedTable
from runs.case.kinds.model import BuiltModel
from runs.case.kinds.shell import Shell
from runs.case.schema import Case
from runs.folder.cache import Cache, key
from runs.pipeline.models import build_on, complete_system

if TYPE_CHECKING:
    from beam_model.calibration import Calibration

# Tables that change masses, loads and axial forces, and no stiffness of the unloaded shell.
_LOADS = ("payload", "gravity", "loads", "axial", "base", "hoist", "slew", "luff")

# The last calibration that was computed, by the key of its shell.
_LAST: dict[str, Calibration] = {}


def build_beam(
    checked: CheckedCase, original: Case, shells: Sequence[Shell]
) -> tuple[CheckedCase, BuiltModel, str]:
    """Return the case, its built beam, and a text on the stiffness of the beam.

    The beam is calibrated if the cache has a shell of its geometry.

    Args:
        checked: the checked case.
        original: case of the file, whose shell may be in the cache.
        shells: shells that may calibrate the beam.
    """
    case, boom, (model,) = checked.case, checked.boom, checked.case.models
    with_loads = case.model_copy(update={name: getattr(original, name) for name in _LOADS})
    plates = all(segment.section is not None for segment in boom.segments)
    for shell in shells if plates and not boom.telescopes else ():
        unused: dict[str, object] = dict.fromkeys(OF_MOTION)
        by = shell.model_copy(update=unused)
        beam = model.model_copy(update={"calibrated_by": by, "contact": shell.contact})
        assert isinstance(beam, CalibratedTable)
        if by.contact_line != "near webs":
            continue
        with suppress(ImportError):
            for same in (boom, build_boom(with_loads)):
                if calibration := _stored(beam, by, beam.model_boom(same).boom):
                    calibrated = CheckedCase(case.model_copy(update={"models": (beam,)}))
                    # The property would build the same boom again.
                    vars(calibrated)["boom"] = boom
                    built = beam.build_calibrated(calibrated.model_boom(beam), calibration)
                    built = replace(
                        built, system=complete_system(built.system, case, boom, built.lines)
                    )
                    return calibrated, built, f"calibrated by {shell.name}"
    plain = build_on(checked.model_boom(model), case, model)
    return checked, plain, "of its sections;\nrun the shell to calibrate it"


def _stored(beam: CalibratedTable, shell: Shell, boom: Boom) -> Calibration | None:
    """Return the calibration by the shell of a boom; None if the cache does not have the shell."""
    import petsc4py

    # Otherwise PETSc ends the process where a browser closes a connection.
    petsc4py.init(["-no_signal_handler"])
    from beam_model.calibration import calibrate
    from shell_model.reduced_shell import ReducedShell
    from shell_model.standard import with_plays_and_loads

    name, cache = key([*shell.content(boom)]), Cache.of_user()
    if name not in _LAST and cache is not None and (stored := cache.load(name, ReducedShell)):
        loaded_shell = with_plays_and_loads(stored, boom)
        _LAST.clear()
        _LAST[name] = calibrate(
            boom, loaded_shell.system, loaded_shell.probe_responses, beam.segments
        )
    return _LAST.get(name)

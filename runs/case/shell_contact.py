# SPDX-License-Identifier: LGPL-3.0-or-later
"""Whether the contact that a case asks of a shell can be."""

from __future__ import annotations

from geometry.boom import Boom, BoomError
from runs.case.build import contact_laws, lateral_laws
from runs.case.schema import Case, ShellTable

# Every point of a surface is an input of the reduction and a row of the time loop.
MOST_POINTS = 256


def check_contact(where: str, case: Case, boom: Boom, model: ShellTable) -> None:
    """Check what a model says of its contact.

    Args:
        where: the model's key, ``model[2]`` say.
        case: the model's.
        boom: of the case.
        model: a shell.

    Raises:
        BoomError: a contact line that does not suit the boom, keys that belong to another one, too
            many points, one stiffness for several laws.
    """
    line = model.contact_line
    if boom.spatial and line == "across":
        raise BoomError(
            f"{where}.contact_line",
            "'across' is for a flat boom; in space the segments touch 'near webs' or by 'surface'",
        )
    for number, joint in enumerate(boom.joints, start=1):
        if joint.pad is not None and line != "near webs":
            raise BoomError(
                f"{where}.contact_line",
                f"{line!r} leaves no place to the pads of joint[{number}]; give 'near webs', or "
                "leave pad out",
            )
    if line == "surface":
        _check_surface(where, case, model)
        return
    for key in ("surface_stiffness", "surface_points"):
        if getattr(model, key) is not None:
            raise BoomError(
                f"{where}.{key}",
                f"the segments touch at their stations, {line!r}; leave it out, or give "
                "contact_line = 'surface'",
            )


def _check_surface(where: str, case: Case, model: ShellTable) -> None:
    if model.surface_points is not None:
        along, across = model.surface_points
        if along * across > MOST_POINTS:
            raise BoomError(
                f"{where}.surface_points",
                f"{along} times {across} points on half a wall are more than {MOST_POINTS}, which "
                "a reduced model can bear; give fewer",
            )
    laws = contact_laws(case, model) + lateral_laws(case, model)
    exponents = sorted({term.exponent for law in laws for term in law.terms})
    if model.surface_stiffness is not None and len(exponents) > 1:
        raise BoomError(
            f"{where}.surface_stiffness",
            f"its unit depends on the exponent, and the joints have {exponents[0]:g} and "
            f"{exponents[-1]:g}; leave it out, or give the model its own contact",
        )

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What every table of a case file is, and the tables of which models and joints both have one."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

from runs.case.limits import Exponent, NotNegative, Positive


class Table(BaseModel):
    """A table of the case file: nothing but its own keys, and not changed once read."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class RestitutionTable(Table):
    """How much of its speed a blow gives back."""

    coefficient: Annotated[float, Field(strict=True, gt=0.0, le=1.0)] = Field(
        description="the coefficient of restitution"
    )
    speed: Positive = Field(description="the speed of the impact in m/s at which it holds")


class ContactTable(Table):
    """The contact law that one model uses in all joints, instead of the joints' own."""

    stiffness: Positive = Field(description="the contact stiffness in N/m^n")
    stiffness_below: NotNegative | None = Field(
        None, description="the contact stiffness in N/m^n below; the same as above unless given"
    )
    exponent: Exponent = Field(description="the exponent n of the contact law")
    restitution: RestitutionTable | None = Field(
        None, description="the table of the contact's own damping; none unless given"
    )

# SPDX-License-Identifier: LGPL-3.0-or-later
"""Table and sentences of proofs."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import fill
from typing import NamedTuple

from protractile.analysis.rows import SPECTRUM, Row
from protractile.geometry.units import System
from protractile.runs.case.schema import Case
from protractile.runs.pipeline.proofs import NO_SHELL, Proofs, wall_name
from protractile.runs.report.labels import amount_of
from protractile.runs.report.tables import Column, Table
from protractile.shell_model.stress.history import BAND

# Definition of a proof, for the notes of tables.
DEFINITION = (
    "A proof compares the design effect, left of ≤ in the formulas below, with the limit design "
    "value, right of ≤ (EN 13001-3-1)."
)


class Kind(NamedTuple):
    """Kind of proof."""

    formula: str  #: formula and source
    remedy: str  #: remedy if a proof fails
    effect: str = ""  #: name of the design effect in brackets; empty where the unit suffices


# Kinds of proofs by their quantity.
KINDS: Mapping[str, Kind] = {
    "yield": Kind(
        "√(σ² + 3 τ²) ≤ f_y(t)/γ; σ of outer fibres, τ mean of the wall of thickness t "
        "(EN 1993-1-1, 6.2.1)",
        "thicker walls there, a larger section or stronger steel",
    ),
    "patch": Kind(
        "σ_v ≤ f_y/γ; mean von Mises stress of the shell over half the width of a wall, at "
        f"most {BAND:g} m along x from a station, support, lug or load",
        "a collar or thicker walls there, longer pads, or pads nearer the webs",
    ),
    "plate": Kind(
        "√((σ/ρ)² + 3 (τ/χ)²) ≤ f_y(t)/γ; ρ, χ: reduction factors at the slenderness "
        "√(α_ult,k/α_cr), α_cr by panel formulas (EN 1993-1-5, 10)",
        "a thicker, narrower or stiffened wall there",
        " (stress / reduction factor)",
    ),
    "buckling": Kind(
        "σ_v ≤ ρ f_y/γ; ρ: lower reduction factor of compression and shear at the slenderness "
        "√(f_y/(σ_v α_cr)), α_cr: lowest factor of the shell (EN 1993-1-5, 10)",
        "a thicker, narrower or stiffened wall there, or a collar at the pads",
    ),
    "column": Kind(
        "N ≤ N_cr/γ with closed contacts; other proofs include second-order effects of N",
        "larger sections, a smaller extension or less force along the boom",
    ),
    "pad": Kind(
        "F/(length · width) ≤ allowable pressure/γ; F: force of one pad of a pair, in space of the "
        "one that carries more",
        "longer or wider pads, or a longer overlap",
    ),
    "cylinder": Kind(
        "F ≤ capacity/γ",
        "a larger cylinder, or a longer lever arm to the foot pin",
    ),
    "pin": Kind(
        "F ≤ 0.6 n A f_up/γ; n: number of shear planes (EN 1993-1-8, table 3.10)",
        "a thicker pin, or more shear planes",
    ),
    "deflection": Kind(
        "deflection under the loads of the combination ≤ limits.tip_at_rest",
        "larger sections, less play or a longer overlap",
    ),
    "tipping": Kind(
        "Σ overturning moments ≤ Σ stabilising moments/γ about a tipping line; the load hangs at "
        "the deflected tip",
        "more counterweight, outriggers farther out, or a smaller radius",
    ),
    "fatigue": Kind(
        "Σ n/N ≤ 1, nominal ranges, rainflow and Miner (EN 1993-1-9, 7.1 and A.5)",
        "a better detail, its place at less stress, or fewer repeats",
    ),
}


def holds(row: Row) -> bool:
    """Return True if the design effect does not exceed the limit design value."""
    return (row.utilisation or 0.0) <= 1.0


def proof_text(row: Row, proofs: Proofs, system: System) -> str:
    """Return a sentence with place, numbers and combination, in units of a system."""
    (effect, limit), place = _numbers(row), _place(row)
    relation, name = "≤" if holds(row) else "exceeds", row.of.title
    place = "" if place in name.split() else f", {place}"
    place += "" if row.x is None else f" at x = {system.text(row.x, 'm')}"
    cause, _, label = row.state.partition(" ")
    of = f", {cause} {label!r}" if _label(row, proofs) else ""
    return (
        f"{name}{place}: {effect}{KINDS[row.quantity].effect} {relation} {limit} "
        f"({100.0 * (row.utilisation or 0.0):.3g} %){of}"
    )


def governing_proof(proofs: Proofs, system: System) -> str:
    """Return a sentence on the governing proof and the number of proofs that fail."""
    if not proofs.rows:
        return "The case has no numbers for a proof."
    first = proofs.rows[0]
    change = "" if holds(first) else f". Remedy: {KINDS[first.quantity].remedy}"
    return f"{tally(proofs)}. Governing: {proof_text(first, proofs, system)}{change}."


def tally(proofs: Proofs) -> str:
    """Return the number of proofs that fail, in words, without a full stop."""
    failed = sum(not holds(row) for row in proofs.rows)
    what = f"{len(proofs.rows)} proofs" + (f" of the {proofs.of}" if proofs.of else "")
    text = f"{failed} of {what} fail" if failed else f"All {what} are satisfied"
    return text + ("; local plate stress is not proved" if NO_SHELL in proofs.notes else "")


def proof_table(proofs: Proofs, case: Case) -> Table:
    """Return the table of proofs, the governing one first."""
    rows, system = proofs.rows, case.system
    numbers = [_numbers(row) for row in rows]
    # Narrow columns keep the table within 80 characters.
    at = ["" if row.x is None else f"\n{system.text(row.x, 'm')}" for row in rows]
    used = [
        f"{100.0 * (row.utilisation or 0.0):.3g} % {'✓' if holds(row) else '✗'}" for row in rows
    ]
    labels = [_label(row, proofs).replace(", ", ",\n") for row in rows]
    columns = [
        Column("proof of", [fill(row.of.title, 12) for row in rows]),
        Column("place, x", [fill(_place(row), 20) + x for row, x in zip(rows, at, strict=True)]),
        Column("design\neffect", [effect for effect, _ in numbers]),
        Column("limit\nvalue", [limit for _, limit in numbers]),
        Column("utilis-\nation", used),
        Column("combination,\nspectrum", labels),
    ]
    titles = {row.quantity: row.of.title for row in rows}
    formulas = [f"{title.capitalize()}: {KINDS[kind].formula}." for kind, title in titles.items()]
    notes = [DEFINITION, *formulas, *proofs.notes]
    return Table("Proofs", columns, notes, "proofs", [line for line in used if "✗" in line])


def _numbers(row: Row) -> tuple[str, str]:
    """Return design effect and limit design value as text."""
    assert row.limit is not None
    effect, limit = (amount_of(row.of, value) for value in (row.value, row.limit))
    return effect, limit


def _place(row: Row) -> str:
    """Return the part, and the wall or the side of a pad."""
    wall = row.quantity in ("yield", "plate", "buckling")
    place = wall_name(row.place) if wall else row.place.rpartition(", ")[2]
    return ", ".join(filter(None, (row.part, place)))


def _label(row: Row, proofs: Proofs) -> str:
    """Return the name of the combination or of the spectrum; empty for the case itself."""
    of_case = not (proofs.of or row.state.startswith(SPECTRUM))
    return "" if of_case else row.state.partition(" ")[2]

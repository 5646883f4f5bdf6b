# SPDX-License-Identifier: LGPL-3.0-or-later
"""Tables of the reference, from the schema of case files and the help of the command line."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import typer

from protractile.runs import cli
from protractile.runs.case.schema import Case, case_schema

SCHEMA = case_schema()
#: Tables of which [joints], [segments] and based_on do not take keys.
WHOLE = Case.model_json_schema()["$defs"]
FOLDER = Path(__file__).parent / "generated"
#: Drawings for the tables that they explain.
DRAWINGS = {
    "SegmentTable": ("boom", "Lengths and places along a boom"),
    "SectionTable": ("sections", "Sections by the mid-lines of their plates"),
    "JointTable": ("station", "Play, pads and walls in a cross-section at a station"),
    "SlidePad": ("pads", "Pads in an overlap, from the side"),
    "Cylinder": ("cylinder", "A luffing cylinder, and the pin of the foot"),
}


def _tables_in(entry: Any) -> list[str]:
    """Return the names of the tables that an entry of the schema refers to, in their order."""
    if isinstance(entry, dict):
        here = [entry["$ref"].rsplit("/", 1)[1]] if isinstance(entry.get("$ref"), str) else []
        return here + _tables_in(list(entry.values()))
    if isinstance(entry, list):
        return [name for value in entry for name in _tables_in(value)]
    return []


def _kind(name: str) -> str | None:
    """Return the kind of a model or the shape of a section that a table describes, if any."""
    keys = SCHEMA["$defs"][name]["properties"]
    entry = keys.get("kind", keys.get("shape", {}))
    return entry.get("const") or (entry.get("default") if "shape" in keys else None)


def _type(entry: dict[str, Any]) -> str:
    """Return the type of a value, as Markdown."""
    if "const" in entry:
        return f'`"{entry["const"]}"`'
    if "enum" in entry:
        values = [f'`"{value}"`' for value in entry["enum"]]
        return " or ".join(values) if len(values) < 5 else f"{values[0]} … {values[-1]}"
    if "$ref" in entry:
        name = _tables_in(entry)[0]
        return f"[{_kind(name) or 'table'}](#{name.lower()})"
    for choice in ("anyOf", "oneOf"):
        if choice in entry:
            if any(option.get("$ref", "").endswith("/Distance") for option in entry[choice]):
                return "[place](#places)"
            types = [_type(option) for option in entry[choice] if option.get("type") != "null"]
            return " or ".join(dict.fromkeys(types))
    if entry.get("type") == "array":
        if "prefixItems" in entry:
            return f"[{', '.join(_type(item) for item in entry['prefixItems'])}]"
        return f"list of {_type(entry['items'])}" if "items" in entry else "list"
    if entry.get("type") == "object":
        return f"table of {_type(entry['additionalProperties'])}"
    if entry["type"] == ["number", "string"]:
        return "number"
    return {"boolean": "true or false"}.get(entry["type"], entry["type"])


def _row(key: str, entry: dict[str, Any], required: bool) -> str:
    """Return the row of a key: its name, type, default and meaning."""
    default = entry.get("default")
    shown = "required" if required else ""
    if isinstance(default, bool):
        shown = str(default).lower()
    elif isinstance(default, (int, float)):
        shown = f"{default:g}"
    elif isinstance(default, str):
        shown = f'`"{default}"`'
    cells = (f"`{key}`", _type(entry), shown, entry.get("description", ""))
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _section(heading: str, name: str, table: dict[str, Any]) -> Iterator[str]:
    """Yield the lines of a table's section."""
    yield f"({name.lower()})="
    yield f"### {heading}\n"
    if name in DRAWINGS:
        picture, caption = DRAWINGS[name]
        yield f"![{caption}](drawings/{picture}.svg)\n"
    if "description" in table:
        yield f"{table['description']}\n"
    yield "| key | type | default | meaning |\n| :-- | :-- | :-- | :-- |"
    required = WHOLE.get(name, table).get("required", ())
    for key, entry in table["properties"].items():
        yield _row(key, entry, key in required)
    yield ""


def case_tables() -> str:
    """Return one section for each table of a case file, with a row for each of its keys.

    Sections follow the order of the keys; tables inside others come after them.
    """
    lines = list(_section("Top of the file", "Case", SCHEMA))
    listed = {"Distance"}

    def write(path: str, entry: dict[str, Any]) -> None:
        new = [name for name in dict.fromkeys(_tables_in(entry)) if name not in listed]
        listed.update(new)
        for name in new:
            kind = _kind(name)
            heading = f"`{path}`, {kind}" if kind else f"`{path}`"
            lines.extend(_section(heading, name, SCHEMA["$defs"][name]))
        for name in new:
            for key, inner in SCHEMA["$defs"][name]["properties"].items():
                write(f"{path.strip('[]')}.{key}", inner)

    for key, entry in SCHEMA["properties"].items():
        write(f"[[{key}]]" if entry.get("type") == "array" else f"[{key}]", entry)
    lines.extend(_section("Place, as a table", "Distance", SCHEMA["$defs"]["Distance"]))
    return "\n".join(lines)


def commands() -> str:
    """Return one section for each command, with its arguments and options."""
    group = typer.main.get_command(cli.app)
    lines = []
    for name, command in group.commands.items():
        usage = " ".join(f"{x.metavar}" for x in command.params if x.param_type_name == "argument")
        lines += [f"### `protractile {name}{' ' * bool(usage)}{usage}`\n", f"{command.help}\n"]
        options = [x for x in command.params if x.param_type_name == "option"]
        if options:
            lines += ["| option | meaning |", "| :-- | :-- |"]
        for option in options:
            value = f" {option.metavar}" if option.metavar and not option.is_flag else ""
            help_text = (option.help or "").replace("\\[", "[").replace("|", "\\|")
            lines.append(
                f"| `{option.opts[0]}{value}` | {help_text} |".replace("N|auto", "N\\|auto")
            )
        lines.append("")
    return "\n".join(lines)


def write(folder: Path = FOLDER) -> None:
    """Write ``case-tables.md`` and ``commands.md`` into a folder."""
    folder.mkdir(exist_ok=True)
    (folder / "case-tables.md").write_text(case_tables(), encoding="utf-8")
    (folder / "commands.md").write_text(commands(), encoding="utf-8")

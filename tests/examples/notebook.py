# SPDX-License-Identifier: LGPL-3.0-or-later
"""Execution of notebooks without Jupyter: ``python -m tests.examples.notebook FILE.ipynb``.

It replaces the outputs in the file, as *Run All* of Jupyter does.
"""

import ast
import json
import sys
from base64 import b64encode
from collections.abc import Iterator
from contextlib import redirect_stdout
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt

Cell = dict[str, Any]

# Lines of an output beyond which it is not compared.
_LONG = 20


def code_cells(notebook: dict[str, Any]) -> list[Cell]:
    """Return the cells with code."""
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "code"]


def run_cell(cell: Cell, names: dict[str, Any], count: int) -> Iterator[Cell]:
    """Run a cell, and yield its outputs: printed text, the last value, figures."""
    body = ast.parse("".join(cell["source"])).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    value = None
    with redirect_stdout(StringIO()) as printed:
        exec(compile(ast.Module(body, []), "cell", "exec"), names)
        if isinstance(last, ast.Expr):
            value = eval(compile(ast.Expression(last.value), "cell", "eval"), names)
    if text := printed.getvalue():
        yield {"output_type": "stream", "name": "stdout", "text": text.splitlines(True)}
    if value is not None:
        data = {"text/plain": repr(value).splitlines(True)}
        if hasattr(value, "_repr_html_"):
            data["text/html"] = value._repr_html_().splitlines(True)
        yield {
            "output_type": "execute_result", "execution_count": count, "metadata": {}, "data": data
        }  # fmt: skip
    for number in plt.get_fignums():
        picture = BytesIO()
        plt.figure(number).savefig(picture, format="png", dpi=72, bbox_inches="tight")
        data = {"image/png": b64encode(picture.getvalue()).decode()}
        yield {"output_type": "display_data", "metadata": {}, "data": data}
    plt.close("all")


def run(notebook: dict[str, Any]) -> dict[str, Any]:
    """Run all cells, replace their outputs, and return their names."""
    names: dict[str, Any] = {"__name__": "__main__"}
    for count, cell in enumerate(code_cells(notebook), start=1):
        cell |= {"execution_count": count, "outputs": [*run_cell(cell, names, count)]}
    return names


def plain(cell: Cell) -> list[str]:
    """Return the lines of text in a cell's outputs.

    Long outputs are left out: they are the tables of ``check``, which have tests of their own.
    """
    texts = [out.get("text") or out["data"].get("text/plain", []) for out in cell["outputs"]]
    return [line.rstrip() for text in texts if len(text) <= _LONG for line in text]


if __name__ == "__main__":
    plt.switch_backend("agg")
    file = Path(sys.argv[1])
    content = json.loads(file.read_text("utf-8"))
    run(content)
    file.write_text(json.dumps(content, indent=1, ensure_ascii=False) + "\n", "utf-8")

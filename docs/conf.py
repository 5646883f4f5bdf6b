# SPDX-License-Identifier: LGPL-3.0-or-later
"""Configuration of Sphinx for `make docs`: Markdown pages, API pages from docstrings."""

from __future__ import annotations

import re
import sys
import tomllib
from inspect import getdoc
from pathlib import Path
from typing import get_type_hints

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.ext.napoleon import GoogleDocstring
from sphinx.writers.html5 import HTML5Translator

import protractile

sys.path.insert(0, str(Path(__file__).parent))

import reference

reference.write()

pyproject = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())

project = pyproject["project"]["name"]
release = version = pyproject["project"]["version"]
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
]
exclude_patterns = ["_templates", "generated"]
templates_path = ["_templates"]

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
autodoc_default_options = {"members": True, "ignore-module-all": True, "show-inheritance": True}
# Public names of `import protractile`, by the modules that document them.
public = [getattr(protractile, name) for name in dir(protractile)]
autosummary_context = {
    "public": [f"{x.__module__}.{x.__qualname__}" for x in public if hasattr(x, "__qualname__")]
}
autodoc_member_order = "bysource"
napoleon_numpy_docstring = False
add_module_names = False
python_use_unqualified_type_names = True
toc_object_entries = False  # functions in the navigation of every page take half the time

html_theme = "furo"
html_title = f"{project} {release}"
html_show_copyright = False
html_math_renderer = "mathml"


def write_inline(writer: HTML5Translator, node: nodes.math) -> None:
    """Write an inline formula as MathML, which browsers render without a script."""
    writer.body.append(convert(node.astext()))
    raise nodes.SkipNode


def write_block(writer: HTML5Translator, node: nodes.math_block) -> None:
    """Write a display formula as MathML, with room for parts that exceed its box."""
    formula = convert(node.astext(), display="block")
    writer.body.append(f'<div style="padding: 0.4em 0">{formula}</div>')
    raise nodes.SkipNode


def resolve_fields(app: Sphinx, of: object, bound: bool) -> None:
    """Resolve the types of a NamedTuple's fields in its module.

    The annotations of its `__new__` are bare names, which classes of two modules may share.
    """
    for made in tuple.__subclasses__():
        if made.__new__ is of:
            of.__annotations__ = get_type_hints(made)


def name_arrays(
    app: Sphinx, what: str, name: str, of: object, options: object, arguments: str, result: str
) -> tuple[str, str]:
    """Replace `Array` in signatures by its name in the modules."""
    array = re.compile(r"~?(numpy\.)?ndarray\[[^]]*float64\]\]")
    return tuple(text and array.sub("Array", text) for text in (arguments, result))


def read_properties(
    app: Sphinx, what: str, name: str, of: object, options: object, lines: list[str]
) -> None:
    """Read a property's text as a method's: a colon in its first line then starts no type."""
    if what == "property" and lines:
        text = getdoc(of) or ""
        lines[:] = GoogleDocstring(text, app.config, app, "method", name, of, options).lines()


def read_formulas(
    app: Sphinx, what: str, name: str, of: object, options: object, lines: list[str]
) -> None:
    """Read |x| as an absolute value, not a substitution; indented text of a module as formulas."""
    text = re.sub(r"(``.*?``)|\|", lambda found: found[1] or r"\|", "\n".join(lines))
    if what == "module":
        text = re.sub(r"\n\n(?=    )", "\n\n::\n\n", text)
    lines[:] = text.split("\n")


def setup(app: Sphinx) -> None:
    """Register the functions above with Sphinx."""
    app.add_html_math_renderer("mathml", (write_inline, None), (write_block, None))
    app.connect("autodoc-before-process-signature", resolve_fields)
    app.connect("autodoc-process-signature", name_arrays)
    app.connect("autodoc-process-docstring", read_properties)
    app.connect("autodoc-process-docstring", read_formulas)

# SPDX-License-Identifier: LGPL-3.0-or-later
"""What `make docs` asks of Sphinx: pages in Markdown, the library's pages from its docstrings."""

from __future__ import annotations

import re
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

pyproject = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())

project = pyproject["project"]["name"]
release = version = pyproject["project"]["version"]
extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.napoleon",
]
exclude_patterns = ["_templates"]
templates_path = ["_templates"]

myst_enable_extensions = ["dollarmath"]
autodoc_default_options = {"members": True, "ignore-module-all": True, "show-inheritance": True}
# What `import protractile` gives, by the places where it is documented.
public = [getattr(protractile, name) for name in dir(protractile)]
autosummary_context = {
    "public": [f"{x.__module__}.{x.__qualname__}" for x in public if hasattr(x, "__qualname__")]
}
autodoc_member_order = "bysource"
napoleon_numpy_docstring = False
add_module_names = False
python_use_unqualified_type_names = True
toc_object_entries = False  # every function in every page's navigation takes half the time

html_theme = "furo"
html_title = f"{project} {release}"
html_show_copyright = False
html_math_renderer = "mathml"


def write_inline(writer: HTML5Translator, node: nodes.math) -> None:
    """A formula in a line as MathML, which browsers set without a script."""
    writer.body.append(convert(node.astext()))
    raise nodes.SkipNode


def write_block(writer: HTML5Translator, node: nodes.math_block) -> None:
    """A formula on lines of its own, with room for what reaches beyond its box."""
    formula = convert(node.astext(), display="block")
    writer.body.append(f'<div style="padding: 0.4em 0">{formula}</div>')
    raise nodes.SkipNode


def resolve_fields(app: Sphinx, of: object, bound: bool) -> None:
    """The types of a NamedTuple's fields, from its module: what its `__new__` says are bare names,
    which may be those of classes in two modules.
    """
    for made in tuple.__subclasses__():
        if made.__new__ is of:
            of.__annotations__ = get_type_hints(made)


def name_arrays(
    app: Sphinx, what: str, name: str, of: object, options: object, arguments: str, result: str
) -> tuple[str, str]:
    """`Array` in signatures, as the modules have it."""
    array = re.compile(r"~?(numpy\.)?ndarray\[[^]]*float64\]\]")
    return tuple(text and array.sub("Array", text) for text in (arguments, result))


def read_properties(
    app: Sphinx, what: str, name: str, of: object, options: object, lines: list[str]
) -> None:
    """A property's text as a method's: its first line may have a colon, before which is no type."""
    if what == "property" and lines:
        text = getdoc(of) or ""
        lines[:] = GoogleDocstring(text, app.config, app, "method", name, of, options).lines()


def read_formulas(
    app: Sphinx, what: str, name: str, of: object, options: object, lines: list[str]
) -> None:
    """|x| is an absolute value, not a substitution; what a module's text indents is a formula."""
    text = re.sub(r"(``.*?``)|\|", lambda found: found[1] or r"\|", "\n".join(lines))
    if what == "module":
        text = re.sub(r"\n\n(?=    )", "\n\n::\n\n", text)
    lines[:] = text.split("\n")


def setup(app: Sphinx) -> None:
    """Tell Sphinx of the functions above."""
    app.add_html_math_renderer("mathml", (write_inline, None), (write_block, None))
    app.connect("autodoc-before-process-signature", resolve_fields)
    app.connect("autodoc-process-signature", name_arrays)
    app.connect("autodoc-process-docstring", read_properties)
    app.connect("autodoc-process-docstring", read_formulas)

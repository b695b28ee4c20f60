"""Sphinx extension: fills the blocks of pages (pages.py), renders docstrings (docstrings.py), and sees to it that every
public name is documented and every table of the case file shown."""

from __future__ import annotations

import inspect
import shutil
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import docstrings
import keys
import pages
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util import logging

logger = logging.getLogger(__name__)
MODULES = ("houle", "houle.analysis", "houle.design")


def work_folder(app: Sphinx, docname: str) -> Path:
    """Where the commands of a page are run: beside the site."""
    return Path(app.outdir).parent / "run" / docname


def fill(app: Sphinx, docname: str, source: list[str]) -> None:
    page = pages.Page(Path(app.env.doc2path(docname)), work_folder(app, docname))
    try:
        source[0] = pages.filled(source[0], page)
    except (ValueError, KeyError) as error:
        logger.error("%s", error, location=docname)
    for path in page.sources:
        app.env.note_dependency(str(path), docname=docname)
    shown = app.env.__dict__.setdefault("houle_shown", {})
    shown[docname] = (page.tables, page.names)


def plain(app: Sphinx, what: str, name: str, value: Any, options: Any, lines: list[str]) -> None:
    lines[:] = docstrings.rst(lines)


def short(app: Sphinx, what: str, name: str, value: Any, options: Any, signature: str, returns: str) -> Any:
    """No signature for classes: houle makes them, and what they hold is in their docstrings.

    Of a design formula the names and what is taken where they are left out: kinds and units are in its docstring.
    """
    if what == "function" and name.startswith("houle.design."):
        given = inspect.signature(value).parameters.values()
        bare = (p.replace(annotation=inspect.Parameter.empty) for p in given)
        return str(inspect.Signature(list(bare))), None
    return ("", None) if what == "class" else None


def complete(app: Sphinx, env: BuildEnvironment) -> None:
    """Warns of each public name and each table that no page shows."""
    shown = env.__dict__.get("houle_shown", {}).values()
    names = {name for _, found in shown for name in found}
    tables = {table for found, _ in shown for table in found}
    for module in MODULES:
        for name in import_module(module).__all__:
            if f"{module}.{name}" not in names:
                logger.warning("%s.%s is public and on no page of docs/api", module, name)
    for table in {*keys.tables(), *keys.parts()} - tables:
        logger.warning("[%s] is a table of the case file and on no page", table)


def copy_formulas(app: Sphinx, error: Exception | None) -> None:
    """Puts the part of MathJax that pages need beside them, so that formulas need no network."""
    found = find_spec("sphinx-mathjax-offline")
    if error is not None or app.builder.format != "html" or found is None or found.origin is None:
        return
    source, target = Path(found.origin).parent / "static" / "mathjax", Path(app.outdir) / "_static" / "mathjax"
    target.mkdir(parents=True, exist_ok=True)
    shutil.copy(source / "tex-chtml.js", target)
    for part in ("output/chtml/fonts", "input/tex"):
        shutil.copytree(source / part, target / part, dirs_exist_ok=True)


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("source-read", fill)
    app.connect("autodoc-process-docstring", plain)
    app.connect("autodoc-process-signature", short)
    app.connect("env-check-consistency", complete)
    app.connect("build-finished", copy_formulas)
    return {"version": "1", "parallel_read_safe": False, "parallel_write_safe": True}

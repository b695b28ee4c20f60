"""The types of the core that mypy knows, src/houle/_core.pyi, are those of the module that is imported."""

from __future__ import annotations

import difflib
import importlib.util
import re
from pathlib import Path

import pytest

from houle import _core

ROOT = Path(__file__).parents[2]
STUB = ROOT / "src" / "houle" / "_core.pyi"


def test_the_stub_is_that_of_the_module():
    pytest.importorskip("nanobind")
    spec = importlib.util.spec_from_file_location("stub", ROOT / "bind" / "stub.py")
    assert spec and spec.loader
    writer = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(writer)
    kept, made = STUB.read_text(encoding="utf-8").splitlines(), writer.stub().splitlines()
    changes = "\n".join(difflib.unified_diff(kept, made, "_core.pyi", "the module", lineterm="", n=1))
    assert kept == made, f"python bind/stub.py writes it anew\n{changes}"


def test_the_stub_names_everything_in_the_module():
    text = STUB.read_text(encoding="utf-8")
    told = set(re.findall(r"^(?:def |class |)(\w+)(?=[(:])", text, re.MULTILINE))
    assert {name for name in dir(_core) if not name.startswith("_")} <= told


def test_no_function_of_the_stub_takes_anything():
    """The overload that says which argument does not fit would let mypy pass every call."""
    text = STUB.read_text(encoding="utf-8")
    assert "*args" not in text and "**kwargs" not in text
    signatures = text.partition("\nclass ")[2]
    assert "NDArray[" in signatures and not re.search(r"NDArray(?!\[)", signatures)

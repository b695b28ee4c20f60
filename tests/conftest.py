"""Shared by all tests. This file makes pytest put tests/ on the path: the NumPy twins are imported from there."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from hypothesis import settings

from houle import _core

settings.register_profile("houle", deadline=None, derandomize=True)
settings.load_profile("houle")


@pytest.fixture(autouse=True)
def number_of_threads() -> Iterator[None]:
    """What a test sets, the next one does not see."""
    before = _core.get_threads()
    yield
    _core.set_threads(before)

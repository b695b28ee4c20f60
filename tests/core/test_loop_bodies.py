"""Loop bodies of the core are copies of numbers and pointers: nothing of the caller is reached from inside of them.

The compiler checks that a body has nothing to destroy (parallel_for) and, in no_stack.cpp, whether a body reads memory
of the one who called. What it cannot see is read here from the text: references and `this` in what bodies capture.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

CORE = Path(__file__).parents[2] / "core" / "houle"
HEADERS = sorted(CORE.rglob("*.hpp"))

# What calls its arguments as loop bodies, and of those the argument that is called by the one who calls.
VERBS = (
    r"parallel_\w+|for_rows|sweep|in_turn|each_slab|each_row|scatter|reduce|sums?_by_four|sum_of_faces|between_gates"
)
BY_THE_CALLER = {"in_turn": 2, "parallel_in_turn": 3}


def closing(text: str, at: int) -> int:
    """Where the bracket at `at` closes."""
    depth = 0
    for i in range(at, len(text)):
        depth += (text[i] in "([{") - (text[i] in ")]}")
        if depth == 0:
            return i
    raise AssertionError("a bracket is left open")


def arguments(text: str) -> list[str]:
    """The arguments of a call, split at the commas between them."""
    parts, depth, begin = [], 0, 0
    for i, c in enumerate(text):
        depth += (c in "([{") - (c in ")]}")
        if c == "," and depth == 0:
            parts.append(text[begin:i].strip())
            begin = i + 1
    return [*parts, text[begin:].strip()]


def bodies(text: str) -> Iterator[tuple[str, str]]:
    """(verb, lambda) of every loop body: written in the call, or before it under the name that the call gives."""
    for call in re.finditer(rf"\b({VERBS})(?:<[^()<>]*>)?\(", text):
        inside = text[call.end() : closing(text, call.end() - 1)]
        for k, argument in enumerate(arguments(inside)):
            if BY_THE_CALLER.get(call[1]) == k:
                continue
            if argument.startswith("["):
                yield call[1], argument
            elif re.fullmatch(r"\w+", argument):
                named = [m.start(1) for m in re.finditer(rf"\b{argument} = (\[)", text[: call.start()])]
                for at in named[-1:]:
                    yield call[1], text[at : closing(text, text.index("{", at)) + 1]


def faults(text: str) -> list[str]:
    """What loop bodies of a source reach of their caller. Members end with an underscore."""
    text = re.sub(r"//.*", "", text)
    found = [m[0] for m in re.finditer(r"= this;|\bauto ?\* ?\w+ = &\w+", text)]
    for verb, body in bodies(text):
        captures = body[1 : closing(body, 0)]
        members = re.findall(r"\b[a-z]\w*_\b|\bthis\b", body)
        if "&" in captures or members:
            found.append(f"{verb}([{captures}] ...) {' '.join(members)}".strip())
    return found


@pytest.mark.parametrize("header", HEADERS, ids=lambda path: path.name)
def test_loop_bodies_capture_by_value(header):
    assert not faults(header.read_text(encoding="utf-8"))


def test_there_are_bodies_to_look_at():
    assert sum(len(list(bodies(h.read_text(encoding="utf-8")))) for h in HEADERS) > 100


@pytest.mark.parametrize(
    "fault",
    [
        "parallel_for(n, [=, &l](index i) { to[i] = l.at(i); });",
        "parallel_for(n, [this](index i) { fill(i); }, 16);",
        "parallel_for(n, [=](index i) { to[i] = from_[i]; });",
        "auto* self = this; parallel_for(n, [=](index i) { self->fill(i); });",
        "auto* l = &layout; parallel_for(n, [=](index i) { l->fill(i); });",
        "const auto body = [&](index i) { to[i] = from[i]; };\n parallel_for(n, body);",
        "each_slab(g, start, [&](index begin, index end) { add(begin, end); });",
        "in_turn(l, 2, before, [&](int k, const Slices& part) { relax(k, part); });",
    ],
)
def test_a_fault_is_found(fault):
    assert faults(fault)


@pytest.mark.parametrize(
    "right",
    [
        "parallel_for(n, [=](index i) { each([&](index j) { to[j] += w; }); });",
        "in_turn(l, 2, [&](int k) { exchange(l, k); }, [=](int k, const Slices& part) { relax(k, part); });",
        "const double sum = parallel_sum(n, [taken = each.data()](index r) { return taken[r]; });",
    ],
)
def test_what_is_right_is_not_a_fault(right):
    assert not faults(right)

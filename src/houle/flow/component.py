"""State that is owned: each part of a run answers `state` with all that the next step depends on in it, and takes it
back with `restore`.

A checkpoint is the tree of these answers. The names of a part stand under the name of the part, after a slash:
"flow/boundaries/0/x". A run that was restored goes on bitwise as if it had never stopped, which holds only if nothing
is left out: tests/physics/test_owned_state.py compares all that can be reached from two simulations.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

State = dict[str, NDArray[Any]]


class Component:
    """A part of a run: it writes `state` and `restore` if it has state of its own, `parts` if it has parts.

    on_rows   names of its own state whose last axis are rows of cells; of "velocity.0" the name is "velocity"
    """

    on_rows: ClassVar[tuple[str, ...]] = ()

    def parts(self) -> Mapping[str, Component]:
        """Its parts by the names under which their state stands."""
        return {}

    def state(self) -> State:
        """Everything in it and its parts that the next step depends on; arrays are not copied."""
        return {f"{name}/{key}": value for name, part in self.parts().items() for key, value in part.state().items()}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Goes on from a `state` of the same component."""
        for name, part in self.parts().items():
            part.restore(under(name, state))

    def raised(self, state: Mapping[str, NDArray[Any]], rows: int) -> State:
        """A `state` of it with so many more rows of cells, which are empty."""
        found = {key: value for key, value in state.items() if "/" not in key}
        for key, value in found.items():
            if key.partition(".")[0] in self.on_rows:
                found[key] = raised(value, rows)
        for name, part in self.parts().items():
            found |= {f"{name}/{key}": value for key, value in part.raised(under(name, state), rows).items()}
        return found


def under(name: str, state: Mapping[str, NDArray[Any]]) -> State:
    """The state of the part of this name, out of that of the whole."""
    start = f"{name}/"
    return {key.removeprefix(start): value for key, value in state.items() if key.startswith(start)}


def raised(values: NDArray[Any], rows: int) -> NDArray[Any]:
    """A field on cells or faces with so many more rows above, which are 0."""
    return np.pad(values, [(0, 0)] * (values.ndim - 1) + [(0, rows)])

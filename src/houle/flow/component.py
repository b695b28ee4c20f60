"""State that is owned: each part of a run gives its state with `state` and takes it back with `restore`.

The state is everything in the part that the next step depends on. A checkpoint is the tree of the states: the names in
a part stand after the name of the part and a slash, as in "flow/boundaries/0/x". A run that was restored goes on
bitwise as if it had never stopped. This holds only if nothing is left out: tests/physics/test_owned_state.py compares
all that can be reached from two simulations.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

State = dict[str, NDArray[Any]]


class Component:
    """A part of a run: it overrides `state` and `restore` if it has state of its own, `parts` if it has parts.

    on_rows   names in its own state of fields on the grid, which get more rows of cells as the water rises; the name
              of "velocity.0" is "velocity"
    """

    on_rows: ClassVar[tuple[str, ...]] = ()

    def parts(self) -> Mapping[str, Component]:
        """The parts, by the names under which their states stand."""
        return {}

    def state(self) -> State:
        """Everything in it and its parts that the next step depends on; arrays are not copied."""
        return {f"{name}/{key}": value for name, part in self.parts().items() for key, value in part.state().items()}

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Goes on from a `state` of the same component."""
        for name, part in self.parts().items():
            part.restore(under(name, state))

    def raised(self, state: Mapping[str, NDArray[Any]], rows: int) -> State:
        """A `state` with this number of empty rows of cells added on top."""
        found = {key: value for key, value in state.items() if "/" not in key}
        for key, value in found.items():
            if key.partition(".")[0] in self.on_rows:
                found[key] = raised(value, rows)
        for name, part in self.parts().items():
            found |= {f"{name}/{key}": value for key, value in part.raised(under(name, state), rows).items()}
        return found


def under(name: str, state: Mapping[str, NDArray[Any]]) -> State:
    """The state of the part with this name, from the state of the whole."""
    start = f"{name}/"
    return {key.removeprefix(start): value for key, value in state.items() if key.startswith(start)}


def raised(values: NDArray[Any], rows: int) -> NDArray[Any]:
    """A field on cells or faces with this number of rows of zeros added on top."""
    return np.pad(values, [(0, 0)] * (values.ndim - 1) + [(0, rows)])

"""Faces whose velocity is prescribed: of a moving wall, of an open side. Hook of the projection, `flow.driven`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from houle.flow.state import Flow


class Driven(Protocol):
    """What `projection.project` asks of each entry of `flow.driven`, in this order."""

    def feed(self, flow: Flow) -> None:
        """After the pressure system: adds the flux through its faces into the cells, flow.work.rhs [1/s]."""

    def impose(self, flow: Flow) -> None:
        """After the pressure gradient was taken off: sets the velocity of its faces and marks them valid."""

    def power(self, flow: Flow) -> float:
        """Power of the pressure on its faces, over the density: pressure times flux into the water [m^d m2/s3]."""

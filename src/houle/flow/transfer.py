"""Particle <-> grid transfers. To add one: copy the shortest class, change its two methods, add a line to `make`.

Each strategy has
    to_grid(flow)              particle velocities -> flow.velocity and flow.work.face_mass
    to_particles(flow)         flow.velocity -> particle velocities, at the positions of to_grid
    renew(flow)                after the particles were replaced by new ones
and names in `columns` what it keeps for each particle besides the velocity (particles.py).
The mass of a particle in a transfer is its bulk volume V/n, so that what is conserved is sum V/n u_d = sum V u.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from houle import _core
from houle.flow.particles import Column
from houle.grid import Faces, FloatArray

if TYPE_CHECKING:
    from houle.flow.state import Flow


class Transfer(Protocol):
    def columns(self, dimension: int) -> tuple[Column, ...]: ...

    def to_grid(self, flow: Flow) -> None: ...

    def to_particles(self, flow: Flow) -> None: ...

    def renew(self, flow: Flow) -> None: ...


def _cloud(flow: Flow) -> tuple:
    return flow.grid.core, flow.kernel, flow.particles.position, flow.side, flow.bulk, flow.start


def interpolate(flow: Flow, faces: Faces, out: FloatArray) -> None:
    """A field on the faces at the particles (N, d), as they see velocities."""
    _core.to_particles(*_cloud(flow), faces, [], [], 0.0, out, flow.interfaces)


class Pic:
    """The velocity of a particle is the grid's: stable and very dissipative (Harlow 1955)."""

    def columns(self, dimension: int) -> tuple[Column, ...]:
        """Nothing is kept for each particle."""
        return ()

    def to_grid(self, flow: Flow) -> None:
        _core.to_faces(
            *_cloud(flow), flow.particles.velocity, None, flow.velocity, flow.work.face_mass, flow.interfaces
        )

    def to_particles(self, flow: Flow) -> None:
        interpolate(flow, flow.velocity, flow.particles.velocity)
        flow.interpolated = flow.kernel == "linear"

    def renew(self, flow: Flow) -> None:
        """There is nothing to make anew."""


class Fmpm(Pic):
    """PIC with the full mass matrix, inverted to `order` terms: FMPM(k), Nairn & Hammerquist (2021).

    The face velocities are those whose interpolation is nearest to the particles', in the norm of kinetic energy. A
    term more filters less: order 1 is PIC, order -> infinity the conservative l2 projection (Maljaars et al. 2018).
    Neither adds kinetic energy nor keeps, as FLIP does, velocities that the grid cannot see.
    """

    def __init__(self, order: int) -> None:
        self.order = order

    def to_grid(self, flow: Flow) -> None:
        p = flow.particles
        if flow.kernel == "linear":
            spaces = (flow.velocity, flow.work.face_mass, flow.old_velocity, flow.work.store, flow.interfaces)
            flow.work.mass_matrix.transfer(p.position, flow.bulk, flow.start, p.velocity, self.order, *spaces)
            return
        super().to_grid(flow)
        for _ in range(1, self.order):
            faces = (flow.work.face_mass, flow.velocity, flow.old_velocity)
            _core.add_residual(*_cloud(flow), p.velocity, *faces, flow.interfaces)


class Flip(Pic):
    """Particles keep their velocity and take the change of the grid's (Brackbill & Ruppel 1986), blended with PIC."""

    def __init__(self, share: float) -> None:
        self.share = share

    def to_grid(self, flow: Flow) -> None:
        flow.drag = flow.drag or flow.grid.faces(1.0)
        super().to_grid(flow)

    def to_particles(self, flow: Flow) -> None:
        _core.to_particles(
            *_cloud(flow),
            flow.velocity,
            flow.velocity_change(),
            flow.drag,
            self.share,
            flow.particles.velocity,
            flow.interfaces,
        )
        flow.interpolated = False


class Apic(Pic):
    """PIC that also carries the velocity gradient of each particle (Jiang et al. 2015): `affine` (N, d, d)."""

    def columns(self, dimension: int) -> tuple[Column, ...]:
        """The velocity gradient [1/s], made from the grid."""
        return (Column("affine", "grid", (dimension, dimension)),)

    def to_grid(self, flow: Flow) -> None:
        p, faces = flow.particles, (flow.velocity, flow.work.face_mass)
        _core.to_faces(*_cloud(flow), p.velocity, p["affine"], *faces, flow.interfaces)

    def to_particles(self, flow: Flow) -> None:
        super().to_particles(flow)
        self.renew(flow)

    def renew(self, flow: Flow) -> None:
        """Particles take the velocity gradient of the grid; new ones too, without it remeshing would be PIC."""
        _core.affine_from(*_cloud(flow), flow.velocity, flow.particles["affine"], flow.interfaces)


def make(name: str, *, flip: float, order: int) -> Transfer:
    """The transfer a case names."""
    choices: dict[str, Callable[[], Transfer]] = {
        "fmpm": lambda: Fmpm(order),
        "flip": lambda: Flip(flip),
        "apic": Apic,
        "pic": Pic,
    }
    return choices[name]()

"""Transfers between particles and grid: the velocities of the particles become those of the faces, and back.

The mass of a particle in a transfer is its bulk volume V/n: so what is conserved is the sum of V/n u_d = V u, momentum
per density. To add a transfer copy the shortest class, change its two methods and its row, and add it to
`TRANSFERS` at the bottom. What it keeps for each particle besides the velocity it names in `columns` (particles.py).

References: Brackbill & Ruppel 1986, J. Comput. Phys. 65, 314; Zhu & Bridson 2005, ACM Trans. Graph. 24, 965; Jiang,
Schroeder, Selle, Teran & Stomakhin 2015, ACM Trans. Graph. 34, 51; Maljaars, Labeur & Moeller 2018, J. Comput. Phys.
358, 192; Nairn & Hammerquist 2021, Comput. Methods Appl. Mech. Eng. 377, 113680.
"""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from houle import _core
from houle.flow.kernels import KERNELS
from houle.flow.particles import Column
from houle.flow.state import SPRAY, Flow
from houle.grid import Faces
from houle.registry import Choices


class Transfer:
    """What every transfer does, and what it is called: `name` in the case file, `what` and `source` for the reader."""

    name: ClassVar[str]
    what: ClassVar[str]
    source: ClassVar[str]
    range: ClassVar[str] = ""

    @classmethod
    def of(cls, *, order: int, flip: float) -> Transfer:
        """The transfer with the numbers of a case, of which it takes those that it knows."""
        return cls()

    def columns(self, dimension: int) -> tuple[Column, ...]:
        """What is kept for each particle besides its velocity: here nothing."""
        return ()

    def to_grid(self, flow: Flow) -> None:
        """Sets flow.velocity and flow.work.face_mass from the particles, which must be sorted."""
        raise NotImplementedError

    def to_particles(self, flow: Flow) -> bool:
        """Sets the velocities of the particles from flow.velocity, at the positions of `to_grid`. Returns whether they
        are now what the linear kernel interpolates there.
        """
        raise NotImplementedError

    def renew(self, flow: Flow) -> None:
        """Fills the columns that are made from the grid, after other particles were put in the place of the old."""


class Pic(Transfer):
    """Particle in cell: the velocity of a particle is that of the grid. Stable and very dissipative."""

    name = "pic"
    what = "Particles take the velocity of the grid: stable, dissipates most."
    source = "Harlow (1955); Evans & Harlow (1957)"

    def to_grid(self, flow: Flow) -> None:
        """Sets the velocity of a face to the mean of the particles around it, by mass and kernel."""
        faces = (flow.velocity, flow.work.face_mass)
        _core.to_faces(*flow.cloud, flow.particles.velocity, None, *faces, flow.interfaces)

    def to_particles(self, flow: Flow) -> bool:
        """Interpolates the velocity of the grid."""
        flow.interpolate(flow.velocity, flow.particles.velocity)
        return flow.kernel == "linear"


class Fmpm(Pic):
    """PIC with the full mass matrix, inverted to `order` terms: FMPM(k) of Nairn & Hammerquist (2021).

    The velocities of the faces are those whose interpolation is nearest to the velocities of the particles, in the norm
    of kinetic energy. A term more filters less: order 1 is PIC, many terms approach the conservative l2 projection
    (Maljaars et al. 2018). The transfer neither adds kinetic energy nor keeps, as FLIP does, velocities that the grid
    cannot see.
    """

    name = "fmpm"
    what = (
        "Grid velocities from the full mass matrix, inverted to `order` terms: filters out what the grid cannot see. "
        "order 1 is PIC; many terms approach the conservative l2 projection."
    )
    source = (
        "Nairn & Hammerquist (2021), Comput. Methods Appl. Mech. Eng. 377; Maljaars et al. (2018) for the projection"
    )

    def __init__(self, order: int) -> None:
        self.order = order

    @classmethod
    def of(cls, *, order: int, flip: float) -> Fmpm:
        """The transfer with that number of terms."""
        return cls(order)

    def to_grid(self, flow: Flow) -> None:
        """Sets the velocity of the faces to the sum of `order` terms: by the matrix itself for the linear kernel.

        For the other kernels each term is a pass over the particles.
        """
        p, work = flow.particles, flow.work
        if flow.kernel == "linear":
            spaces = (flow.velocity, work.face_mass, flow.old_velocity, work.store, flow.interfaces)
            work.mass_matrix.transfer(p.position, flow.bulk, flow.start, p.velocity, self.order, *spaces)
            return
        super().to_grid(flow)
        for _ in range(1, self.order):
            faces = (work.face_mass, flow.velocity, flow.old_velocity)
            _core.add_residual(*flow.cloud, p.velocity, *faces, flow.interfaces)


class Flip(Pic):
    """Particles keep their velocity and take the change of the grid's (FLIP), blended with PIC.

    share: that of FLIP in the blend [-].
    """

    name = "flip"
    what = "Particles keep their velocity and take the change of the grid's; `flip` is its share, the rest is PIC."
    source = "Brackbill & Ruppel (1986), J. Comput. Phys. 65; blend: Zhu & Bridson (2005), ACM Trans. Graph. 24"

    def __init__(self, share: float) -> None:
        self.share = share

    @classmethod
    def of(cls, *, order: int, flip: float) -> Flip:
        """The transfer with that share of FLIP."""
        return cls(flip)

    def to_grid(self, flow: Flow) -> None:
        """Sets the velocity of the faces as PIC does, and asks the forces for the factor of the drag on each face."""
        flow.drag = flow.drag or flow.grid.faces(1.0)
        super().to_grid(flow)

    def to_particles(self, flow: Flow) -> bool:
        """Adds what forces and pressure changed; what a particle had is reduced by the drag where it is."""
        faces = (flow.velocity, velocity_change(flow), flow.drag)
        _core.to_particles(*flow.cloud, *faces, self.share, flow.particles.velocity, flow.interfaces)
        return False


def velocity_change(flow: Flow) -> Faces:
    """What forces and pressure added to the velocity of each face, new - drag * old [m/s].

    It is carried outwards as far as particles under a flat surface see it: one layer of faces with the linear kernel,
    two with the others.
    """
    layers = KERNELS[flow.kernel].nodes
    change = [new - drag * old for new, drag, old in zip(flow.velocity, flow.drag, flow.old_velocity, strict=True)]
    known = [(valid == 1).astype(np.uint8) for valid in flow.work.valid]
    spray = SPRAY * flow.grid.cell_volume
    _core.extrapolate(flow.grid.core, 6, layers, flow.work.face_mass, spray, change, known)
    return change


class Apic(Pic):
    """PIC whose particles carry the gradient of the velocity, too: the column `affine` (N, d, d) [1/s]."""

    name = "apic"
    what = (
        "PIC whose particles carry the velocity gradient too: conserves angular momentum, no noise, some dissipation."
    )
    source = "Jiang, Schroeder, Selle, Teran & Stomakhin (2015), ACM Trans. Graph. 34"

    def columns(self, dimension: int) -> tuple[Column, ...]:
        """The velocity gradient, made from the grid in each step."""
        return (Column("affine", "grid", (dimension, dimension)),)

    def to_grid(self, flow: Flow) -> None:
        """Sets the velocity of a face to the mean of what the particles around it have there, by mass and kernel."""
        p, faces = flow.particles, (flow.velocity, flow.work.face_mass)
        _core.to_faces(*flow.cloud, p.velocity, p["affine"], *faces, flow.interfaces)

    def to_particles(self, flow: Flow) -> bool:
        """Interpolates the velocity of the grid and its gradient."""
        linear = super().to_particles(flow)
        self.renew(flow)
        return linear

    def renew(self, flow: Flow) -> None:
        """Takes the velocity gradient of the grid where the particles are: without it remeshing would be PIC."""
        _core.affine_from(*flow.cloud, flow.velocity, flow.particles["affine"], flow.interfaces)


TRANSFERS: Choices[type[Transfer]] = Choices("transfer", (Fmpm, Flip, Pic, Apic))

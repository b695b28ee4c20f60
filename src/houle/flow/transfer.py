"""Transfers between particles and grid: the velocities of the particles become those of the faces, and back.

The mass of a particle in a transfer is its bulk volume V/n, so that a transfer conserves the sum of V/n u_d = V u, the
momentum per density: section 5 of docs/theory.md. To add a transfer copy the shortest class, change its two methods and
its row, and add it to `TRANSFERS` at the bottom. Quantities that it keeps for each particle besides the velocity are
named in its `columns` (particles.py).

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

MORE = 4  # terms at oblique porous interfaces for each one beyond the first


class Transfer:
    """Base of the transfers. `name` is that in the case file; `what`, `source` and `range` are for `houle describe`."""

    name: ClassVar[str]
    what: ClassVar[str]
    source: ClassVar[str]
    range: ClassVar[str] = ""

    @classmethod
    def of(cls, *, order: int, flip: float) -> Transfer:
        """The transfer with those numbers of [numerics] that it needs: number of terms, share of FLIP [-]."""
        return cls()

    def columns(self, dimension: int) -> tuple[Column, ...]:
        """Declarations of what it keeps for each particle besides the velocity: nothing, unless it overrides this."""
        return ()

    def to_grid(self, flow: Flow) -> None:
        """Sets flow.velocity [m/s] and flow.work.face_mass [m^d] from the particles, which must be sorted by cell."""
        raise NotImplementedError

    def to_particles(self, flow: Flow) -> bool:
        """Sets the velocities of the particles from flow.velocity, at the positions that `to_grid` saw.

        Returns whether they are now exactly the velocities that the linear kernel interpolates there.
        """
        raise NotImplementedError

    def renew(self, flow: Flow) -> None:
        """Fills the columns that are made from the grid for new particles, after a remeshing."""


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
        """Sets the velocity of each particle to that of the grid at its place."""
        flow.interpolate(flow.velocity, flow.particles.velocity)
        return flow.kernel == "linear"


class Fmpm(Pic):
    """PIC with the full mass matrix, inverted to `order` terms: FMPM(k) of Nairn & Hammerquist (2021), (10).

    In the limit of many terms the velocities of the faces are those whose interpolation is nearest to the velocities of
    the particles, in the norm of kinetic energy: the conservative l2 projection (Maljaars et al. 2018). One term is
    PIC; each further term filters less. The transfer adds no kinetic energy, and it does not keep velocities that the
    grid cannot see, as FLIP does.
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
        """The transfer with `order` terms."""
        return cls(order)

    def to_grid(self, flow: Flow) -> None:
        """Sets the velocity of the faces to the sum of `order` terms.

        For the linear kernel the core holds the matrix; for the others each term is a pass over the particles. With the
        matrix, faces at oblique porous interfaces under water take more terms (`MORE`): there the velocity jumps along
        a staircase, and four terms filter so much of it that a rubble mound reflects too little.
        """
        p, work = flow.particles, flow.work
        if flow.kernel == "linear":
            spaces = (flow.velocity, work.face_mass, flow.old_velocity, work.store, flow.interfaces)
            more = (flow.joined_faces(), MORE * (self.order - 1))
            work.mass_matrix.transfer(p.position, flow.bulk, flow.start, p.velocity, self.order, *spaces, *more)
            return
        super().to_grid(flow)
        for _ in range(1, self.order):
            faces = (work.face_mass, flow.velocity, flow.old_velocity)
            _core.add_residual(*flow.cloud, p.velocity, *faces, flow.interfaces)


class Flip(Pic):
    """Particles keep their velocity and add the change of the velocity of the grid (FLIP), blended with PIC.

    share: part of FLIP in the blend; the rest is PIC [-].
    """

    name = "flip"
    what = "Particles keep their velocity and take the change of the grid's; `flip` is its share, the rest is PIC."
    source = "Brackbill & Ruppel (1986), J. Comput. Phys. 65; blend: Zhu & Bridson (2005), ACM Trans. Graph. 24"

    def __init__(self, share: float) -> None:
        self.share = share

    @classmethod
    def of(cls, *, order: int, flip: float) -> Flip:
        """The transfer with the share `flip` of FLIP."""
        return cls(flip)

    def to_grid(self, flow: Flow) -> None:
        """Sets the velocity of the faces as PIC does, and makes room for the factor of the drag, flow.drag."""
        flow.drag = flow.drag or flow.grid.faces(1.0)
        super().to_grid(flow)

    def to_particles(self, flow: Flow) -> bool:
        """Scales the velocity of each particle by the drag factor at its place, and adds `velocity_change` there."""
        faces = (flow.velocity, velocity_change(flow), flow.drag)
        _core.to_particles(*flow.cloud, *faces, self.share, flow.particles.velocity, flow.interfaces)
        return False


def velocity_change(flow: Flow) -> Faces:
    """Velocity that forces and pressure added on each face, new - D old with the drag factor D of (12) [m/s].

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
        """The column of the velocity gradient, which is made from the grid in each step."""
        return (Column("affine", "grid", (dimension, dimension)),)

    def to_grid(self, flow: Flow) -> None:
        """Sets the velocity of a face to the mean of the velocities that the particles around extrapolate to it."""
        p, faces = flow.particles, (flow.velocity, flow.work.face_mass)
        _core.to_faces(*flow.cloud, p.velocity, p["affine"], *faces, flow.interfaces)

    def to_particles(self, flow: Flow) -> bool:
        """Sets velocity and velocity gradient of each particle to those of the grid at its place."""
        linear = super().to_particles(flow)
        self.renew(flow)
        return linear

    def renew(self, flow: Flow) -> None:
        """Takes the velocity gradient of the grid at the particles; without it a remeshing would act as PIC does."""
        _core.affine_from(*flow.cloud, flow.velocity, flow.particles["affine"], flow.interfaces)


TRANSFERS: Choices[type[Transfer]] = Choices("transfer", (Fmpm, Flip, Pic, Apic))

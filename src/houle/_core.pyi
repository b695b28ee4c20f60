# Written by bind/stub.py from the compiled module. Do not edit.
"""houle's numerical kernels: free functions over NumPy arrays, in 2 and 3 dimensions"""

from collections.abc import Sequence
import numpy
import numpy.typing
from numpy.typing import NDArray

class Grid2:
    def __init__(self, shape: Sequence[int], spacing: Sequence[float], periodic: Sequence[bool]) -> None: ...

    @property
    def shape(self) -> list[int]: ...

    @property
    def spacing(self) -> list[float]: ...

    @property
    def periodic(self) -> list[bool]: ...

class Grid3:
    def __init__(self, shape: Sequence[int], spacing: Sequence[float], periodic: Sequence[bool]) -> None: ...

    @property
    def shape(self) -> list[int]: ...

    @property
    def spacing(self) -> list[float]: ...

    @property
    def periodic(self) -> list[bool]: ...

class PressureSolver2:
    """Solves sum_f k_f (p_c - p_nb) + e_c p_c = rhs_c in the active cells of a grid, by conjugate gradients preconditioned with multigrid."""

    def __init__(self, grid: Grid2) -> None: ...

    @property
    def buffers(self) -> list[int]:
        """Addresses and sizes of the work arrays: they never change."""

    @property
    def closed_components(self) -> int: ...

    def setup(
        self,
        active: numpy.typing.NDArray[numpy.uint8],
        k: Sequence[numpy.typing.NDArray[numpy.float64]],
        e: numpy.typing.NDArray[numpy.float64],
    ) -> None: ...

    def solve(
        self,
        rhs: numpy.typing.NDArray[numpy.float64],
        p: numpy.typing.NDArray[numpy.float64],
        tolerance: float,
        max_iterations: int,
        guess: numpy.typing.NDArray[numpy.float32] | None = None,
    ) -> tuple[int, float]: ...

class PressureSolver3:
    """Solves sum_f k_f (p_c - p_nb) + e_c p_c = rhs_c in the active cells of a grid, by conjugate gradients preconditioned with multigrid."""

    def __init__(self, grid: Grid3) -> None: ...

    @property
    def buffers(self) -> list[int]:
        """Addresses and sizes of the work arrays: they never change."""

    @property
    def closed_components(self) -> int: ...

    def setup(
        self,
        active: numpy.typing.NDArray[numpy.uint8],
        k: Sequence[numpy.typing.NDArray[numpy.float64]],
        e: numpy.typing.NDArray[numpy.float64],
    ) -> None: ...

    def solve(
        self,
        rhs: numpy.typing.NDArray[numpy.float64],
        p: numpy.typing.NDArray[numpy.float64],
        tolerance: float,
        max_iterations: int,
        guess: numpy.typing.NDArray[numpy.float32] | None = None,
    ) -> tuple[int, float]: ...

class MassMatrix2:
    """The full mass matrix of the linear kernel, for the transfer FMPM(k)."""

    def __init__(self, grid: Grid2) -> None: ...

    def transfer(
        self,
        position: numpy.typing.NDArray[numpy.float64],
        mass: numpy.typing.NDArray[numpy.float64],
        start: numpy.typing.NDArray[numpy.int32],
        u: numpy.typing.NDArray[numpy.float64],
        order: int,
        velocity: Sequence[numpy.typing.NDArray[numpy.float64]],
        face_mass: Sequence[numpy.typing.NDArray[numpy.float64]],
        work: Sequence[numpy.typing.NDArray[numpy.float64]],
        lent: numpy.typing.NDArray[numpy.float64],
        interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
        where: Sequence[numpy.typing.NDArray[numpy.uint8]] | None = None,
        more: int = 0,
    ) -> None:
        """Velocities and masses of the faces: to_faces with the linear kernel, then order - 1 times add_residual, and on the faces where `where` is not 0 as often again as `more` says."""

class MassMatrix3:
    """The full mass matrix of the linear kernel, for the transfer FMPM(k)."""

    def __init__(self, grid: Grid3) -> None: ...

    def transfer(
        self,
        position: numpy.typing.NDArray[numpy.float64],
        mass: numpy.typing.NDArray[numpy.float64],
        start: numpy.typing.NDArray[numpy.int32],
        u: numpy.typing.NDArray[numpy.float64],
        order: int,
        velocity: Sequence[numpy.typing.NDArray[numpy.float64]],
        face_mass: Sequence[numpy.typing.NDArray[numpy.float64]],
        work: Sequence[numpy.typing.NDArray[numpy.float64]],
        lent: numpy.typing.NDArray[numpy.float64],
        interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
        where: Sequence[numpy.typing.NDArray[numpy.uint8]] | None = None,
        more: int = 0,
    ) -> None:
        """Velocities and masses of the faces: to_faces with the linear kernel, then order - 1 times add_residual, and on the faces where `where` is not 0 as often again as `more` says."""

def set_threads(threads: int) -> None: ...

def get_threads() -> int: ...

def return_memory() -> None:
    """Hands freed memory back to the operating system."""

def build_info() -> dict:
    """Compiler, its flags, variant of the core, threads in use."""

def cell_sort(
    grid: Grid2 | Grid3,
    position: numpy.typing.NDArray[numpy.float64],
    cell: numpy.typing.NDArray[numpy.int32],
    order: numpy.typing.NDArray[numpy.int32],
    start: numpy.typing.NDArray[numpy.int32],
) -> None:
    """Stable order of the particles by cell: order (N,), start (cells + 1,); cell (N,) is work space."""

def sort_particles(
    grid: Grid2 | Grid3,
    position: numpy.typing.NDArray[numpy.float64],
    velocity: numpy.typing.NDArray[numpy.float64],
    volume: numpy.typing.NDArray[numpy.float64],
    spare: numpy.typing.NDArray[numpy.float64],
    order: numpy.typing.NDArray[numpy.int32],
    start: numpy.typing.NDArray[numpy.int32],
) -> None:
    """Puts the particles into the order of their cells, in place: order and start as in cell_sort; spare (N, d) is work space."""

def scatter_cells(
    grid: Grid2 | Grid3,
    start: numpy.typing.NDArray[numpy.int32],
    position: numpy.typing.NDArray[numpy.float64],
    amount: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
    paddles: numpy.typing.NDArray[numpy.float64] | None = None,
    factor: numpy.typing.NDArray[numpy.float64] | None = None,
    gates: numpy.typing.NDArray[numpy.float64] | None = None,
) -> None:
    """Tent-weighted sums of a particle amount at cell centres, times a factor of the cells."""

def gather_cells(
    grid: Grid2 | Grid3,
    position: numpy.typing.NDArray[numpy.float64],
    field: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Interpolates a cell field to the particles, linearly: out (N,)."""

def to_faces(
    grid: Grid2 | Grid3,
    kernel: str,
    position: numpy.typing.NDArray[numpy.float64],
    side: numpy.typing.NDArray[numpy.float64] | None,
    mass: numpy.typing.NDArray[numpy.float64],
    start: numpy.typing.NDArray[numpy.int32],
    u: numpy.typing.NDArray[numpy.float64],
    affine: numpy.typing.NDArray[numpy.float64] | None,
    velocity: Sequence[numpy.typing.NDArray[numpy.float64]],
    face_mass: Sequence[numpy.typing.NDArray[numpy.float64]],
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
) -> None:
    """Mass-weighted mean of the particle velocities on the faces, and the face masses."""

def add_residual(
    grid: Grid2 | Grid3,
    kernel: str,
    position: numpy.typing.NDArray[numpy.float64],
    side: numpy.typing.NDArray[numpy.float64] | None,
    mass: numpy.typing.NDArray[numpy.float64],
    start: numpy.typing.NDArray[numpy.int32],
    u: numpy.typing.NDArray[numpy.float64],
    face_mass: Sequence[numpy.typing.NDArray[numpy.float64]],
    velocity: Sequence[numpy.typing.NDArray[numpy.float64]],
    work: Sequence[numpy.typing.NDArray[numpy.float64]],
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
) -> None:
    """Adds one more term of the full-mass-matrix transfer FMPM(k) to the velocity of the faces."""

def to_particles(
    grid: Grid2 | Grid3,
    kernel: str,
    position: numpy.typing.NDArray[numpy.float64],
    side: numpy.typing.NDArray[numpy.float64] | None,
    mass: numpy.typing.NDArray[numpy.float64],
    start: numpy.typing.NDArray[numpy.int32],
    now: Sequence[numpy.typing.NDArray[numpy.float64]],
    change: Sequence[numpy.typing.NDArray[numpy.float64]],
    drag: Sequence[numpy.typing.NDArray[numpy.float64]],
    flip: float,
    u: numpy.typing.NDArray[numpy.float64],
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
) -> None:
    """Particle velocities from the faces: PIC (flip = 0) or a FLIP blend."""

def affine_from(
    grid: Grid2 | Grid3,
    kernel: str,
    position: numpy.typing.NDArray[numpy.float64],
    side: numpy.typing.NDArray[numpy.float64] | None,
    mass: numpy.typing.NDArray[numpy.float64],
    start: numpy.typing.NDArray[numpy.int32],
    velocity: Sequence[numpy.typing.NDArray[numpy.float64]],
    affine: numpy.typing.NDArray[numpy.float64],
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
) -> None:
    """APIC's velocity gradient at the particles."""

def wall_shear(speed: float, distance: float, nu: float, roughness: float) -> float:
    """Shear stress of a wall per unit density, by the law of the wall [m2/s2]."""

def kinetic_energy(
    bulk: numpy.typing.NDArray[numpy.float64],
    inertia: numpy.typing.NDArray[numpy.float32] | None,
    u: numpy.typing.NDArray[numpy.float64],
) -> float:
    """Kinetic energy of the particles per unit density."""

def all_finite(x: numpy.typing.NDArray[numpy.float64]) -> bool:
    """True if no number is infinite or NaN."""

def max_speed(
    u: numpy.typing.NDArray[numpy.float64],
    volume: numpy.typing.NDArray[numpy.float64],
    bulk: numpy.typing.NDArray[numpy.float64],
) -> list[float]:
    """Largest pore speed along each axis [m/s]."""

def total(value: numpy.typing.NDArray[numpy.float64]) -> float:
    """Sum of all numbers, in blocks: the same bits for any number of threads."""

def weighted_sum(
    weight: numpy.typing.NDArray[numpy.float64],
    value: numpy.typing.NDArray[numpy.float64],
    column: int,
) -> float:
    """Sum of weight times one column of value, in blocks: the same bits for any number of threads."""

def column_heights(
    grid: Grid2 | Grid3,
    start: numpy.typing.NDArray[numpy.int32],
    position: numpy.typing.NDArray[numpy.float64],
    volume: numpy.typing.NDArray[numpy.float64],
    height: numpy.typing.NDArray[numpy.float64],
    paddles: numpy.typing.NDArray[numpy.float64] | None = None,
    gates: numpy.typing.NDArray[numpy.float64] | None = None,
) -> None:
    """Height of the water in each column of cells [m]."""

def column_levels(
    grid: Grid2 | Grid3,
    height: numpy.typing.NDArray[numpy.float64],
    porosity: numpy.typing.NDArray[numpy.float64],
    fill: numpy.typing.NDArray[numpy.float64],
    inverse_capacity: numpy.typing.NDArray[numpy.float64],
    column: numpy.typing.NDArray[numpy.int64],
    start: numpy.typing.NDArray[numpy.int64],
    pieces: numpy.typing.NDArray[numpy.float64],
    level: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Level to which its water fills the pores of each column [m]."""

def find_surface(
    grid: Grid2 | Grid3,
    fill: numpy.typing.NDArray[numpy.float64],
    open: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    level: numpy.typing.NDArray[numpy.float64],
    depth: numpy.typing.NDArray[numpy.float64],
    active: numpy.typing.NDArray[numpy.uint8],
    column: numpy.typing.NDArray[numpy.float64],
    eta: numpy.typing.NDArray[numpy.float64],
    gates: numpy.typing.NDArray[numpy.float64] | None = None,
) -> None:
    """Depth of the cell centres below the free surface [cells], active cells, level of the surface per column [m]."""

def water_above(grid: Grid2 | Grid3, fill: numpy.typing.NDArray[numpy.float64], row: int) -> bool:
    """True if there is water in this row of cells, counted upwards, or above."""

def water_held(
    grid: Grid2 | Grid3,
    active: numpy.typing.NDArray[numpy.uint8],
    open: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    fill: numpy.typing.NDArray[numpy.float64],
    inverse_capacity: numpy.typing.NDArray[numpy.float64],
    height: numpy.typing.NDArray[numpy.float64],
    column: numpy.typing.NDArray[numpy.int64],
    held: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Water in the listed columns of cells [m^d]; cells under the surface count as full."""

def density_excess(
    grid: Grid2 | Grid3,
    active: numpy.typing.NDArray[numpy.uint8],
    depth: numpy.typing.NDArray[numpy.float64],
    column: numpy.typing.NDArray[numpy.float64],
    eta: numpy.typing.NDArray[numpy.float64],
    fill: numpy.typing.NDArray[numpy.float64],
    open: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    porosity: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]] | None,
    omega: float,
    rhs: numpy.typing.NDArray[numpy.float64],
) -> float:
    """Right-hand side of the position correction: the share of each cell's excess fill to be spread. Its largest size."""

def apply_forces(
    grid: Grid2 | Grid3,
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
    number: Sequence[numpy.typing.NDArray[numpy.int32]],
    table: numpy.typing.NDArray[numpy.float64] | None,
    rate: Sequence[numpy.typing.NDArray[numpy.float64]],
    energy: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]] | None,
    held: Sequence[numpy.typing.NDArray[numpy.uint8]],
    gravity: Sequence[float],
    extra: Sequence[numpy.typing.NDArray[numpy.float64]],
    dt: float,
    star: Sequence[numpy.typing.NDArray[numpy.float64]],
    drag: Sequence[numpy.typing.NDArray[numpy.float64]],
    mobility: Sequence[numpy.typing.NDArray[numpy.float64]],
) -> None:
    """Body forces, implicit porous resistance and Bernoulli term over one step."""

def drag_work(
    grid: Grid2 | Grid3,
    number: Sequence[numpy.typing.NDArray[numpy.int32]],
    table: numpy.typing.NDArray[numpy.float64] | None,
    rate: Sequence[numpy.typing.NDArray[numpy.float64]],
    mass: Sequence[numpy.typing.NDArray[numpy.float64]],
    mobility: Sequence[numpy.typing.NDArray[numpy.float64]],
    before: Sequence[numpy.typing.NDArray[numpy.float64]],
    after: Sequence[numpy.typing.NDArray[numpy.float64]],
) -> float:
    """Energy that the drag took in a step, per unit density."""

def eddy_viscosity(
    grid: Grid2 | Grid3,
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
    molecular: float,
    constant: float,
    nu: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Smagorinsky viscosity of the cells [m2/s]."""

def viscous_acceleration(
    grid: Grid2 | Grid3,
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
    mass: Sequence[numpy.typing.NDArray[numpy.float64]],
    least: float,
    molecular: float,
    nu: numpy.typing.NDArray[numpy.float64] | None,
    porosity: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]] | None,
    out: Sequence[numpy.typing.NDArray[numpy.float64]],
) -> None:
    """Viscous acceleration of the faces [m/s2]."""

def rub(
    grid: Grid2 | Grid3,
    walls: tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64]],
    start: numpy.typing.NDArray[numpy.int32],
    position: numpy.typing.NDArray[numpy.float64],
    volume: numpy.typing.NDArray[numpy.float64],
    bulk: numpy.typing.NDArray[numpy.float64],
    inertia: numpy.typing.NDArray[numpy.float32] | None,
    fill: numpy.typing.NDArray[numpy.float64],
    nu: float,
    dt: float,
    velocity: numpy.typing.NDArray[numpy.float64],
    impulse: numpy.typing.NDArray[numpy.float64],
) -> float:
    """Slows particles down along the walls near them, by the law of the wall. Returns the energy taken per unit density."""

def face_kinetic_energy(
    grid: Grid2 | Grid3,
    mass: Sequence[numpy.typing.NDArray[numpy.float64]],
    number: Sequence[numpy.typing.NDArray[numpy.int32]],
    table: numpy.typing.NDArray[numpy.float64],
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
) -> float:
    """Kinetic energy of the faces per unit density."""

def face_power(
    grid: Grid2 | Grid3,
    mass: Sequence[numpy.typing.NDArray[numpy.float64]],
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
    acceleration: Sequence[numpy.typing.NDArray[numpy.float64]],
) -> float:
    """Power of the accelerations on the faces per unit density."""

def pressure_system(
    grid: Grid2 | Grid3,
    active: numpy.typing.NDArray[numpy.uint8],
    depth: numpy.typing.NDArray[numpy.float64],
    open: Sequence[numpy.typing.NDArray[numpy.float32]],
    mobility: Sequence[numpy.typing.NDArray[numpy.float64]],
    step: float,
    star: Sequence[numpy.typing.NDArray[numpy.float64]],
    least: float,
    k: Sequence[numpy.typing.NDArray[numpy.float64]],
    e: numpy.typing.NDArray[numpy.float64],
    rhs: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Coefficients and right-hand side of the pressure system at the sub-cell surface."""

def project(
    grid: Grid2 | Grid3,
    active: numpy.typing.NDArray[numpy.uint8],
    depth: numpy.typing.NDArray[numpy.float64],
    open: Sequence[numpy.typing.NDArray[numpy.float32]],
    mobility: Sequence[numpy.typing.NDArray[numpy.float64]],
    step: float,
    pressure: numpy.typing.NDArray[numpy.float64],
    least: float,
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
    valid: Sequence[numpy.typing.NDArray[numpy.uint8]],
    still: bool = False,
) -> None:
    """Takes the pressure gradient off the velocity u of the faces of the water, in place; still: u counts as 0 before."""

def extrapolate(
    grid: Grid2 | Grid3,
    layers: int,
    near: int,
    mass: Sequence[numpy.typing.NDArray[numpy.float64]],
    keep_mass: float,
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
    known: Sequence[numpy.typing.NDArray[numpy.uint8]],
) -> None:
    """Carries known face velocities outwards by averaging, layer by layer."""

def continue_upwards(
    grid: Grid2 | Grid3,
    layers: int,
    active: numpy.typing.NDArray[numpy.uint8],
    column: numpy.typing.NDArray[numpy.float64],
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
) -> None:
    """Divergence-free vertical velocity above the surface of single-valued columns."""

def stop_at_solids(
    grid: Grid2 | Grid3,
    closed: Sequence[tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64]]],
    velocity: Sequence[numpy.typing.NDArray[numpy.float64]],
) -> None:
    """Changes the velocity of the closed faces, in place, so that no water crosses the outline of the solids."""

def move(
    grid: Grid2 | Grid3,
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
    porosity: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]] | None,
    own: numpy.typing.NDArray[numpy.float64] | None,
    volume: numpy.typing.NDArray[numpy.float64] | None,
    bulk: numpy.typing.NDArray[numpy.float64] | None,
    solids: tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]] | None,
    gates: numpy.typing.NDArray[numpy.float64],
    dt: float,
    position: numpy.typing.NDArray[numpy.float64],
    paddles: numpy.typing.NDArray[numpy.float64] | None = None,
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
) -> None:
    """Moves the particles with the pore velocity, midpoint rule."""

def travel(
    grid: Grid2 | Grid3,
    dt: float,
    u: Sequence[numpy.typing.NDArray[numpy.float64]],
    mass: Sequence[numpy.typing.NDArray[numpy.float64]],
    least: float,
    porosity: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]] | None,
    way: Sequence[numpy.typing.NDArray[numpy.float32]],
) -> list[float]:
    """Adds dt u to the way of the water on the faces (float32) [m]; returns the farthest along each axis where there is water."""

def drift(
    grid: Grid2 | Grid3,
    from_: numpy.typing.NDArray[numpy.float64],
    u: numpy.typing.NDArray[numpy.float64],
    porosity: numpy.typing.NDArray[numpy.float64] | None,
    solids: tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]] | None,
    gates: numpy.typing.NDArray[numpy.float64],
    dt: float,
    position: numpy.typing.NDArray[numpy.float64],
    paddles: numpy.typing.NDArray[numpy.float64] | None = None,
) -> None:
    """Moves the particles with their own pore velocities."""

def displace(
    grid: Grid2 | Grid3,
    displacement: Sequence[numpy.typing.NDArray[numpy.float64]],
    porosity: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]] | None,
    solids: tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]] | None,
    gates: numpy.typing.NDArray[numpy.float64],
    limit: float,
    position: numpy.typing.NDArray[numpy.float64],
    paddles: numpy.typing.NDArray[numpy.float64] | None = None,
) -> None:
    """Moves the particles along a displacement given on the faces."""

def leave_solids(
    grid: Grid2 | Grid3,
    solids: tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]] | None,
    position: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Takes particles that lie in solids to the nearest place outside."""

def sample_medium(
    grid: Grid2 | Grid3,
    number: Sequence[numpy.typing.NDArray[numpy.int32]],
    table: numpy.typing.NDArray[numpy.float64],
    cell_inertia: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    uniform: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    porosity: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    position: numpy.typing.NDArray[numpy.float64],
    volume: numpy.typing.NDArray[numpy.float64],
    bulk: numpy.typing.NDArray[numpy.float64],
    inertia: numpy.typing.NDArray[numpy.float32],
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
) -> None:
    """Bulk volume and inertia at the particles, linear from the cells and the faces."""

def hold_faces(
    grid: Grid2 | Grid3,
    active: numpy.typing.NDArray[numpy.uint8],
    open: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    contrast: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    most: float,
    held: Sequence[numpy.typing.NDArray[numpy.uint8]],
) -> None:
    """Marks the faces near porous ones whose flux the pressure on both sides holds: there the Bernoulli force acts."""

def carry(
    grid: Grid2 | Grid3,
    number: Sequence[numpy.typing.NDArray[numpy.int32]],
    table: numpy.typing.NDArray[numpy.float64],
    cell_inertia: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    uniform: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    held: Sequence[numpy.typing.NDArray[numpy.uint8]],
    porosity: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    coefficient: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    dt: float,
    position: numpy.typing.NDArray[numpy.float64],
    volume: numpy.typing.NDArray[numpy.float64],
    bulk: numpy.typing.NDArray[numpy.float64],
    inertia: numpy.typing.NDArray[numpy.float32],
    u: numpy.typing.NDArray[numpy.float64],
    lag: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]] | None = None,
    ago: numpy.typing.NDArray[numpy.float64] | None = None,
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
) -> None:
    """Gives particles that have moved the medium where they are, and keeps the energy of those that no pressure holds."""

def fall_behind(
    grid: Grid2 | Grid3,
    number: Sequence[numpy.typing.NDArray[numpy.int32]],
    table: numpy.typing.NDArray[numpy.float64],
    cell_inertia: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    uniform: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    held: Sequence[numpy.typing.NDArray[numpy.uint8]],
    lag: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    porosity: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    velocity: Sequence[numpy.typing.NDArray[numpy.float64]],
    dt: float,
    change: Sequence[numpy.typing.NDArray[numpy.float64]],
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
) -> None:
    """Change of the velocity on faces [m/s] where momentum moves slower than the water: added mass on the rate alone."""

def cell_energy(
    grid: Grid2 | Grid3,
    near: numpy.typing.NDArray[numpy.uint8],
    position: numpy.typing.NDArray[numpy.float64],
    bulk: numpy.typing.NDArray[numpy.float64],
    inertia: numpy.typing.NDArray[numpy.float32],
    u: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Twice the kinetic energy of the particles in each cell marked near, per unit density; 0 in the others."""

def scale_by_cell(
    grid: Grid2 | Grid3,
    share: numpy.typing.NDArray[numpy.float64],
    position: numpy.typing.NDArray[numpy.float64],
    u: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Multiplies the velocity of each particle by the share of its cell, in place."""

def settle(
    grid: Grid2 | Grid3,
    number: Sequence[numpy.typing.NDArray[numpy.int32]],
    table: numpy.typing.NDArray[numpy.float64],
    cell_inertia: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    uniform: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]],
    held: Sequence[numpy.typing.NDArray[numpy.uint8]],
    velocity: Sequence[numpy.typing.NDArray[numpy.float64]],
    position: numpy.typing.NDArray[numpy.float64],
    u: numpy.typing.NDArray[numpy.float64],
    affine: numpy.typing.NDArray[numpy.float64] | None,
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
) -> None:
    """Velocities among faces of different inertia: linear from these, with no more energy where no pressure holds them."""

def remesh_conservative(
    grid: Grid2 | Grid3,
    cell_porosity: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64]] | None,
    body: numpy.typing.NDArray[numpy.int8],
    solids: tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]] | None,
    position: numpy.typing.NDArray[numpy.float64],
    velocity: numpy.typing.NDArray[numpy.float64],
    volume: numpy.typing.NDArray[numpy.float64],
    porosity: numpy.typing.NDArray[numpy.float64] | None,
    first: int = 0,
    last: int = -1,
    interfaces: tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.float64], Sequence[numpy.typing.NDArray[numpy.int8]]] | None = None,
    along: bool = True,
    gates: numpy.typing.NDArray[numpy.float64] | None = None,
) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """New particles (position, velocity, volume) on the lattice of half cells; volume, momentum and centre are conserved."""

def remesh_paper(
    grid: Grid2 | Grid3,
    position: numpy.typing.NDArray[numpy.float64],
    velocity: numpy.typing.NDArray[numpy.float64],
    volume: numpy.typing.NDArray[numpy.float64],
    porosity: numpy.typing.NDArray[numpy.float64] | None,
    threshold: float,
    gates: numpy.typing.NDArray[numpy.float64] | None = None,
) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64], NDArray[numpy.float64]]:
    """New particles (position, velocity, volume): a full one on every lattice node whose fill exceeds the threshold."""

def sph_density_sum(
    grid: Grid2 | Grid3,
    walls: Sequence[str],
    kernel: str,
    radius: float,
    position: numpy.typing.NDArray[numpy.float64],
    cell_start: numpy.typing.NDArray[numpy.int32],
    bulk: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Volume sum at the particles: out (N,) = sum_j bulk_j W(x_i - x_j), 1 in full water."""

def sph_viscous_acceleration(
    grid: Grid2 | Grid3,
    walls: Sequence[str],
    kernel: str,
    radius: float,
    position: numpy.typing.NDArray[numpy.float64],
    cell_start: numpy.typing.NDArray[numpy.int32],
    velocity: numpy.typing.NDArray[numpy.float64],
    bulk: numpy.typing.NDArray[numpy.float64],
    viscosity: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Viscous acceleration of the particles, eq. (3) of the paper: out (N, d) [m/s2]."""

def sph_velocity_gradient(
    grid: Grid2 | Grid3,
    kernel: str,
    radius: float,
    position: numpy.typing.NDArray[numpy.float64],
    cell_start: numpy.typing.NDArray[numpy.int32],
    velocity: numpy.typing.NDArray[numpy.float64],
    bulk: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> None:
    """Velocity gradient at the particles, exact for linear fields: out (N, d, d) = du_a/dx_b."""

"""Spoiled calls of the core's functions: each must be refused by name, or do its work; none may crash, hang, or write
an output into a copy that nobody sees.

    python tests/campaigns/bindings.py --calls 5000 --seed 1

Each call runs in a child of its own, on a small random world: a grid of 1 to 6 cells along an axis, walls or periodic
sides, particles, a porous body and a solid. One or two arguments are spoiled: another type, size, layout, stride, byte
order or alignment, read-only, None, NaN, infinite or huge numbers, tables that point elsewhere, the array of another
argument, negative and huge scalars. Ends with status 1 if there was a finding. Needs os.fork.
"""

from __future__ import annotations

import argparse
import os
import pickle
import resource
import select
import signal
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).parent.parent))

from clouds import in_order, random_faces
from houle import _core
from houle.grid import Grid
from houle.medium.columns import Capacity
from houle.medium.medium import Medium
from houle.medium.patches import Surfaces
from houle.medium.rough_walls import RoughWalls
from houle.medium.sections import PorousBody
from houle.medium.shapes import Box

CPU_SECONDS, WALL_SECONDS = 5, 60  # of a call that hangs
CALLS_PER_WORLD = 20
REFUSALS = (TypeError, ValueError, FloatingPointError)
KERNELS = ("linear", "quadratic", "m4prime", "gaussian", "gaussian-taylor2", "gaussian-cell")


@dataclass
class Call:
    """A function, its arguments by name in their order, and which of them it writes to."""

    function: str
    target: Callable[..., Any]
    arguments: dict[str, Any]
    written: tuple[str, ...]


class World:
    """A small grid with all that the core works on."""

    def __init__(self, random: np.random.Generator) -> None:
        d = int(random.integers(2, 4))
        shape = tuple(int(n) for n in random.integers(1, 7 if d == 2 else 5, d))
        spacing = tuple(float(h) for h in random.choice([0.5, 1.0, 1.7], d))
        self.random = random
        self.grid = g = Grid(shape, spacing, tuple(bool(p) for p in random.integers(0, 2, d)))
        half = tuple(0.5 * s for s in g.size)
        bodies = [PorousBody("rock", Box((0.0,) * d, half), 0.4, 1.0, 2.0, 1.2)] if random.integers(2) else []
        corner = tuple(0.6 * s for s in g.size)
        solids = [Box((*corner[:-1], 0.0), (*g.size[:-1], half[-1]))] if random.integers(2) else []
        self.medium = Medium.build(g, bodies, solids)
        self.mixed = Capacity.of(g, self.medium)
        self.n = int(random.integers(0, 30))
        self.x, self.start = in_order(g, random.uniform(0.0, 1.0, (self.n, d)) * g.size)

    def cells(self, low: float = 0.0, high: float = 1.0) -> np.ndarray:
        return self.random.uniform(low, high, self.grid.shape)

    def columns(self) -> np.ndarray:
        return self.random.uniform(0.0, self.grid.size[-1], self.grid.shape[:-1])

    def faces(self, low: float = -1.0, high: float = 1.0) -> list[np.ndarray]:
        return random_faces(self.grid, self.random, low, high)

    def flags(self) -> np.ndarray:
        return self.random.integers(0, 2, self.grid.shape).astype(np.uint8)

    def face_flags(self) -> list[np.ndarray]:
        return [(f > 0.0).astype(np.uint8) for f in self.faces()]

    def each(self, *shape: int, low: float = 0.1, high: float = 1.0) -> np.ndarray:
        """Numbers of the particles."""
        return self.random.uniform(low, high, (self.n, *shape))

    def integers(self, n: int) -> np.ndarray:
        return np.zeros(n, np.int32)

    def calls(self) -> list[Call]:
        """A valid call of every function."""
        return [Call(name, target, arguments, written) for name, target, arguments, written in self._calls()]

    def _calls(self) -> list[tuple]:
        g, m, d, n, mixed = self.grid.core, self.medium, self.grid.dimension, self.n, self.mixed
        x, volume = self.x.copy(), self.each()
        u, cells, faces, start = self.each(d, low=-1.0), self.cells(), self.faces(), self.start.copy()
        gates, paddles = np.array([[0.3 * self.grid.size[0], 0.1]]), np.array([[0.1 * self.grid.size[0], 1.0]])
        singles = [f.astype(np.float32) for f in self.faces(0.0, 1.0)]
        table, numbers = (m.materials, m.material) if m.material else (None, [])
        pores, solid = m.listed("porosity"), m.outline
        cloud = {
            "grid": g,
            "kernel": str(self.random.choice(KERNELS)),
            "position": x,
            "side": self.each(),
            "mass": volume,
        }
        cloud |= {"start": start}
        beside = {"interfaces": m.interfaces}
        positive = self.faces(0.1, 1.0)
        sph: dict[str, Any] = {"grid": g, "walls": ["slip", "no-slip"] * d, "kernel": "wendland", "radius": 1.2}
        plain = {k: v for k, v in sph.items() if k != "walls"}
        sorted_ = {"position": x, "cell_start": start}
        surface = {"active": self.flags(), "depth": self.cells(-1.0, 1.0)}
        closed = m.closed_faces or [(np.zeros(0, np.int64), np.zeros((0, 2 * d + 1)))] * d
        kind = _core.Grid2 if d == 2 else _core.Grid3
        solver = (_core.PressureSolver2 if d == 2 else _core.PressureSolver3)(g)
        matrix = (_core.MassMatrix2 if d == 2 else _core.MassMatrix3)(g)
        if self.random.integers(2):
            solver.setup(self.flags(), self.faces(0.0, 1.0), cells)
        inertia = self.each(d).astype(np.float32)
        none = [np.zeros(f.shape, np.int32) for f in faces]
        crossing = {
            "number": m.material or none,
            "table": m.materials,
            "cell_inertia": m.listed("inertia"),
            "uniform": m.listed("uniform"),
        }
        halves = tuple(2 * k for k in self.grid.shape)
        surfaces = Surfaces(self.grid, m.open_cells, m.bodies, m.solids)
        rough = RoughWalls.of(surfaces, [0.0] * len(m.solids), {"bottom": 0.01, "top": 0.0})
        nowhere = np.zeros(0, np.int64)
        walls = tuple(rough[:4]) if rough else (nowhere, np.zeros(1, np.int64), nowhere, np.zeros((0, d + 2)))
        named = lambda name, arguments, *written: (name, getattr(_core, name), arguments, written)  # noqa: E731
        return [
            named("cell_sort", {"grid": g, "position": x, "cell": self.integers(n), "order": self.integers(n),
                                "start": start}, "cell", "order", "start"),
            named("sort_particles", {"grid": g, "position": x, "velocity": u, "volume": volume,
                                     "spare": np.zeros((n, d)), "order": self.integers(n), "start": start},
                  "position", "velocity", "volume", "spare", "order", "start"),
            named("scatter_cells", {"grid": g, "start": start, "position": x, "amount": volume, "out": cells,
                                    "paddles": paddles, "factor": self.cells(), "gates": gates}, "out"),
            named("gather_cells", {"grid": g, "position": x, "field": cells, "out": np.zeros(n)}, "out"),
            named("sample_medium", {"grid": g, **crossing, "porosity": pores,
                                    "position": x, "volume": volume, "bulk": np.zeros(n),
                                    "inertia": np.zeros((n, d), np.float32), **beside}, "bulk", "inertia"),
            named("hold_faces", {"grid": g, "active": self.flags(), "open": m.listed("open_cells"),
                                 "contrast": m.listed("contrast"), "most": 3.0, "held": self.face_flags()}, "held"),
            named("carry", {"grid": g, **crossing, "held": self.face_flags(), "porosity": pores,
                            "coefficient": m.listed("coefficient"), "dt": 0.1, "position": x, "volume": volume,
                            "bulk": self.each(), "inertia": inertia, "u": u, "lag": m.listed("coefficient"),
                            "ago": self.each(), **beside}, "bulk", "inertia", "u"),
            named("fall_behind", {"grid": g, **crossing, "held": self.face_flags(), "lag": m.listed("open_cells"),
                                  "porosity": pores, "velocity": faces, "dt": 0.1, "change": self.faces(), **beside},
                  "change"),
            named("settle", {"grid": g, **crossing, "held": self.face_flags(), "velocity": faces, "position": x, "u": u,
                             "affine": self.each(d, d), **beside}, "u", "affine"),
            named("cell_energy", {"grid": g, "near": self.flags(), "position": x, "bulk": self.each(),
                                  "inertia": inertia, "u": u, "out": cells}, "out"),
            named("scale_by_cell", {"grid": g, "share": cells, "position": x, "u": u}, "u"),
            named("to_faces", {**cloud, "u": u, "affine": self.each(d, d), "velocity": faces, "face_mass": positive,
                               **beside}, "velocity", "face_mass"),
            named("add_residual", {**cloud, "u": u, "face_mass": positive, "velocity": faces, "work": self.faces(),
                                   **beside}, "velocity", "work"),
            named("to_particles", {**cloud, "now": faces, "change": self.faces(), "drag": positive, "flip": 0.9,
                                   "u": u, **beside},
                  "u"),
            named("affine_from", {**cloud, "velocity": faces, "affine": self.each(d, d), **beside}, "affine"),
            named("column_heights", {"grid": g, "start": start, "position": x, "volume": volume,
                                     "height": self.columns(), "paddles": paddles, "gates": gates}, "height"),
            named("column_levels", {"grid": g, "height": self.columns(), "porosity": self.columns() + 0.1,
                                    "fill": cells,
                                    "inverse_capacity": self.cells(), "column": mixed.column, "start": mixed.start,
                                    "pieces": mixed.pieces, "level": self.columns()}, "level"),
            named("find_surface", {"grid": g, "fill": cells, "open": m.listed("open_cells"), "level": self.columns(),
                                   "depth": self.cells(), "active": self.flags(), "column": self.columns(),
                                   "eta": self.columns(), "gates": gates}, "depth", "active", "column", "eta"),
            named("water_above", {"grid": g, "fill": cells, "row": 1}),
            named("water_held", {"grid": g, "active": self.flags(), "open": m.listed("open_cells"), "fill": cells,
                                 "inverse_capacity": self.cells(), "height": self.columns(),
                                 "column": np.arange(self.columns().size), "held": np.zeros(self.columns().size)},
                  "held"),
            named("density_excess", {"grid": g, **surface, "column": self.columns(), "eta": self.columns(),
                                     "fill": cells, "open": m.listed("open_cells"), "porosity": pores, "omega": 0.5,
                                     "rhs": self.cells()}, "rhs"),
            named("apply_forces", {"grid": g, "u": faces, "number": numbers, "table": table,
                                   "rate": self.faces(0.0, 1.0), "energy": m.listed("energy"),
                                   "held": self.face_flags(),
                                   "gravity": [0.0] * (d - 1) + [-9.81], "extra": self.faces(), "dt": 0.01,
                                   "star": self.faces(), "drag": self.faces(), "mobility": self.faces()},
                  "star", "drag", "mobility"),
            named("drag_work", {"grid": g, "number": numbers, "table": m.materials, "rate": [], "mass": positive,
                                "mobility": self.faces(), "before": faces, "after": self.faces()}),
            named("eddy_viscosity", {"grid": g, "u": faces, "molecular": 1e-6, "constant": 0.2, "nu": self.cells()},
                  "nu"),
            named("viscous_acceleration", {"grid": g, "u": faces, "mass": positive, "least": 1e-3, "molecular": 1e-6,
                                           "nu": self.cells(), "porosity": pores, "out": self.faces()}, "out"),
            named("rub", {"grid": g, "walls": walls, "start": start, "position": x, "volume": volume,
                          "bulk": self.each(), "inertia": inertia, "fill": cells, "nu": 1e-6, "dt": 0.1, "velocity": u,
                          "impulse": np.zeros((len(walls[3]), d))}, "velocity", "impulse"),
            named("wall_shear", {"speed": 1.0, "distance": 0.01, "nu": 1e-6, "roughness": 1e-3}),
            named("face_kinetic_energy", {"grid": g, "mass": positive, "number": numbers, "table": m.materials,
                                          "u": faces}),
            named("face_power", {"grid": g, "mass": positive, "u": faces, "acceleration": self.faces()}),
            named("pressure_system", {"grid": g, **surface, "open": singles, "mobility": positive, "step": 0.01,
                                      "star": faces, "least": 1e-6, "k": self.faces(), "e": cells, "rhs": self.cells()},
                  "k", "e", "rhs"),
            named("project", {"grid": g, **surface, "open": singles, "mobility": positive, "step": 0.01,
                              "pressure": cells, "least": 1e-6, "u": faces, "valid": self.face_flags(), "still": False},
                  "u", "valid"),
            named("extrapolate", {"grid": g, "layers": 6, "near": 2, "mass": positive, "keep_mass": 0.5, "u": faces,
                                  "known": self.face_flags()}, "u", "known"),
            named("continue_upwards", {"grid": g, "layers": 2, "active": self.flags(), "column": self.columns(),
                                       "u": faces}, "u"),
            named("stop_at_solids", {"grid": g, "closed": list(closed), "velocity": faces}, "velocity"),
            named("move", {"grid": g, "u": faces, "porosity": pores, "own": u, "volume": volume, "bulk": self.each(),
                           "solids": solid, "gates": gates, "dt": 0.1, "position": x, "paddles": paddles, **beside},
                  "position"),
            named("travel", {"grid": g, "dt": 0.1, "u": faces, "mass": positive, "least": 1e-3, "porosity": pores,
                             "way": singles}, "way"),
            named("drift", {"grid": g, "from_": x, "u": u, "porosity": self.each(), "solids": solid, "gates": gates,
                            "dt": 0.1, "position": x.copy(), "paddles": paddles}, "position"),
            named("displace", {"grid": g, "displacement": faces, "porosity": pores, "solids": solid, "gates": gates,
                               "limit": 0.1, "position": x, "paddles": paddles}, "position"),
            named("leave_solids", {"grid": g, "solids": solid, "position": x}, "position"),
            named("kinetic_energy", {"bulk": volume, "inertia": inertia, "u": u}),
            named("all_finite", {"x": x}),
            named("max_speed", {"u": u, "volume": volume, "bulk": self.each()}),
            named("total", {"value": volume}),
            named("weighted_sum", {"weight": volume, "value": u, "column": d - 1}),
            named("remesh_conservative", {"grid": g, "cell_porosity": pores, "body": m.body, "solids": solid,
                                          "position": x, "velocity": u, "volume": volume,
                                          "porosity": self.each(), "first": 0, "last": -1, **beside, "along": True,
                                          "gates": gates}),
            named("remesh_conservative", {"grid": g, "cell_porosity": None, "body": np.zeros(halves, np.int8),
                                          "solids": None, "position": x, "velocity": u, "volume": volume,
                                          "porosity": None,
                                          "first": 1, "last": 2}),
            named("remesh_paper", {"grid": g, "position": x, "velocity": u, "volume": volume, "porosity": self.each(),
                                   "threshold": 0.01, "gates": gates}),
            named("sph_density_sum", {**sph, **sorted_, "bulk": volume, "out": np.zeros(n)}, "out"),
            named("sph_viscous_acceleration", {**sph, **sorted_, "velocity": u, "bulk": volume,
                                               "viscosity": self.each(), "out": np.zeros((n, d))}, "out"),
            named("sph_velocity_gradient", {**plain, **sorted_, "velocity": u, "bulk": volume,
                                            "out": np.zeros((n, d, d))}, "out"),
            ("setup", solver.setup, {"active": self.flags(), "k": self.faces(0.0, 1.0), "e": cells}, ()),
            ("solve", solver.solve, {"rhs": cells, "p": self.cells(), "tolerance": 1e-6, "max_iterations": 50,
                                     "guess": cells.astype(np.float32)}, ("p", "guess")),
            ("transfer", matrix.transfer, {"position": x, "mass": volume, "start": start, "u": u, "order": 4,
                                           "velocity": faces, "face_mass": positive, "work": self.faces(),
                                           "lent": np.zeros(100), **beside}, ("velocity", "face_mass", "work", "lent")),
            ("Grid", kind, {"shape": list(self.grid.shape), "spacing": list(self.grid.spacing),
                            "periodic": list(self.grid.periodic)}, ()),
        ]  # fmt: skip


# ---- spoiling --------------------------------------------------------------------------------------------------------


def spoil(value: Any, random: np.random.Generator, others: list[np.ndarray]) -> Any:
    """Another value in the place of one."""
    if isinstance(value, np.ndarray):
        return spoil_array(value, random, others)
    if isinstance(value, tuple | list) and len(value) and random.random() < 0.7:
        k = int(random.integers(len(value)))
        changed = list(value)
        changed[k] = spoil(value[k], random, others)
        return changed
    if isinstance(value, tuple | list):
        return choose(
            random, [None, [], list(value)[:-1], [*value, *value[:1]], 7, "list", np.zeros(3), list(value) * 2]
        )
    if isinstance(value, str):
        return choose(random, ["", "x" * 5000, "linear\0", None, 3, b"linear", []])
    if isinstance(value, bool | float | int):
        return choose(random, [None, -1, 0, 7, 2**31, 2**40, 2**63 - 1, -(2**63), 10**30, 0.5, -1e300, 1e300, 1e-300,
                               float("nan"), float("inf"), -float("inf"), "1", [], np.zeros(2)])  # fmt: skip
    return choose(random, [None, 0, "grid", [], np.zeros((3, 3)), object()])


def spoil_array(a: np.ndarray, random: np.random.Generator, others: list[np.ndarray]) -> Any:
    kind = random.integers(11)
    if kind == 0:
        return a.astype(
            choose(random, [np.float64, np.float32, np.int32, np.int64, np.uint8, bool, complex, object, "U4"])
        )
    if kind == 1:
        return np.resize(
            a, choose(random, [0, 1, 2, a.size + 1, max(a.size - 1, 0), 2 * a.size + 3, (a.size, 1), (1, a.size)])
        )
    if kind == 2:
        return choose(random, [np.asfortranarray(a), a.T, a[::-1], a[..., None], a.reshape(-1)])
    if kind == 3:
        wide = np.zeros((*a.shape[:-1], 2 * a.shape[-1]), a.dtype)
        return wide[..., ::2]
    if kind == 4:
        fixed = a.copy()
        fixed.flags.writeable = False
        return fixed
    if kind == 5:
        return a.astype(a.dtype.newbyteorder())
    if kind == 6:
        raw = np.zeros(a.nbytes + 1, np.uint8)[1:]
        moved = np.frombuffer(raw, np.uint8).view(a.dtype).reshape(a.shape)
        return moved
    if kind == 7:
        return choose(random, [None, a.tolist(), 1.0, "array", a.tobytes(), {}])
    if kind == 8 and others:
        return choose(random, others)
    wrong = a.copy()  # another content
    if wrong.size == 0:
        return None
    few = random.integers(0, wrong.size, 1 + wrong.size // 3)
    if wrong.dtype.kind == "f":
        limits = [np.nan, np.inf, -np.inf, -1.0, 0.0, 1e9, -1e9] + ([1e300, -1e300, 5e-324] if a.itemsize == 8 else [])
        wrong.flat[few] = choose(random, limits)
    else:
        ends = np.iinfo(wrong.dtype)
        wrong.flat[few] = choose(
            random, [n for n in (-1, 1, 7, 255, 10**6, ends.min, ends.max) if ends.min <= n <= ends.max]
        )
    return wrong


def choose(random: np.random.Generator, values: list) -> Any:
    return values[int(random.integers(len(values)))]


def arrays(value: Any) -> list[np.ndarray]:
    """All in a value."""
    if isinstance(value, np.ndarray):
        return [value]
    return [a for part in value for a in arrays(part)] if isinstance(value, tuple | list) else []


def unseen(before: Any, after: Any, written: bool) -> bool:
    """Whether an array differs in type or layout from the valid one, so that the core can only have used a copy."""
    if isinstance(before, np.ndarray) and isinstance(after, np.ndarray):
        fits = after.dtype == before.dtype and after.flags.c_contiguous and after.flags.aligned
        return not fits or (written and not after.flags.writeable)
    if isinstance(before, tuple | list) and isinstance(after, tuple | list):
        return any(unseen(b, a, written) for b, a in zip(before, after, strict=False))
    return isinstance(before, np.ndarray) and not isinstance(after, bytes)  # which are an array of uint8


# ---- the campaign ----------------------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def world(number: int) -> World:
    return World(np.random.default_rng(number))


def spoiled_call(seed: int) -> tuple[Call, dict[str, Any], list[str]]:
    """A call, its spoiled arguments, and the names of those that were."""
    random = np.random.default_rng(seed)
    here = world(seed // CALLS_PER_WORLD)  # as it was: only a child calls, and it ends
    here.random = random
    call = choose(random, here.calls())
    names = list(call.arguments)
    chosen = [
        names[int(k)] for k in random.choice(len(names), 1 + int(random.random() < 0.2) * (len(names) > 1), False)
    ]
    others = [a for value in call.arguments.values() for a in arrays(value)]
    return call, {k: spoil(v, random, others) if k in chosen else v for k, v in call.arguments.items()}, chosen


def outcome(seed: int) -> str:
    """What the call did, in one word, and the finding if it is one."""
    call, arguments, chosen = spoiled_call(seed)
    told = f"{call.function}({', '.join(f'{name} = {brief(arguments[name])}' for name in chosen)})"
    try:
        if seed % 2:
            call.target(**arguments)
        else:
            call.target(*arguments.values())
    except REFUSALS as error:
        text = str(error)
        called = call.function == "Grid" or call.function in text
        named = called and any(name.rstrip("_") in text for name in call.arguments)
        return "refused" if named or isinstance(error, FloatingPointError) else f"unnamed: {told}: {text}"
    except Exception as error:  # whatever else
        return f"other error: {told}: {type(error).__name__}: {error}"
    copies = [n for n in chosen if unseen(call.arguments[n], arguments[n], n in call.written)]
    optional = [n for n in copies if arguments[n] is None]  # left out
    return f"silent copy of {copies[0]}: {told}" if len(copies) > len(optional) else "done"


def brief(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"{value.dtype}{value.shape}"
    return repr(value)[:80]


def in_child(seed: int) -> str:
    """outcome(seed) of a child process, or how it ended."""
    world(seed // CALLS_PER_WORLD)  # built here, once for some calls
    receive, send = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(receive)
            resource.setrlimit(resource.RLIMIT_CPU, (CPU_SECONDS, CPU_SECONDS + 1))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            os.dup2(os.open(os.devnull, os.O_WRONLY), 2)
            os.write(send, pickle.dumps(outcome(seed)[:3000]))
        finally:
            os._exit(0)
    os.close(send)
    ready = select.select([receive], [], [], WALL_SECONDS)[0]
    if not ready:
        os.kill(child, signal.SIGKILL)
    data = os.read(receive, 65536) if ready else b""
    os.close(receive)
    status = os.waitpid(child, 0)[1]
    if data:
        return pickle.loads(data)
    number = os.WTERMSIG(status) if os.WIFSIGNALED(status) else 0
    if number in (signal.SIGXCPU, signal.SIGKILL):
        word = "hang"
    else:
        word = f"crash (signal {number})" if number else f"ended with status {status}"
    call, arguments, chosen = spoiled_call(seed)
    return f"{word}: {call.function}({', '.join(f'{name} = {brief(arguments[name])}' for name in chosen)})"


def campaign(calls: int, seed: int, say: Callable[[str], None] = print) -> Counter[str]:
    """Runs the calls; returns how many ended in which way. Each finding is told with the seed of its call."""
    _core.set_threads(1)  # a child has none but its own
    warnings.simplefilter("ignore")
    found: Counter[str] = Counter()
    for k in range(calls):
        own = seed * 1_000_000 + k
        result = in_child(own)
        word = result.partition(":")[0].partition(" (")[0].partition(" of ")[0]
        found[word] += 1
        if result not in ("refused", "done"):
            say(f"call {own}: {result}")
    return found


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n\n")[0])
    parser.add_argument("--calls", type=int, default=5000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--call", type=int, help="run this one, in this process: for a debugger")
    given = parser.parse_args()
    if given.call is not None:
        print(outcome(given.call))
        return
    begin = time.perf_counter()
    found = campaign(given.calls, given.seed)
    print(f"{given.calls} calls in {time.perf_counter() - begin:.0f} s:", dict(found))
    sys.exit(any(word not in ("refused", "done") for word in found))


if __name__ == "__main__":
    main()

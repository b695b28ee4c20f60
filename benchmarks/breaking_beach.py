"""Where waves that break on a beach lose their energy: the ledger of a run by place, beside the laboratory.

    python benchmarks/breaking_beach.py run beach.npz [--spacing 0.015] [--end 116] [--set numerics.order=8 ...]
    python benchmarks/breaking_beach.py show beach.npz [more.npz ...]
    python benchmarks/breaking_beach.py theory

`run` computes the shipped case `beach` (Hansen & Svendsen 1979, test 061071) and keeps, for every column of cells
and as means over the last periods: height and mean level of the waves, their flux of energy

    F = 1/h sum V u (p/rho + g (z - d) + |u|^2/2)      over the particles of the column of width h [m4/s3],

and what the transfers, the position correction and the remeshing took from the water there (`houle.flow.ledger`). In
steady waves -dF/dx is what is lost at a place. What these three have not taken is lost by the pressure and the motion
with it: where water meets water it is stopped at once.

`show` prints one table by gauge and one by stretch of the beach. `theory` prints what steady waves do that keep
their flux of energy, without friction and with laminar friction at the bed and the side walls of the laboratory's
flume, 0.6 m wide (stream function waves in a closed flume; friction by Stokes' layer under every harmonic).
"""

from __future__ import annotations

import argparse
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

import houle
from houle.case.build import build
from houle.case.reading import parse_override
from houle.flow.ledger import Ledger
from houle.flow.simulation import Simulation
from houle.flow.state import Flow
from houle.grid import FloatArray
from houle.observe.points import at_points
from houle.validation.measure import read_points
from houle.waves.fenton import fenton
from houle.waves.wave import WaveError

DEPTH, PERIOD, TOE, SLOPE, GRAVITY = 0.36, 1.6667, 4.0, 1 / 34.26, 9.81  # of the shipped case
WIDTH, VISCOSITY = 0.6, 1.0e-6  # of the laboratory's flume [m], of water [m2/s]
STRETCHES = (-3.0, 0.0, 4.0, 6.5, 7.5, 8.5, 9.5, 10.5, 12.3, 15.0)  # x from the toe [m]
RECORD = Path(houle.__file__).parent / "validation" / "beach" / "data" / "heights.csv"
LOST = ("transfer", "correction", "remeshing")  # operations that take energy where they act


class LedgerByPlace(Ledger):
    """A ledger that books in every column of cells what operations change in the energy there, while it is `opened`.

    Of the transfers and remeshing it is the kinetic energy, as both leave the potential energy of the water alone; of
    the position correction it is the height through which it moves the water. change: per operation of `LOST`, (nx,)
    [m4/s2] since it was opened; a face counts half for each of its two columns.
    """

    def __init__(self, flow: Flow) -> None:
        super().__init__(flow)
        self.opened = False
        self.change = {name: np.zeros(flow.grid.shape[0]) for name in LOST}
        self.before: FloatArray = np.zeros(0)

    def operation(self, name: str) -> Any:
        """Notes the state before an operation that is booked by place."""
        if self.opened and name in LOST:
            self.before = self._state(name)
        return super().operation(name)

    def book(self, name: str) -> None:
        """Books as the ledger does, and the change in each column."""
        super().book(name)
        if self.opened and name in LOST:
            self.change[name] += self._change(name)

    def _state(self, name: str) -> FloatArray:
        flow: Any = self.flow
        return flow.particles.position[:, 1].copy() if name == "correction" else self._kinetic()

    def _change(self, name: str) -> FloatArray:
        flow: Any = self.flow
        if name != "correction":
            return self._kinetic() - self.before
        p = flow.particles
        lifted = GRAVITY * p.volume * (p.position[:, 1] - self.before)
        return np.bincount(column_of(flow), lifted, minlength=flow.grid.shape[0])

    def _kinetic(self) -> FloatArray:
        """Kinetic energy in each column (nx,) [m4/s2], of the faces between the transfers and of the particles else."""
        flow: Any = self.flow
        p = flow.particles
        if not self._on_grid:
            energy = 0.5 * p.volume * np.einsum("ij,ij->i", p.velocity, p.velocity)
            return np.bincount(column_of(flow), energy, minlength=flow.grid.shape[0])
        faces = zip(flow.work.face_mass, flow.velocity, strict=True)
        along, up = (0.5 * (mass * u * u).sum(axis=1) for mass, u in faces)
        return up + 0.5 * (along[:-1] + along[1:])


def column_of(flow: Flow) -> Any:
    """Number of the column in which each particle is (N,)."""
    number = (flow.particles.position[:, 0] / flow.grid.spacing[0]).astype(np.int64)
    return np.minimum(number, flow.grid.shape[0] - 1)


def fluxes(flow: Flow) -> tuple[FloatArray, FloatArray]:
    """Flux of energy [m4/s3] and flux of momentum with the pressure [m3/s2] through each column (nx,), over density."""
    p, pressure = flow.particles, at_points(flow, flow.particles.position)[0]
    u, square = p.velocity[:, 0], np.einsum("ij,ij->i", p.velocity, p.velocity)
    head = pressure + GRAVITY * (p.position[:, 1] - DEPTH) + 0.5 * square
    where, n = column_of(flow), flow.grid.shape[0]
    energy = np.bincount(where, p.volume * u * head, minlength=n)
    momentum = np.bincount(where, p.volume * (u * u + pressure), minlength=n)
    return energy / flow.grid.spacing[0], momentum / flow.grid.spacing[0]


class Means:
    """Means over the last periods of a run, per column of cells (nx,).

    sums  integrals over the time `span` [s] of level, flux of energy and of momentum
    high, low  highest and lowest level of each period (periods, nx) [m]
    """

    def __init__(self, columns: int, begin: float, periods: int) -> None:
        self.begin, self.periods, self.span = begin, periods, 0.0
        self.sums = {name: np.zeros(columns) for name in ("level", "energy_flux", "momentum_flux")}
        self.high, self.low = np.full((periods, columns), np.nan), np.full((periods, columns), np.nan)

    def add(self, simulation: Simulation) -> None:
        """Takes in the step that was just done."""
        flow, dt = simulation.flow, simulation.step_size
        wave = min(int((simulation.time - self.begin) / PERIOD), self.periods - 1)
        self.high[wave], self.low[wave] = np.fmax(self.high[wave], flow.eta), np.fmin(self.low[wave], flow.eta)
        for name, value in zip(self.sums, (flow.eta - DEPTH, *fluxes(flow)), strict=True):
            self.sums[name] += dt * value
        self.span += dt

    def write(self, out: Path, ledger: LedgerByPlace, x: FloatArray, **more: Any) -> None:
        """Writes the means so far."""
        height = self.high - self.low
        numbers = {name: value / self.span for name, value in (self.sums | ledger.change).items()}
        known = height[: max(1, int(self.span / PERIOD + 0.1))]
        np.savez(out, x=x, height=known.mean(axis=0), scatter=known.std(axis=0), span=self.span, **numbers, **more)


def run(out: Path, spacing: float, end: float, periods: int, overrides: dict[str, Any]) -> None:
    """Runs the case and writes the means over its last periods, and the mean level of each period before."""
    keys = {"domain.spacing": spacing, "time.end": end, **overrides}
    simulation = Simulation(build(houle.load("beach", keys)), threads=1)
    x, begin = simulation.grid.axis_points(0) - TOE, end - periods * PERIOD
    ledger = simulation.ledger = LedgerByPlace(simulation.flow)
    means, levels, level, told = Means(len(x), begin, periods), [], np.zeros(len(x)), 0.0
    ledger.open()
    while simulation.time < end - 1e-9:
        simulation.advance(end)
        level += simulation.step_size * (simulation.flow.eta - DEPTH)
        ledger.opened = simulation.time >= begin
        if ledger.opened:
            means.add(simulation)
        if simulation.time - told < PERIOD:
            continue
        levels.append(level / (simulation.time - told))
        level, told = np.zeros(len(x)), simulation.time
        shore = 1e3 * float(np.interp(10.455, x, levels[-1]))
        print(f"t = {told:.2f} s, {simulation.steps} steps, level at the last gauge {shore:.2f} mm", flush=True)
        if ledger.opened:
            means.write(out, ledger, x, levels=np.array(levels), spacing=spacing)
    means.write(out, ledger, x, levels=np.array(levels), spacing=spacing)


def show(files: list[Path]) -> None:
    """Prints the tables of each file."""
    for file in files:
        numbers = dict(np.load(file))
        print(f"\n{file}: spacing {1e3 * numbers['spacing']:g} mm, {numbers['span'] / PERIOD:.1f} periods")
        by_gauge(numbers)
        by_stretch(numbers)


def by_gauge(n: dict[str, FloatArray]) -> None:
    """Height and mean level at every third gauge up to breaking and at all behind it, beside the record."""
    record, whole = read_points(RECORD), max(1, round(float(n["span"]) / PERIOD))
    n = n | {"level": n["levels"][-whole:].mean(axis=0)}  # of whole periods, also where the run was cut short
    print("  x [m]   H [mm]  run   rec   off    level [mm] run   rec")
    for i, row in enumerate(record):
        if row["x_m"] < 6.5 and i % 3:
            continue
        height, level, spread = (
            1e3 * np.interp(row["x_m"], n["x"], n[name]) for name in ("height", "level", "scatter")
        )
        off = 100 * (height / (1e3 * row["height_m"]) - 1)
        print(
            f"{row['x_m']:7.2f}   {height:7.1f} ({spread:4.1f}) {1e3 * row['height_m']:6.1f} {off:+6.1f} %"
            f"   {level:7.2f} {1e3 * row['setup_m']:7.2f}"
        )
    inside = np.isfinite(n["height"]) & (n["x"] > 5.0) & (n["x"] < 11.0)
    x, height = n["x"][inside], n["height"][inside]
    place = x[height.argmax()]
    print(f"breaks at x = {place:.2f} m, H_b = {1e3 * height.max():.1f} mm; record 8.22 m, 103.6 mm")
    gauges = record["x_m"]
    run = np.interp(gauges, n["x"], n["height"])
    for begin, end in ((0.0, 6.5), (8.3, 10.5)):
        part = (gauges > begin) & (gauges < end)
        print(f"height from {begin} to {end} m off by {100 * (run / record['height_m'] - 1)[part].mean():+.1f} %")


def by_stretch(n: dict[str, FloatArray]) -> None:
    """What is lost per stretch in units of the flux at the toe [%], by operation and by the flux of energy."""
    x, h = n["x"], n["x"][1] - n["x"][0]
    flux = np.convolve(n["energy_flux"], np.ones(9) / 9, mode="same")
    unit = float(np.interp(0.0, x, flux))
    print(f"flux of energy at the toe {1000 * unit:.4f} W/m; shares of it [%]:")
    print("  from    to   -dF    " + "  ".join(f"{name:>10}" for name in (*LOST, "pressure")))
    for a, b in pairwise(STRETCHES):
        inside = (x >= a) & (x < b)
        drop = -float(np.interp(b, x, flux) - np.interp(a, x, flux))
        taken = [-float(n[name][inside].sum()) for name in LOST]
        row = [*taken, drop - sum(taken)]
        print(f"{a:6.1f} {b:5.1f} {100 * drop / unit:6.2f}  " + "  ".join(f"{100 * v / unit:10.2f}" for v in row))
    print(f"columns are {1e3 * h:.1f} mm wide")


# ---- steady waves that keep their energy ---------------------------------------------------------------------------


def theory(height: float = 0.0692) -> None:
    """Prints the heights that steady waves have on the beach."""
    record = read_points(RECORD)
    ways = {"no friction": (0.0, 0.0), "bed": (1.0, 0.0), "bed and walls": (1.0, 2.0 / WIDTH)}
    found = {name: shoaled(height, *rubs) for name, rubs in ways.items()}
    print("  x [m]   record " + "".join(f"{name:>15}" for name in found) + "      H [mm]")
    for i, x in enumerate(np.arange(0.0, 7.51, 0.5)):
        known = 1e3 * np.interp(x, record["x_m"], record["height_m"])
        rows = [f"{1e3 * heights[2 * i]:15.1f}" if 2 * i < len(heights) else " " * 15 for heights in found.values()]
        print(f"{x:7.2f} {known:8.1f} " + "".join(rows))


def shoaled(height: float, bed: float, walls: float, step: float = 0.25) -> list[float]:
    """Heights [m] every `step` m from the toe on, until there is no steady wave any more.

    bed is 1 where it rubs, walls the area of the side walls over the depth and the length of the flume [1/m].
    """
    record = read_points(RECORD)
    depth = DEPTH + np.interp(0.0, record["x_m"], record["setup_m"])
    wave = fenton(height, PERIOD, depth, GRAVITY, 0.0, 0.0)
    flux, heights, x = energy_flux(wave), [height], 0.0
    while True:
        on_bed, on_walls = friction(wave)
        flux -= step * (bed * on_bed + walls * on_walls)
        x += step
        depth = DEPTH - SLOPE * x + np.interp(x, record["x_m"], record["setup_m"])
        try:
            wave = _wave_with(flux, depth, heights[-1])
        except WaveError:
            return heights
        heights.append(wave.height)


def _wave_with(flux: float, depth: float, guess: float) -> Any:
    """The steady wave with this flux of energy [m4/s3] in this depth [m], by the secant method from a height [m]."""
    a, b = guess, 1.01 * guess
    low = energy_flux(fenton(a, PERIOD, depth, GRAVITY, 0.0, 0.0)) - flux
    for _ in range(20):
        wave = fenton(b, PERIOD, depth, GRAVITY, 0.0, 0.0)
        high = energy_flux(wave) - flux
        if abs(high) < 1e-9 * flux:
            return wave
        a, b, low = b, b - high * (b - a) / (high - low), high
    return wave


def energy_flux(wave: Any) -> float:
    """Mean flux of energy over density [m4/s3] of a steady wave without transport: c times the mean of int u^2 dz."""
    theta = np.arange(64) * 2 * np.pi / 64
    j = np.arange(1, len(wave.speeds) + 1)[:, None]
    level = wave.depth + (wave.heights[:, None] * np.cos(j * theta)).sum(axis=0)
    points, weights = np.polynomial.legendre.leggauss(24)
    square = []
    for t, top in zip(theta, level, strict=True):
        z = 0.5 * top * (points + 1)
        u = wave.current + (wave.speeds[:, None] * np.cosh(j * wave.k * z) * np.cos(j * t)).sum(axis=0)
        square.append(0.5 * top * float(weights @ u**2))
    return wave.celerity * float(np.mean(square))


def friction(wave: Any) -> tuple[float, float]:
    """What laminar layers take over density, per area of the bed [m3/s3], and per length and width of one wall [m4/s3].

    A layer under a velocity u cos w t takes sqrt(nu w / 2) u^2 / 2.
    """
    j = np.arange(1, len(wave.speeds) + 1)
    rate = 0.5 * np.sqrt(0.5 * VISCOSITY * j * 2 * np.pi / PERIOD)
    points, weights = np.polynomial.legendre.leggauss(24)
    kz = np.outer(j * wave.k, 0.5 * wave.depth * (points + 1))
    square = wave.speeds[:, None] ** 2 * (np.cosh(kz) ** 2 + np.sinh(kz) ** 2)
    return float(rate @ wave.speeds**2), 0.5 * wave.depth * float((rate @ square) @ weights)


def main() -> None:
    """Runs the case, or prints its tables, or those of theory."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("run", "show", "theory"))
    parser.add_argument("files", nargs="*", type=Path)
    parser.add_argument("--spacing", type=float, default=0.015)
    parser.add_argument("--end", type=float, default=70 * PERIOD)
    parser.add_argument("--periods", type=int, default=15)
    parser.add_argument("--set", nargs="*", default=[], metavar="KEY=VALUE")
    given = parser.parse_args()
    if given.what == "theory":
        theory()
    elif given.what == "show":
        show(given.files)
    else:
        overrides = dict(parse_override(text) for text in given.set)
        run(given.files[0], given.spacing, given.end, given.periods, overrides)


if __name__ == "__main__":
    main()

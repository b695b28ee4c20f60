"""What a grid does to a short wave: the decay in a period and the error of the celerity of a wave that runs around.

    python benchmarks/free_waves.py [--spacing 0.02] [--length 0.58] [--depth 0.1] [--amplitude 0.01]
        [--transfer fmpm] [--order 4] [--bed 0] [--periods 20]

A wave of linear theory runs in a tank whose ends are joined, one wavelength long, over its floor or a solid bed of the
height `bed` [m]. The level of the still water is put at five places in a cell, as the answer depends on it: printed is
each, then mean and standard deviation. The default is the third harmonic of waves of 2.02 s over a bar with 0.1 m of
water, in cells of 20 mm. It takes a second or two for each row.
"""

from __future__ import annotations

import argparse

import numpy as np

from houle import load
from houle.case.build import build
from houle.flow.simulation import Simulation
from houle.waves.dispersion import frequency

GRAVITY = 9.81  # m/s2
LEVELS = np.arange(5) / 5  # cells: places of the still water level above that asked for


def tank(given: argparse.Namespace, depth: float) -> Simulation:
    """The tank, its water in the shape and the motion of a wave of linear theory that runs to the right."""
    length, h, a, bed = given.length, given.spacing, given.amplitude, given.bed
    k, still = 2 * np.pi / length, bed + depth
    top = float(np.ceil((still + 2 * a + 3 * h) / h) * h)
    surface = [[float(x), float(still + a * np.cos(k * x))] for x in np.arange(length, -h / 4, -h / 2)]
    case = {
        "case": {"name": "free-wave"},
        "domain": {"size": [length, top], "spacing": h, "walls": {"x": "periodic"}},
        "fluid": {"viscosity": 0.0},
        "water": [{"polygon": [[0.0, 0.0], [length, 0.0], *surface]}],
        "solid": [{"polygon": [[0.0, 0.0], [length, 0.0], [length, bed], [0.0, bed]]}] if bed else [],
        "numerics": {"transfer": given.transfer, "order": given.order},
        "time": {"end": 100.0},
    }
    sim = Simulation(build(load(case)), threads=1)
    water, omega = sim.flow.particles, frequency(k, depth, GRAVITY)
    x, z = water.position[:, 0], water.position[:, 1] - bed
    speed = a * omega / np.sinh(k * depth)
    water.velocity[:, 0] = speed * np.cosh(k * z) * np.cos(k * x)
    water.velocity[:, 1] = speed * np.sinh(k * z) * np.sin(k * x)
    return sim


def decay_and_speed(given: argparse.Namespace, depth: float) -> tuple[float, float]:
    """Decay of the amplitude in a period, and error of the celerity against linear theory, as shares."""
    sim, k = tank(given, depth), 2 * np.pi / given.length
    omega = float(frequency(k, depth, GRAVITY))
    period, x = 2 * np.pi / omega, sim.grid.axis_points(0)
    times, waves = [], []
    while sim.time < given.periods * period:
        sim.advance(given.periods * period)
        times.append(sim.time)
        waves.append(2 * np.mean((sim.flow.eta - given.bed - depth) * np.exp(-1j * k * x)))
    after = np.array(times) > period
    t, c = np.array(times)[after], np.array(waves)[after]
    decay = -np.polyfit(t / period, np.log(np.abs(c)), 1)[0]
    return float(decay), float(-np.polyfit(t, np.unwrap(np.angle(c)), 1)[0] / omega - 1)


def main() -> None:
    """A row for each place of the level, and their mean and standard deviation."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, value in {"spacing": 0.02, "length": 0.58, "depth": 0.1, "amplitude": 0.01, "bed": 0.0}.items():
        parser.add_argument(f"--{name}", type=float, default=value, help="[m]")
    parser.add_argument("--periods", type=float, default=20.0)
    parser.add_argument("--transfer", default="fmpm", choices=("fmpm", "apic", "flip"))
    parser.add_argument("--order", type=int, default=4)
    given = parser.parse_args()
    rows = []
    for level in LEVELS:
        rows.append(decay_and_speed(given, given.depth + level * given.spacing))
        print(f"level at {level:.1f} cells: lost in a period {rows[-1][0]:+.2%}, celerity {rows[-1][1]:+.2%}")
    mean, spread = np.mean(rows, axis=0), np.std(rows, axis=0)
    print(f"mean: {mean[0]:+.2%} (sd {spread[0]:.2%}), celerity {mean[1]:+.2%} (sd {spread[1]:.2%})")


if __name__ == "__main__":
    main()

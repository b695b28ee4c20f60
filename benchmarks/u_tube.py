"""Water that swings in a U-tube with sharp or round inner corners: what it loses there, and where the ledger has it.

    python benchmarks/u_tube.py [--spacing 0.005] [--amplitude 0.01] [--radius 0] [--transfer fmpm] [--order 4]

Two legs of 50 mm, 0.15 m apart, water 0.15 m deep in them, joined by a duct of 50 mm at the bottom; slip walls, no
viscosity. Printed are the period, which by potential flow is 0.904 s (sharp) and 0.881 s (radius 25 mm), the largest
rise between two passages through rest, over the amplitude at the start, and energies in units of that of the start.
"""

from __future__ import annotations

import argparse
from itertools import pairwise

import numpy as np

from houle import load
from houle.case.build import build
from houle.flow.simulation import Simulation
from houle.grid import FloatArray

LEG, BETWEEN, DEPTH, TOP, GRAVITY = 0.05, 0.15, 0.15, 0.25, 9.81  # m, m/s2
WIDTH = 2 * LEG + BETWEEN
END = 2.7  # s: three periods


def wall(radius: float) -> list[list[float]]:
    """Outline of the wall between the legs, its lower corners rounded."""
    turn = np.linspace(0.0, np.pi / 2, 13 if radius else 1)
    left = np.stack([LEG + radius * (1 - np.cos(turn)), LEG + radius * (1 - np.sin(turn))], axis=-1)
    right = np.stack([WIDTH - left[::-1, 0], left[::-1, 1]], axis=-1)
    return [*left.tolist(), *right.tolist(), [WIDTH - LEG, TOP], [LEG, TOP]]


def tube(given: argparse.Namespace) -> Simulation:
    """The tube with its left level raised and its right one lowered by the amplitude. Solids displace water."""
    half, rise = WIDTH / 2, given.amplitude
    case = {
        "case": {"name": "u-tube"},
        "domain": {"size": [WIDTH, TOP], "spacing": given.spacing},
        "fluid": {"viscosity": 0.0},
        "water": [{"box": [[0.0, 0.0], [half, DEPTH + rise]]}, {"box": [[half, 0.0], [WIDTH, DEPTH - rise]]}],
        "solid": [{"polygon": wall(given.radius)}],
        "numerics": {"transfer": given.transfer, "order": given.order},
        "time": {"end": 100.0},
    }
    return Simulation(build(load(case)), threads=1)


def swing(sim: Simulation) -> tuple[FloatArray, FloatArray]:
    """Times [s], and half of what the left level stands above the right one [m]."""
    x = sim.grid.axis_points(0)
    times, rises = [], []
    while sim.time < END:
        sim.advance(END)
        times.append(sim.time)
        rises.append(np.mean(sim.flow.eta[x < LEG]) / 2 - np.mean(sim.flow.eta[x > WIDTH - LEG]) / 2)
    return np.array(times), np.array(rises)


def main() -> None:
    """Period, peaks and ledger."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, value in {"spacing": 0.005, "amplitude": 0.01, "radius": 0.0}.items():
        parser.add_argument(f"--{name}", type=float, default=value, help="[m]")
    parser.add_argument("--transfer", default="fmpm", choices=("fmpm", "apic", "flip"))
    parser.add_argument("--order", type=int, default=4)
    given = parser.parse_args()
    sim = tube(given)
    t, e = swing(sim)
    at = np.flatnonzero(e[1:] * e[:-1] < 0)
    rest = t[at] - e[at] * (t[at + 1] - t[at]) / (e[at + 1] - e[at])
    peaks = [np.abs(e[(t > a) & (t < b)]).max() / given.amplitude for a, b in pairwise(rest)]
    print(f"period {2 * np.mean(np.diff(rest)):.3f} s; peaks", " ".join(f"{p:.3f}" for p in peaks))
    unit = GRAVITY * LEG * given.amplitude**2
    print(", ".join(f"{name} {energy / unit:+.3f}" for name, energy in sim.ledger.energy.items()))


if __name__ == "__main__":
    main()

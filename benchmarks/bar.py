"""Harmonics of waves over a submerged bar, by place: how many cells its crest needs.

    python benchmarks/bar.py [--spacing 0.02] [--transfer fmpm] [--order 4] [--end 28]

Waves of 2.02 s and 20 mm in 0.4 m; the bar rises by 1:20 from 6 m to 0.1 m under water, has its crest from 12 to 14 m
and falls by 1:10 to 17 m (case A of Dingemans 1994, Luth et al. 1994); the tank is that flume from 2.5 to 24 m. Printed
are the amplitudes of the harmonics over the last three periods, root of the mean square over each stretch. Two and a
half minutes in cells of 20 mm, a quarter of an hour in cells of 10 mm.
"""

from __future__ import annotations

import argparse

import numpy as np

from houle import load
from houle.case.build import build
from houle.flow.simulation import Simulation

PERIOD, DEPTH, START = 2.02, 0.4, 2.5  # s, m, place of the left side of the tank in the flume [m]
BAR = [[6.0, 0.0], [12.0, 0.3], [14.0, 0.3], [17.0, 0.0]]
STRETCHES = [(3.5, 6.0), (12.2, 13.9), (15.0, 17.0), (17.0, 18.5), (18.5, 20.0)]  # m
SAMPLES = 40  # in a period


def main() -> None:
    """A row for each stretch."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spacing", type=float, default=0.02)
    parser.add_argument("--transfer", default="fmpm", choices=("fmpm", "apic", "flip"))
    parser.add_argument("--order", type=int, default=4)
    parser.add_argument("--end", type=float, default=28.0, help="[s]")
    given = parser.parse_args()
    case = {
        "case": {"name": "bar"},
        "domain": {"size": [21.5, 0.48], "spacing": given.spacing},
        "water": [{"below": DEPTH}],
        "waves": {"kind": "regular", "height": 0.02, "period": PERIOD, "depth": DEPTH, "ramp": 2 * PERIOD}
        | {"piston": {"x": 0.5, "absorb": True}},
        "solid": [{"polygon": [[x - START, z] for x, z in BAR]}],
        "sponge": [{"box": [[17.5, 0.0], [21.5, 0.48]]}],
        "numerics": {"transfer": given.transfer, "order": given.order},
        "time": {"end": 100.0},
    }
    sim = Simulation(build(load(case)), threads=1)
    x, first = sim.grid.axis_points(0) + START, round(given.end * SAMPLES / PERIOD) - 3 * SAMPLES
    harmonics = np.zeros((4, len(x)), complex)
    for step in range(first, first + 3 * SAMPLES):
        while sim.time < (time := step * PERIOD / SAMPLES) - 1e-9:
            sim.advance(time)
        turn = np.exp(2j * np.pi * np.arange(1, 5) * time / PERIOD)
        harmonics += turn[:, None] * (sim.flow.eta - DEPTH) * 2 / (3 * SAMPLES)
    for low, high in STRETCHES:
        inside = np.abs(harmonics[:, (x > low) & (x < high)])
        sizes = 1e3 * np.sqrt(np.mean(inside**2, axis=1))
        print(f"{low:g} to {high:g} m:", " ".join(f"{size:6.2f}" for size in sizes), "mm")


if __name__ == "__main__":
    main()

"""What a maker sends out beside the bound waves of two waves: free ones of the same frequencies.

    python benchmarks/bound_waves.py {piston,zone,source,both} {1,2} [--spacing 0.025] [--top 0.34375]

Waves of 8 and 6 mm, 0.7 and 1 Hz, in 0.25 m of water. After 20 s the levels are taken over ten seconds, a period of
both waves together. At each sum and difference of the frequencies three waves are fitted to the amplitude along the
flume: a bound one, a free one, and a free one that comes back from the sponge. It takes a minute or two.
"""

from __future__ import annotations

import argparse
from unittest.mock import patch

import numpy as np

from houle import load
from houle.case.build import build
from houle.flow.simulation import Simulation
from houle.grid import FloatArray
from houle.waves.dispersion import wave_number
from houle.waves.linear import Linear
from houle.waves.second_order import Kernel, SecondOrder
from houle.waves.wave import Components

DEPTH, GRAVITY, LENGTH = 0.25, 9.81, 17.0  # m, m/s2, length of the tank [m]
AMPLITUDE, OMEGA = np.array([0.008, 0.006]), 2 * np.pi * np.array([0.7, 1.0])  # m, rad/s
BEGIN, END, SPONGE = 20.0, 30.0, 11.8  # s, s, m
MAKERS = {  # table, and where its waves begin to be looked at [m]
    "piston": ({"piston": {"x": 0.5}}, 2.0),
    "zone": ({"zone": {"x": [0.0, 4.5]}}, 5.2),
    "source": ({"source": {"x": 5.0, "side": "right"}}, 7.2),
    "both": ({"source": {"x": 5.0, "side": "both"}}, 7.2),
}
LINES = {"difference, 0.3 Hz": (1, 0, -1), "sum, 1.7 Hz": (1, 0, 1), "1.4 Hz": (0, 0, 1), "2 Hz": (1, 1, 1)}


def pair(order: int) -> Linear:
    """The two waves, to an order."""
    k = wave_number(OMEGA, DEPTH, GRAVITY)
    parts = Components(AMPLITUDE, OMEGA, k, np.zeros(2), np.zeros(2))
    wave = Linear.of("jonswap", 0.02, 1.2, DEPTH, GRAVITY, parts, 0.02, 0.0)
    return SecondOrder.of_linear(wave, True) if order == 2 else wave


def levels(maker: str, order: int, spacing: float, top: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times [s], places [m] and elevations (time, place) [m] of a run."""
    behind = [(0.0, 3.0)] if maker in ("source", "both") else []
    table = {"kind": "jonswap", "height": 0.02, "period": 1.2, "depth": DEPTH, "order": order, "ramp": 3.0}
    case = {
        "case": {"name": "bound-waves"},
        "domain": {"size": [LENGTH, top], "spacing": spacing},
        "water": [{"below": DEPTH}],
        "waves": table | MAKERS[maker][0],
        "sponge": [{"box": [[a, 0.0], [b, top]]} for a, b in [(SPONGE, LENGTH), *behind]],
        "time": {"end": 100.0},
    }
    with patch("houle.case.model.make", lambda *_: pair(order)):
        sim = Simulation(build(load(case)))
    times, rows = [], []
    while sim.time < END:
        sim.advance(min(END, sim.time + 0.05))
        if sim.time > BEGIN:
            times.append(sim.time)
            rows.append(sim.flow.eta - DEPTH)
    return np.array(times), sim.grid.axis_points(0), np.array(rows)


def main() -> None:
    """Bound and free waves of a maker, in lines."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("maker", choices=MAKERS)
    parser.add_argument("order", type=int, choices=(1, 2))
    parser.add_argument("--spacing", type=float, default=0.025)
    parser.add_argument("--top", type=float, default=0.34375, help="height of the tank [m]: cells are fitted to it")
    given = parser.parse_args()
    time, x, eta = levels(given.maker, given.order, given.spacing, given.top)
    seen = (x > MAKERS[given.maker][1]) & (x < SPONGE - 0.6)
    steps = np.gradient(time)
    for name, (i, j, sign) in LINES.items():
        line = Kernel.of(OMEGA[[i]], OMEGA[[j]], DEPTH, GRAVITY, sign)
        known = (1 if i == j else 2) * AMPLITUDE[i] * AMPLITUDE[j] * abs(float(line.level[0]))
        free = wave_number(line.omega, DEPTH, GRAVITY)[0]
        found = 2 * (steps[:, None] * eta[:, seen] * np.exp(1j * line.omega * time[:, None])).sum(0) / steps.sum()
        waves = np.exp(1j * np.outer(x[seen], [line.wave[0], free, -free]))
        bound, sent, back = 1e3 * np.abs(np.linalg.lstsq(waves, found, rcond=None)[0])
        told = f"bound {bound:.3f} mm (theory {1e3 * known:.3f}), free {sent:.3f} mm, {sent / bound:.1%}"
        print(f"{name:18}  {told}, back {back:.3f} mm")


if __name__ == "__main__":
    main()

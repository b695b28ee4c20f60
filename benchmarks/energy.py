"""The study behind docs/decisions/0001: what each choice does to the energy of a standing wave.

    python benchmarks/energy.py [--spacing 0.02] [--periods 20] [--steps 0.01 0.0025] [NAME ...]

For every variant and time step: amplitude of the fundamental after the last period over the first, its largest value,
error of the period against the non-linear one, and the change of energy by operation over the run in units of the
wave's energy. Pressure work is "forces + projection". An amplitude above 1 is energy made of nothing.
"""

from __future__ import annotations

import argparse
from itertools import product

import numpy as np

import houle
from houle.case.build import build
from houle.flow.simulation import Simulation
from houle.validation.exact import standing_wave_frequency

LENGTH, DEPTH, AMPLITUDE = 1.0, 0.25, 0.02  # of the shipped case
NAMES = {
    "default": {},
    "order 1 (PIC)": {"order": 1},
    "order 2": {"order": 2},
    "order 8": {"order": 8},
    "FLIP 0.97": {"transfer": "flip", "flip": 0.97},
    "FLIP 0.99": {"transfer": "flip", "flip": 0.99},
    "FLIP 1": {"transfer": "flip", "flip": 1.0},
    "APIC": {"transfer": "apic"},
    "quadratic kernel": {"kernel": "quadratic"},
    "PIC, M4'": {"transfer": "pic", "kernel": "m4prime"},
    "Gaussian-Taylor": {"kernel": "gaussian-taylor2"},
    "no remeshing": {"remesh": "none"},
    "remeshing every 50": {"remesh_every": 50},
    "no correction": {"correction": 0.0},
    "full correction": {"correction": 1.0},
    "jh2020": {"scheme": "jh2020"},
}


def measure(keys: dict, spacing: float, step: float, periods: int) -> str:
    """One row of the table."""
    overrides = {"domain.spacing": spacing, "time.step": step, "time.end": 1e3}
    simulation = Simulation(
        build(houle.load("standing-wave", overrides | {f"numerics.{k}": v for k, v in keys.items()}))
    )
    period = 2.0 * np.pi / standing_wave_frequency(AMPLITUDE, np.pi / LENGTH, DEPTH, 9.81)
    time, wave = [], []
    try:
        while simulation.time < periods * period:
            simulation.advance(1e3)
            p = simulation.particles
            time.append(simulation.time)
            wave.append(2.0 / LENGTH * float(np.sum(p.volume * np.cos(np.pi / LENGTH * p.position[:, 0]))))
    except houle.SimulationError as error:
        return f"stops at t/T = {simulation.time / period:.1f}: {str(error)[:60]}"
    t, a = np.array(time), np.array(wave)
    last = a[t > t[-1] - period]
    down = np.flatnonzero((a[:-1] > 0) & (a[1:] <= 0))
    crossings = t[down] + (t[down + 1] - t[down]) * a[down] / (a[down] - a[down + 1])
    error = 100.0 * (np.diff(crossings).mean() / period - 1.0) if len(down) > 2 else np.nan
    unit = 0.25 * 9.81 * AMPLITUDE**2 * LENGTH
    e = {name: value / unit for name, value in simulation.ledger.energy.items()}
    parts = [e["forces"] + e["projection"], e["transfer"], e["advection"], e["correction"], e["remeshing"]]
    numbers = " | ".join(f"{x:+.3f}" for x in parts)
    amplitude = 0.5 * (last.max() - last.min()) / AMPLITUDE
    return f"{amplitude:.3f} | {np.abs(a).max() / AMPLITUDE:.3f} | {error:+.2f} | {numbers}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help=", ".join(NAMES))
    parser.add_argument("--spacing", type=float, default=0.02)
    parser.add_argument("--periods", type=int, default=20)
    parser.add_argument("--steps", type=float, nargs="+", default=[0.01, 0.0025])
    given = parser.parse_args()
    operations = ("pressure work", "transfer", "advection", "correction", "remeshing")
    head = ("variant", "step [ms]", "amplitude", "largest", "period [%]", *operations)
    print("| " + " | ".join(head) + " |")
    print("|---" * len(head) + "|", flush=True)
    for name, step in product(given.names or NAMES, given.steps):
        print(f"| {name} | {1e3 * step:g} | {measure(NAMES[name], given.spacing, step, given.periods)} |", flush=True)


if __name__ == "__main__":
    main()

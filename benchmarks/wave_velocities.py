"""What the velocities of a wave cost, which wave makers and zones ask for in every step.

    python benchmarks/wave_velocities.py [--points 100000]

For each regular theory: milliseconds for that many scattered points, least of five. Then for a random sea of 200
components: the same on a grid of 200 x 50 points, at once and point by point.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable

import numpy as np

from houle.waves.spectra import irregular
from houle.waves.theories import regular

DEPTH, GRAVITY = 0.25, 9.81  # m, m/s2
WAVES = {"airy": (0.002, 1.2), "stokes-5": (0.06, 1.2), "fenton": (0.08, 1.5), "cnoidal": (0.04, 4.0)}  # height, period


def milliseconds(call: Callable[[], object], times: int = 5) -> float:
    """Least time of several calls [ms]."""
    spans = []
    for _ in range(times):
        start = time.perf_counter()
        call()
        spans.append(time.perf_counter() - start)
    return 1e3 * min(spans)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--points", type=int, default=100_000)
    points = parser.parse_args().points
    draw = np.random.default_rng(1)
    x, z = draw.random(points) * 7, draw.random(points) * DEPTH
    for theory, (height, period) in WAVES.items():
        wave = regular(theory, height, period, DEPTH)
        print(f"{theory:20} {milliseconds(lambda: wave.velocity(x, z, 0.3)):8.1f} ms")  # noqa: B023
    sea = irregular("jonswap", 0.04, 1.2, DEPTH, GRAVITY)
    x, z = np.linspace(0, 2, 200), np.linspace(0, 0.5, 50)
    print(f"{'sea on a grid':20} {milliseconds(lambda: sea.velocity_on(x, z, 0.3)):8.1f} ms")
    print(f"{'sea, each point':20} {milliseconds(lambda: sea.velocity(x[:, None], z, 0.3)):8.1f} ms")


if __name__ == "__main__":
    main()

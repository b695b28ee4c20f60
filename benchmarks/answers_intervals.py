"""How often the interval of a mean discharge holds the truth: made-up seas of which a share of the waves overtops.

    python benchmarks/answers_intervals.py [seas]

Volumes are Weibull with the shape b, none in the other waves. Beside the interval of `houle.analysis.mean_interval`
stands that of the percentiles of a bootstrap of single waves. Both ask for 90 %.
"""

from __future__ import annotations

import sys
from math import gamma

import numpy as np

from houle.analysis import mean_interval

SEAS = ((50, 0.06), (80, 0.1), (80, 0.4), (300, 0.03), (300, 0.1), (1000, 0.05))  # waves, share of them that overtops
SHAPES = (0.75, 1.2)
REPEATS = 400


def main(seas: int) -> None:
    """Prints a row for each kind of sea."""
    random = np.random.default_rng(1)
    print("waves  share  b     seas  interval  percentiles")
    for waves, share in SEAS:
        for shape in SHAPES:
            truth, held = share * gamma(1 + 1 / shape), np.zeros(2)
            drawn = 0
            for _ in range(seas):
                volumes = np.where(random.random(waves) < share, random.weibull(shape, waves), 0.0)
                if np.count_nonzero(volumes) < 3:
                    continue
                drawn += 1
                means = volumes[random.integers(0, waves, (REPEATS, waves))].mean(axis=1)
                ends = (mean_interval(volumes), np.percentile(means, [5, 95]))
                held += [low < truth < high for low, high in ends]
            print(f"{waves:5}  {share:5.2f}  {shape:4.2f} {drawn:5}  {held[0] / drawn:8.3f}  {held[1] / drawn:11.3f}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1000)

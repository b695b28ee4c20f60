"""Uncertainty of a coefficient: resampling of periods or frequencies, and disagreement between gauges.

Moving blocks: Kunsch (1989) Ann. Statist. 17, 1217-1241; circular, of n^(1/3) neighbours. The random numbers are
seeded: the same record gives the same interval.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from houle.analysis.separation import LEAST, spread

Real = NDArray[np.float64]
REPEATS = 2000  # samples of the bootstrap
MOST_SUBSETS = 60  # subsets of gauges that are compared


def bootstrap(statistic: Callable[[NDArray], Real], pieces: NDArray, seed: int, repeats: int = REPEATS) -> Real:
    """Standard error (c,) of statistic(pieces), pieces (n, ...) in their order; NaN when n < 2.

    statistic takes (..., n, m) and gives (..., c). Blocks of neighbours are drawn with replacement; the error is
    scaled by sqrt(n / (n - 1)), the share that drawing from the sample itself loses.
    """
    n = len(pieces)
    if n < 2:
        return np.full_like(statistic(pieces), np.nan)
    random = np.random.default_rng(seed)
    block = max(1, round(n ** (1 / 3)))
    starts = random.integers(0, n, (repeats, -(-n // block)))
    rows = ((starts[:, :, None] + np.arange(block)) % n).reshape(repeats, -1)[:, :n]
    return np.std(statistic(pieces[rows]), axis=0) * np.sqrt(n / (n - 1))


def subsets(x: Real, k: float, seed: int) -> list[tuple[int, ...]]:
    """Triples of gauges (pairs when there are three) that tell the two waves apart, MOST_SUBSETS at most."""
    size = 3 if len(x) > 3 else 2
    if len(x) < 3:
        return []
    if len(x) <= 12:
        every = list(itertools.combinations(range(len(x)), size))
    else:
        random = np.random.default_rng(seed)
        every = [tuple(sorted(random.choice(len(x), size, replace=False).tolist())) for _ in range(4 * MOST_SUBSETS)]
    return [s for s in every if spread(k, x[list(s)]) >= LEAST][:MOST_SUBSETS]


def half_width(error: Real, count: int, scatter: Real, confidence: float) -> Real:
    """Half the confidence interval: Student's t for the bootstrap error of `count` pieces, normal for the scatter.

    The two are added in squares; a part that is not known (NaN) is left out; NaN if neither is.
    """
    from scipy.special import ndtri, stdtrit

    rank = 0.5 + confidence / 2
    parts = np.array([stdtrit(max(1, count - 1), rank) * error, ndtri(rank) * scatter])
    known = np.isfinite(parts)
    return np.where(known.any(axis=0), np.sqrt(np.sum(np.where(known, parts, 0.0) ** 2, axis=0)), np.nan)

"""Weibull distribution of volumes or loads: fit by maximum likelihood, with intervals.

P(V > v) = exp(-(v/scale)^shape). Values below `least` may be missing, such as volumes that are not told from noise:
then the likelihood is that of what lies above. The intervals are exact for whole samples of any size: the ratio of the
fitted shape to the true one, and shape times the logarithm of that of the scales, are distributed alike for all Weibull
samples of one size (Thoman, Bain & Antle 1969, Technometrics 11, 445-460). That distribution is drawn with seeded
random numbers; with a least value it is drawn at the fit.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from houle.analysis.errors import AnalysisError

Real = NDArray[np.float64]
FEWEST = 5  # values that tell a shape at all
SHAPES = (0.05, 50.0)  # range in which the shape is looked for
EDGE = 1.001  # a shape so near to an end of the range is that end: the likelihood grows beyond
DRAWS = 100_000  # random numbers of an interval, at most
REPEATS = 1000  # samples of an interval, at most
HALVINGS = 36  # halvings of the range of ln(shape), to 1e-10


@dataclass(frozen=True)
class Weibull:
    """A fitted distribution: `scale` (unit of the values), `shape` [-], their intervals, number of values."""

    scale: float
    shape: float
    scale_interval: tuple[float, float]
    shape_interval: tuple[float, float]
    count: int
    confidence: float

    def expected_largest(self, count: float) -> float:
        """The value exceeded once in `count` values on average: scale (ln count)^(1/shape)."""
        return self.scale * float(np.log(count)) ** (1.0 / self.shape)


def weibull_fit(values: ArrayLike, *, least: float = 0.0, confidence: float = 0.90, seed: int = 0) -> Weibull:
    """Fits values (N,) above `least`. Raises AnalysisError for fewer than 5, nearly equal ones, or not above."""
    v = np.asarray(values, dtype=float).ravel()
    if len(v) < FEWEST:
        raise AnalysisError(f"{len(v)} values do not tell the shape of a distribution: {FEWEST} or more do")
    if not (np.isfinite(v).all() and v.min() > max(least, 0.0) >= 0.0):
        raise AnalysisError(f"Weibull: all values must lie above least = {least:g}; the smallest is {v.min():g}")
    if v.min() == v.max():
        raise AnalysisError(f"Weibull: all {len(v)} values are {v[0]:g}")
    scale, shape = (float(found[0]) for found in _fit(v[None], least))
    if not EDGE * SHAPES[0] < shape < SHAPES[1] / EDGE:
        raise AnalysisError(
            f"Weibull: the {len(v)} values do not determine a shape between {SHAPES[0]:g} and {SHAPES[1]:g}"
        )
    repeats = max(200, min(REPEATS, DRAWS // len(v)))
    random = np.random.default_rng(seed).random((repeats, len(v)))
    below = (least / scale) ** shape
    drawn = (below - np.log1p(-random)) ** (1.0 / shape)  # scale 1
    scales, shapes = _fit(drawn, least / scale)
    ends = (50 * (1 + confidence), 50 * (1 - confidence))
    ratio = np.percentile(shapes / shape, ends)
    shift = np.percentile(shapes * np.log(scales), ends)
    return Weibull(
        scale, shape, (scale * float(np.exp(-shift[0] / shape)), scale * float(np.exp(-shift[1] / shape))),
        (shape / float(ratio[0]), shape / float(ratio[1])), len(v), confidence,
    )  # fmt: skip


def _fit(v: Real, least: float) -> tuple[Real, Real]:
    """Scale and shape (R,) of samples (R, N): the root in b of the likelihood's slope, the scale put in for it.

    1/b + mean(ln v) = sum(v^b ln v - l^b ln l)/sum(v^b - l^b), scale^b = mean(v^b - l^b), with l the least value. The
    slope falls as b grows, so the root is found by halving.
    """
    largest = v.max(axis=1, keepdims=True)
    log_v, log_l = np.log(v / largest), np.log(least / largest) if least > 0.0 else None
    mean_log = log_v.mean(axis=1)
    low, high = np.full(len(v), np.log(SHAPES[0])), np.full(len(v), np.log(SHAPES[1]))
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        above, weighted = _sums(log_v, log_l, np.exp(middle)[:, None])
        rising = np.exp(-middle) + mean_log > weighted / above
        low, high = np.where(rising, middle, low), np.where(rising, high, middle)
    shape = np.exp(0.5 * (low + high))
    above, _ = _sums(log_v, log_l, shape[:, None])
    return largest[:, 0] * above ** (1.0 / shape), shape


def _sums(log_v: Real, log_l: Real | None, b: Real) -> tuple[Real, Real]:
    """Means (R,) of v^b - l^b and of v^b ln v - l^b ln l."""
    power = np.exp(b * log_v)
    above, weighted = power.mean(axis=1), (power * log_v).mean(axis=1)
    if log_l is None:
        return above, weighted
    power_l = np.exp(b * log_l)
    return above - power_l[:, 0], weighted - (power_l * log_l)[:, 0]

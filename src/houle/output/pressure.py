"""The pressure of the particles as an image: each covers the space it fills, so that the water has no gaps."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from matplotlib.colors import Normalize

from houle.flow.snapshot import Snapshot
from houle.grid import FloatArray, Grid

WIDER = 1.42  # side of the mark of a particle over that of the square it fills: marks leave no gaps
SUCTION = 0.1  # share of the largest pressure: a smaller suction is round-off and splashes
BAR = 0.45  # inches that a colour bar takes under the panels


def pressure_image(frame: Snapshot, grid: Grid, y: float, height: float, pixels: tuple[int, int]) -> FloatArray:
    """Pressure [kPa] at the pixels (z, x) of a panel from the floor up to this height [m], NaN where no water is.

    A particle covers a rectangle a little larger than the space it fills (bulk volume); where they overlap, the mean is
    taken. All have the size of the middle one. In 3D the particles within half a cell of y [m] count.
    """
    chosen = np.arange(len(frame.volume))
    if grid.dimension == 3:
        chosen = np.flatnonzero(np.abs(frame.position[:, 1] - y) <= 0.5 * grid.spacing[1])
    volume = frame.volume[chosen] / frame.porosity[chosen]
    side = float(np.median(volume)) ** (1 / grid.dimension) if len(chosen) else 0.0
    size = (grid.size[0], height)
    places = (frame.position[chosen, 0], frame.position[chosen, -1])
    at = [np.floor(p * (n / s)) for p, n, s in zip(places, pixels, size, strict=True)]
    inside = (at[0] >= 0) & (at[0] < pixels[0]) & (at[1] >= 0) & (at[1] < pixels[1])
    pixel = (at[0] * pixels[1] + at[1])[inside].astype(np.int64)
    all_pixels = pixels[0] * pixels[1]
    count = np.asarray(np.bincount(pixel, minlength=all_pixels), float).reshape(pixels)
    weights = frame.pressure[chosen][inside] / 1e3
    total = np.asarray(np.bincount(pixel, weights, all_pixels), float).reshape(pixels)
    for axis, length in enumerate(size):
        reach = int(np.ceil(0.5 * (WIDER * side / length * pixels[axis] - 1.0)))
        count, total = _spread(count, reach, axis), _spread(total, reach, axis)
    return np.divide(total, count, out=np.full(pixels, np.nan), where=count > 0.5).T


def _spread(values: FloatArray, reach: int, axis: int) -> FloatArray:
    """Sum over the neighbours within `reach` along an axis."""
    if reach <= 0:
        return values
    wide = np.pad(values, [(reach + 1, reach) if a == axis else (0, 0) for a in range(values.ndim)])
    sums = np.moveaxis(np.cumsum(wide, axis=axis), axis, 0)
    return np.moveaxis(sums[2 * reach + 1 :] - sums[: -2 * reach - 1], 0, axis)


def pressure_scale(frames: Iterable[Snapshot]) -> Normalize:
    """Colour scale [kPa] from 0, or from the suction in closed ducts, to the largest pressure, without outliers."""
    ends = np.array([np.quantile(f.pressure, (0.01, 0.999)) / 1e3 for f in frames if len(f.pressure)]).reshape(-1, 2)
    high = float(max([1e-3, *ends[:, 1]]))
    low = float(min([0.0, *ends[:, 0]]))
    return Normalize(low if low < -SUCTION * high else 0.0, high)

"""The steps of a cumulative record: where it rises for good, and by how much, through the noise of its gauge.

A record of what has come over rises in steps and stands between them. It stands at a level from the first time that it
is as high to the last time that it is as low: in a step no time at all, or, with noise, as long as it takes to climb
out of it; between steps the whole pause. So steps are told without a measure of the noise, and those of a record
without noise are exact. How long is long, with noise, the record tells too: its times of standing are of two kinds.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

SURE = 3.0  # a step counts if it is higher than so many of its standard errors
SETTLING = 1.0 / 3.0  # share of a pause in which the water in the tank still swings
END = 0.1  # share of a pause in which the next step may already begin
SWING = 2.5  # a swing rises before and after a fall, within so many times its duration
MORE = 1.5  # a drift is taken off if the noise with it is no more than so many times that without
UPWARDS = 0.3  # largest drift upwards, as a share of the steps; more is water that comes over all the time
LAGS = (1.0, 3.0, 10.0)  # spans over which the usual slope is looked for, in times to climb
FALLS = 10  # least number of falls in a record that has noise
BAND = 8.0  # median falls: noise never falls by more
ALIKE = 20  # a record counted in units has so many changes at least, half of them by so many units at most
ROUND_OFF = 1e-12  # share of the record: less is no noise
BINS = 64  # bins in a histogram of times
EDGE = 200  # samples on each side of a fall from which its height is taken, at most
SMOOTH = 0.125  # half width of the running mean, as a share of the time that divides standing from climbing


@dataclass(frozen=True)
class Stairs:
    """The steps of a record: from sample `first` (S,) to `last` (S,), by `heights` (S,), with standard `errors` (S,).

    noise: standard deviation of the record between them; whole: rise from the first level to the last; whole_error: its
    standard error.
    """

    first: Indices
    last: Indices
    heights: Floats
    errors: Floats
    noise: float
    whole: float
    whole_error: float


def standing(v: Floats) -> tuple[Floats, Indices, Indices]:
    """The levels (L,) of a record, rising; the first sample as high as each, and the last as low."""
    level = np.unique(v)
    highest, lowest = np.maximum.accumulate(v), np.minimum.accumulate(v[::-1])[::-1]
    return level, np.searchsorted(highest, level, "left"), np.searchsorted(lowest, level, "right") - 1


def rises(t: Floats, v: Floats, pause: float) -> tuple[Indices, Indices]:
    """First and last sample (S,) of the steps; a level that stands no longer than `pause` [s] is within a step."""
    level, first, last = standing(v)
    if len(level) < 2:
        return np.empty(0, np.intp), np.empty(0, np.intp)
    stands = t[last] - t[first]
    long = stands > pause + 1e-12 * np.ptp(t)
    long[[0, -1]] = True
    first, last = first[long], last[long]
    apart = last[:-1] < first[1:]
    return last[:-1][apart], first[1:][apart]


def climbing(t: Floats, v: Floats) -> float:
    """Time [s] that divides the levels: the record stands at those in a step for less, at those between for longer.

    The logarithms of these times are divided as Otsu (1979, IEEE Trans. Syst. Man Cybern. 9, 62) divides the grey of a
    picture; a level weighs as many samples as it has.
    """
    _, first, last = standing(v)
    samples = np.unique(v, return_counts=True)[1]
    stands = np.maximum(t[last] - t[first], float(np.ptp(t)) / (len(t) - 1))
    count, edges = np.histogram(np.log(stands), BINS, weights=samples)
    middle = 0.5 * (edges[1:] + edges[:-1])
    below = np.cumsum(count)[:-1]
    above, sums = count.sum() - below, np.cumsum(count * middle)
    with np.errstate(divide="ignore", invalid="ignore"):
        apart = below * above * (sums[:-1] / below - (sums[-1] - sums[:-1]) / above) ** 2
    apart = np.nan_to_num(apart)
    best = np.flatnonzero(apart >= apart.max() * (1.0 - 1e-12))
    return float(np.exp(0.5 * (edges[best[0] + 1] + edges[best[-1] + 1])))


def stairs(t: Floats, v: Floats, pause: float) -> Stairs:
    """The steps of a record that only rises, apart from noise and from water that flows back after a step."""
    count = counted_in(v)
    half, smooth = 0, v
    if trembles(v):
        half = max(1, int(SMOOTH * climbing(t, v) * (len(t) - 1) / np.ptp(t)))
        smooth = smoothed(v, half)
        pause = max(pause, climbing(t, smooth))
    first, last = rises(t, smooth, pause)
    blurred = np.minimum(half, (last - first - 1) // 2)
    first, last = first + blurred, last - blurred
    if not half:
        return _exact(v, first, last)
    flats = _flats(first, last, len(v))
    noise = float(np.sqrt(np.mean(np.concatenate([(v[f] - v[f].mean()) ** 2 for f in flats]))))
    noise = max(noise if noise > ROUND_OFF * np.ptp(v) else 0.0, count / 12**0.5)
    while True:
        level, error = np.array([_level(v[f], noise, count) for f in _flats(first, last, len(v))]).T
        heights, errors = np.diff(level), np.hypot(error[1:], error[:-1])
        sure = heights > SURE * errors
        if sure.all():
            break
        first, last = first[sure], last[sure]
    whole_error = float(np.hypot(error[0], error[-1])) if len(level) > 1 else 0.0
    return Stairs(first, last, heights, errors, noise, float(level[-1] - level[0]), whole_error)


def trembles(v: Floats) -> bool:
    """True if the record has noise, false if it is counted in units."""
    return counted_in(v) > 0.0 or noise_of_falls(v) > 0.0


def smoothed(v: Floats, count: int) -> Floats:
    """Running mean over `count` samples on each side, fewer at the ends."""
    sums, i = np.append(0.0, np.cumsum(v - v[0])), np.arange(len(v))
    low, high = np.maximum(i - count, 0), np.minimum(i + count + 1, len(v))
    return v[0] + (sums[high] - sums[low]) / (high - low)


def counted_in(v: Floats) -> float:
    """The unit in which the record is counted: all its changes are whole multiples of it, most small ones; else 0."""
    change = np.abs(np.diff(v))
    change = change[change > 1e-9 * np.ptp(v)]
    if len(change) < ALIKE:
        return 0.0
    unit = float(change.min())
    units = change / unit
    whole = np.abs(units - np.round(units)).max() < 0.01
    return unit if whole and np.median(units) <= ALIKE else 0.0


def _flats(first: Indices, last: Indices, count: int) -> list[slice]:
    """The stretches in which the record stands, before, between and after the steps, once the water has settled."""
    begin, end = np.append(0, last), np.append(first, count - 1) + 1
    settled, still = begin + ((end - begin) * SETTLING).astype(int), end - ((end - begin) * END).astype(int)
    settled[0], still[-1] = 0, count
    return [slice(int(a), int(b)) for a, b in zip(np.minimum(settled, still - 1), still, strict=True)]


def steps_of(t: Floats, v: Floats, pause: float) -> tuple[Stairs, float, float]:
    """The steps of a record without the drift of its gauge, if it has one; that drift [1/s] and its standard error.

    A gauge drifts if the record is no more than noise without one and the same slope in all of its pauses.
    """
    found = stairs(t, v, pause)
    if not trembles(v):
        return found, 0.0, 0.0
    best, slope, error = found, 0.0, 0.0
    most, least = MORE * found.noise or np.inf, MORE * noise_of_falls(v)
    for times in LAGS:
        usual = _usual_slope(t, v, times * climbing(t, v))
        more, its_error = drift(t, v - usual * t, stairs(t, v - usual * t, pause))
        if not abs(usual + more) > SURE * its_error > 0.0:
            continue
        level = stairs(t, v - (usual + more) * (t - t[0]), pause)
        rise, steps = (usual + more) * np.ptp(t), len(level.heights) - len(best.heights)
        little = rise < UPWARDS * level.heights.sum() or (steps < 0 and not len(level.heights))
        quiet = level.noise < (best.noise if slope and steps == 0 else most) and (steps >= 0 or level.noise < least)
        if little and quiet:
            best, slope, error = level, usual + more, its_error
    apart = np.diff([t[f].mean() for f in _flats(best.first, best.last, len(v))])
    return replace(best, errors=np.hypot(best.errors, error * apart)), slope, error


def _usual_slope(t: Floats, v: Floats, over: float) -> float:
    """The slope [1/s] that the record most often has over a time [s]: the half-sample mode."""
    lag = min(max(1, int(over * (len(t) - 1) / np.ptp(t))), len(t) - 1)
    slope = np.sort((v[lag:] - v[:-lag]) / (t[lag:] - t[:-lag]))
    while len(slope) > 3:
        half = (len(slope) + 1) // 2
        first = int(np.argmin(slope[half - 1 :] - slope[: len(slope) - half + 1]))
        slope = slope[first : first + half]
    return float(np.median(slope))


def drift(t: Floats, v: Floats, steps: Stairs) -> tuple[float, float]:
    """Slope of the record between its steps, with its standard error; 0, 0 if it is not the same in all pauses."""
    slopes, errors = [], []
    for f in _flats(steps.first, steps.last, len(v)):
        if f.stop - f.start >= FALLS:
            x, y = t[f] - t[f].mean(), v[f] - v[f].mean()
            slope = float(x @ y / (x @ x))
            rest = y - slope * x
            crossings = max(1, int(np.count_nonzero(np.diff(rest > 0.0))))
            slopes.append(slope)
            errors.append(float(np.sqrt(max(rest @ rest, len(x) * steps.noise**2) / (crossings * (x @ x)))))
    if not slopes:
        return 0.0, 0.0
    weight = 1.0 / np.array(errors) ** 2
    mean, error = float(weight @ slopes / weight.sum()), float(weight.sum() ** -0.5)
    same = np.abs(np.array(slopes) - mean) <= SURE * np.array(errors)
    return (mean, error) if same.all() else (0.0, 0.0)


def _level(v: Floats, noise: float, count: float) -> tuple[float, float]:
    """Mean of a stretch that stands, and its standard error: each time the record crosses the mean is one sample.

    count: unit in which the record is counted; its rounding stays in the mean of any number of samples.
    """
    mean = float(v.mean())
    crossings = int(np.count_nonzero(np.diff(v > mean)))
    return mean, float(np.hypot(max(float(v.std()), noise) / np.sqrt(max(1, crossings)), count / 12**0.5))


def _exact(v: Floats, first: Indices, last: Indices) -> Stairs:
    """The steps of a record without noise, from sample to sample; water that flows back counts against its step."""
    first, last = first.copy(), last.copy()
    for i in range(len(first)):
        while first[i] > 0 and v[first[i] - 1] < v[first[i]]:
            first[i] -= 1
        while last[i] + 1 < len(v) and v[last[i] + 1] > v[last[i]]:
            last[i] += 1
    ends = np.append(v[first], v[-1])
    none = np.zeros(len(first))
    return Stairs(first, last, np.diff(ends), none, 0.0, float(v[-1] - v[0]), 0.0)


@dataclass(frozen=True)
class Fall:
    """A fall of the record from `level`, from sample `start` to sample `end`, by `height` with its standard error."""

    start: int
    end: int
    level: float
    height: float
    error: float


def emptyings(t: Floats, v: Floats, pause: float) -> list[Fall]:
    """Falls by which a tank was emptied: more than noise, faster than it fills, no swing, no water that goes back.

    A swing falls as much as it just rose, and rises again at once. Water goes back at once as well, and not more of it
    than had just come.
    """
    size = BAND * noise_of_falls(v)
    rate = float(np.ptp(v)) if size > 0.0 else float(np.clip(np.diff(v), 0.0, None).sum())
    found, since = [], 0
    for fall in _falls(v, size):
        took = t[fall.end] - t[fall.start]
        fast = fall.height * np.ptp(t) > 3.0 * rate * took
        part = slice(since, fall.start + 1)
        if fall.height <= max(size, SURE * fall.error) or not fast or _swings(t, v, fall):
            continue
        if size > 0.0 or not _goes_back(t[part], v[part], fall, pause):
            found.append(fall)
            since = fall.end
    return found


def _swings(t: Floats, v: Floats, fall: Fall) -> bool:
    """True if the record rose by half of a fall just before it, and again just after it, as fast."""
    took = SWING * (t[fall.end] - t[fall.start])
    before, after = np.searchsorted(t, [t[fall.start] - took, t[fall.end] + took])
    half = 0.5 * (v[fall.start] + v[fall.end])
    return bool(v[before : fall.start + 1].min() < half < v[fall.end : after].max(initial=-np.inf))


def _goes_back(t: Floats, v: Floats, fall: Fall, pause: float) -> bool:
    """True if a fall at the end of a record without noise can be the water of its last step."""
    before = stairs(t, v, pause)
    if len(before.heights) == 0:
        return True
    held, took = t[-1] - t[before.last[-1]], t[before.last[-1]] - t[before.first[-1]]
    return bool(fall.height <= before.heights[-1] and held <= 3.0 * took)


def noise_of_falls(v: Floats) -> float:
    """Median of the falls from one peak to the next hollow, if there are enough of them; else 0."""
    d = np.diff(v)
    turn = np.flatnonzero(np.diff(np.sign(d[d != 0.0])) != 0)
    at = np.append(np.append(0, np.flatnonzero(d != 0.0)[turn + 1]), len(v) - 1) if len(turn) else np.array([0])
    falls = -np.diff(v[at])
    falls = falls[falls > 0.0]
    return float(np.median(falls)) if len(falls) >= FALLS else 0.0


def _falls(v: Floats, size: float) -> list[Fall]:
    """Falls by more than `size`, from a peak to the hollow before the record rises by more than that again."""
    found: list[Fall] = []
    peak, hollow = 0, -1  # -1: it has not fallen since the peak
    for i, value in enumerate(v.tolist()):
        if hollow < 0 and value >= v[peak]:
            peak = i
        elif hollow < 0:
            hollow = i if v[peak] - value > size else -1
        elif value <= v[hollow]:
            hollow = i
        elif value - v[hollow] > size:
            found.append(_fall(v, peak, hollow, size))
            peak, hollow = i, -1
    return [*found, _fall(v, peak, hollow, size)] if hollow >= 0 else found


def _fall(v: Floats, peak: int, hollow: int, size: float) -> Fall:
    """The fall between a peak and a hollow: indices where it begins and ends, upper level, height and its error [m]."""
    near = min(size, (v[peak] - v[hollow]) / 3.0)
    middle = peak + int(np.flatnonzero(v[peak : hollow + 1] >= 0.5 * (v[peak] + v[hollow]))[-1])
    start = peak + int(np.flatnonzero(v[peak : middle + 1] >= v[peak] - near)[-1])
    end = middle + 1 + int(np.flatnonzero(v[middle + 1 : hollow + 1] <= v[hollow] + near)[0])
    above, below = v[max(start - EDGE, 0) : start + 1], v[end : end + EDGE + 1]
    before, after = above[np.abs(above - v[peak]) <= near], below[np.abs(below - v[hollow]) <= near]
    high, low = float(np.median(before)), float(np.median(after))
    start -= int(np.argmax(above[::-1] >= high))
    end += int(np.argmax(below <= low))
    error = float(np.hypot(_level(before, 0.0, 0.0)[1], _level(after, 0.0, 0.0)[1]))
    return Fall(start, end, high, high - low, error)

"""Events, volumes and intervals from made-up records of which the right answer is known."""

from __future__ import annotations

from math import gamma, log, pi

import numpy as np
import pytest

from houle.analysis import (
    AnalysisError,
    interval,
    load_events,
    mean_interval,
    per_wave,
    wave_volumes,
    weibull_fit,
)
from houle.analysis.events import _block_variance, resampled

STEP = 0.005  # s
TIME = np.arange(0.0, 200.0, STEP)
LASTS, EVERY = 0.8, 9.7  # s: half-sine impacts, one every so often
STARTS = 5.0 + EVERY * np.arange(20)


def impacts(heights: np.ndarray) -> np.ndarray:
    """Half-sine impacts of these heights, rest 0 between them."""
    record = np.zeros_like(TIME)
    for start, height in zip(STARTS, heights, strict=True):
        inside = (start < TIME) & (start + LASTS > TIME)
        record[inside] = height * np.sin(pi * (TIME[inside] - start) / LASTS)
    return record


@pytest.mark.parametrize("drift", [0.0, 0.02, -0.05])
def test_impacts_on_a_drifting_level(drift):
    """The impulse of a half sine is 2 A D/pi and its rise from a tenth (pi/2 - asin 0.1) D/pi: no pool is in them."""
    heights = np.linspace(5.0, 15.0, len(STARTS))
    found = load_events(TIME, 3.0 + drift * TIME + impacts(heights), window=40.0, waves=100)
    assert len(found) == len(STARTS)
    # an impact more or less in a window that fades, so of twice its share at most, moves the median by the drift of its
    # time, in each of the two passes
    level = 2 * abs(drift) * LASTS
    curve = heights * (pi * STEP / LASTS) ** 2 / 8  # what a sine falls within half a sample of its top
    assert np.all(np.abs(found.peaks - heights) <= curve + level)
    exact = 2.0 * heights * LASTS / pi
    assert np.all(np.abs(found.impulses - exact) <= exact * (pi * STEP / LASTS) ** 2 + level * EVERY)
    assert found.rise == pytest.approx((pi / 2 - np.arcsin(0.1)) * LASTS / pi, abs=2 * STEP + level)
    assert np.all(np.abs(found.times - STARTS - LASTS / 2) <= STEP)


def test_a_pool_that_rises_by_steps_is_in_no_impulse():
    """Each impact leaves water behind a crest: the record stands higher after it, the impulse is that of the impact."""
    steps = 0.1 * np.searchsorted(STARTS + LASTS, TIME)
    found = load_events(TIME, steps + impacts(np.full(len(STARTS), 10.0)), window=40.0)
    assert len(found) == len(STARTS)
    exact = 2 * 10.0 * LASTS / pi
    with_the_pool = exact + steps.max() / 2 * LASTS
    middle = found.impulses[3:-3]
    assert np.all(np.abs(middle - exact) < 0.25 * (with_the_pool - exact))


def test_an_impact_and_the_slow_load_behind_it_are_one_event():
    slow = 4.0 * np.sin(pi * np.clip(TIME - 50.0, 0.0, 2.0) / 2.0)
    spike = 10.0 * np.clip(1.0 - np.abs(TIME - 50.3) / 0.1, 0.0, None)
    found = load_events(TIME, slow + spike, window=40.0, threshold=1.0)
    assert len(found) == 1
    assert found.times[0] == pytest.approx(50.3, abs=0.05)
    assert found.impulses[0] == pytest.approx(4.0 * 2.0 * 2.0 / pi + 1.0, rel=1e-3)


def test_waves_that_swing_about_a_level_are_counted_one_by_one():
    found = load_events(TIME, 7.0 + np.sin(2 * pi * TIME / 4.0 - 1.0), window=40.0)
    assert len(found) == 50
    level = 2 * pi * STEP / 4.0  # a median is a sample: the record rises by so much from one to the next
    assert found.peaks[1:-1] == pytest.approx(1.0, abs=level)  # at both ends the record cuts a crest
    assert found.impulses[1:-1] == pytest.approx(4.0 / pi, abs=2.0 * level)


def test_the_highest_part_needs_a_wave():
    found = load_events(TIME, impacts(np.arange(1.0, 21.0)), window=40.0, waves=500)
    assert found.highest(1 / 250) == pytest.approx(np.mean([20.0, 19.0]), rel=1e-3)
    few = load_events(TIME, impacts(np.arange(1.0, 21.0)), window=40.0, waves=249)
    assert np.isnan(few.highest(1 / 250))
    peaks, share = found.exceedance()
    assert np.all(np.diff(peaks) <= 0) and share[0] == pytest.approx(1 / 501)


def test_a_record_at_rest_has_no_event():
    assert len(load_events(TIME, np.full_like(TIME, 12.0), window=40.0)) == 0


@pytest.mark.parametrize("record", [TIME[:-1], np.where(TIME > 3, np.nan, 0.0)])
def test_a_record_with_gaps_is_refused(record):
    with pytest.raises(AnalysisError):
        load_events(TIME, record, window=40.0)


def overtopped(starts: list[float], volumes: list[float], drip: float = 0.0) -> np.ndarray:
    """Volume so far of waves that last 0.5 s each, and of water that drips all the time."""
    record = drip * TIME
    for start, volume in zip(starts, volumes, strict=True):
        record = record + volume * (1 - np.cos(pi * np.clip((TIME - start) / 0.5, 0.0, 1.0))) / 2
    return record


def test_volumes_of_waves_that_drip_into_one_another():
    """`overtopping_events` takes them for one event, as the record never stands still."""
    starts, sizes, drip, least = [5.0, 6.6, 20.0, 40.0], [0.01, 0.03, 0.0008, 0.02], 1e-5, 4e-4
    found = wave_volumes(TIME, overtopped(starts, sizes, drip), period=1.5, least=least)
    until = np.diff([*starts, TIME[-1]])
    assert found.volumes == pytest.approx(np.array(sizes) + drip * until, abs=0.5 * least)
    assert found.times == pytest.approx(np.array(starts) + 0.25, abs=0.02)
    assert found.volumes.sum() == pytest.approx(found.total - drip * starts[0], abs=0.5 * least)


def test_water_that_flows_back_is_taken_off_its_wave():
    record = overtopped([5.0, 20.0], [0.02, 0.01]) - overtopped([7.0], [0.004])
    found = wave_volumes(TIME, record, period=1.5, least=4e-4)
    assert found.volumes == pytest.approx([0.016, 0.01], abs=2e-4)


def test_no_water_is_no_wave():
    found = wave_volumes(TIME, np.zeros_like(TIME), period=1.5, least=4e-4)
    assert len(found.volumes) == 0 and found.q == 0.0


def covers(inside: int, trials: int, share: float) -> bool:
    """True if a share of `share` gives so many of the trials with a chance above 1 in 1000 (normal approximation)."""
    return abs(inside - share * trials) <= 3.3 * np.sqrt(trials * share * (1 - share))


@pytest.mark.parametrize(("count", "shape", "least"), [(12, 0.75, 0.0), (40, 1.3, 0.0), (40, 0.75, 0.1)])
def test_the_interval_of_a_weibull_sample_holds_the_truth_nine_times_in_ten(count, shape, least):
    random, trials = np.random.default_rng(1), 200
    scale, inside = 3.0, np.zeros(2)
    for i in range(trials):
        values = scale * (least**shape - np.log1p(-random.random(count))) ** (1 / shape)
        found = weibull_fit(values, least=scale * least, seed=i)
        inside += [
            low < truth < high for truth, (low, high) in ((shape, found.shape_interval), (scale, found.scale_interval))
        ]
    assert all(covers(int(n), trials, 0.9) for n in inside), inside / trials


def test_the_fit_of_many_values_is_the_distribution():
    random = np.random.default_rng(7)
    found = weibull_fit(2.0 * random.weibull(0.8, 20000))
    assert (found.scale, found.shape) == pytest.approx((2.0, 0.8), rel=0.03)
    assert found.expected_largest(20) == pytest.approx(found.scale * log(20) ** (1 / found.shape))


@pytest.mark.parametrize("values", [[1.0, 2.0], [1.0] * 8, [1.0, 2.0, 3.0, 4.0, -1.0]])
def test_values_without_a_shape_are_refused(values):
    with pytest.raises(AnalysisError):
        weibull_fit(values)


@pytest.mark.parametrize(("waves", "share", "shape"), [(80, 0.1, 0.75), (300, 0.1, 1.2), (80, 0.4, 0.75)])
def test_the_interval_of_a_mean_discharge_holds_the_truth(waves, share, shape):
    """Nearly nine times in ten, however few waves overtop; percentiles of the same bootstrap do worse."""
    random, trials = np.random.default_rng(2), 1000
    truth = share * gamma(1 + 1 / shape)
    inside = rows = 0
    for _ in range(trials):
        volumes = np.where(random.random(waves) < share, random.weibull(shape, waves), 0.0)
        low, high = mean_interval(volumes)
        inside, rows = inside + (low < truth < high), rows + bool(np.isfinite(low))
    assert rows > 0.9 * trials
    assert inside / rows > 0.9 - 3.3 * np.sqrt(0.09 / rows), inside / rows


def test_waves_in_groups_widen_the_interval():
    """Blocks keep neighbours together: a record in which eight waves are alike is known less well."""
    random = np.random.default_rng(3)
    single = np.where(random.random(400) < 0.2, random.weibull(1.0, 400), 0.0)
    grouped = np.repeat(single[:50], 8)
    alone = mean_interval(random.permutation(grouped))
    low, high = mean_interval(grouped)
    assert high / low > 1.3 * alone[1] / alone[0]


def test_the_closed_form_is_the_bootstrap():
    """The variance of the mean over resamples is that which the closed form gives, to the noise of 2000 of them."""
    values = np.random.default_rng(4).weibull(0.8, 60)
    means = resampled(values, lambda rows: rows.mean(axis=1), 0)
    assert _block_variance(values) == pytest.approx(means.var(), rel=3.3 * np.sqrt(2 / len(means)))


def test_two_waves_give_no_interval():
    assert np.isnan(mean_interval(np.array([0.0, 1.0, 0.0, 2.0, 0.0]))).all()
    assert np.isnan(interval(np.array([1.0]), lambda rows: rows.mean(axis=1))).all()


def test_events_are_summed_into_waves():
    found = per_wave([0.5, 2.4, 2.6, 9.9], [1.0, 2.0, 4.0, 8.0], 0.0, 10.0, 10)
    assert found.tolist() == [1.0, 0.0, 6.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 8.0]

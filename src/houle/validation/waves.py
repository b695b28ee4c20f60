"""Common parts of the comparisons of flumes with waves: the window, the quality card, the second harmonic."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from houle import analysis
from houle.grid import FloatArray
from houle.results.reflection import first_harmonic, wave_of
from houle.validation.flume import PERIODS

if TYPE_CHECKING:
    from houle.results.run import Run


def window(run: Run) -> tuple[float, float]:
    """The window of the measurement, the last PERIODS periods of a run: start and end [s]."""
    end, period = float(run.series.time[-1]), wave_of(run.case).period
    return end - PERIODS * period - 0.01 * period, end


def card(run: Run, gauges: Sequence[str] | None = None, towards: float = 1.0) -> analysis.QualityCard:
    """Quality of the waves towards +1 or -1 at these gauges, all if left out, beside their theory."""
    wave, case = wave_of(run.case), run.case
    assert case.waves is not None
    return analysis.quality_card(
        run,
        depth=case.waves.depth,
        period=wave.period,
        height=first_harmonic(wave),
        window=window(run),
        still_water=case.waves.depth,
        reference=wave.k,
        gauges=gauges,
        towards=towards,
    )


def second_harmonic(run: Run, back: bool) -> FloatArray:
    """Amplitudes [m] of the second harmonic: bound to the first, free to the right and, if asked for, to the left.

    Free waves to the left look like bound ones where gauges stand evenly, five to a wavelength.
    """
    wave = wave_of(run.case)
    late = run.series.sel(time=slice(*window(run)))
    eta, x = late.eta.transpose("gauge", "time").values, late.gauge_x.values
    second = analysis.harmonics(late.time.values, eta, wave.omega, 3)[:, 2]
    free = float(analysis.wave_number(2 * wave.omega, wave.depth))
    modes = np.exp(1j * np.outer(x, [2 * wave.k, free, -free][: 3 if back else 2]))
    return np.abs(np.linalg.lstsq(modes, second, rcond=None)[0])

"""Quality of the waves themselves, measured at the gauges of an empty flume: it stands beside every C_R.

The amplitude at x of a wave that decays by itself and of what the far end sends back is

    F(x) = Z_I exp(i kappa x) + Z_R exp(-i kappa x),     kappa = k + i alpha

(both decay the way they go). kappa is the one that explains the gauges best (least squares, Z_I and Z_R follow), so
decay, celerity and reflection do not disturb each other. Without reflection this is the straight line of log |F|
against x / L.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle.analysis.energies import per_period
from houle.analysis.errors import AnalysisError, positive
from houle.analysis.levels import Gauges
from houle.analysis.phase import followed
from houle.analysis.records import as_gauges
from houle.analysis.waves import harmonics
from houle.waves.dispersion import GRAVITY, wave_number

DATUM = 0.5  # wave heights (or tenths of the depth): a mean level farther off has another zero


@dataclass(frozen=True)
class QualityCard:
    """Waves of an empty flume over `wavelengths` of gauges and `periods` periods.

    height       of the incident wave at the gauge nearest the maker [m]     target  height asked for [m]
    decay        part of the height lost per wavelength
    celerity     over the reference celerity, less 1                        phase   error per wavelength [rad]
    reflection   of the far end, C_R
    drift        of the mean level over the window [m]                      level  mean level [m]
    steadiness   standard deviation of the height between periods, over the height
    set_down     mean level less still water [m]; NaN when it is not known where that is
    residual     part of the amplitude that the two waves do not explain
    """

    height: float
    target: float
    decay: float
    celerity: float
    phase: float
    reflection: float
    drift: float
    set_down: float
    residual: float
    wavelengths: float
    periods: int
    steadiness: float
    level: float = float("nan")
    notes: tuple[str, ...] = ()

    def __str__(self) -> str:
        return "\n".join([
            f"wave quality (empty flume, {self.wavelengths:.1f} wavelengths of gauges, {self.periods} periods)",
            f"  height            {1e3 * self.height:.3g} mm, {100 * (self.height / self.target - 1):+.2f} % of the "
            "target",
            f"  decay             {100 * self.decay:.2f} % per wavelength",
            f"  celerity          {100 * self.celerity:+.2f} %, phase {np.degrees(self.phase):+.2f} degrees per "
            "wavelength",
            f"  spurious C_R      {self.reflection:.4f}",
            f"  mean level        drift {1e3 * self.drift:+.3f} mm, {self._level()}",
            f"  steadiness        {100 * self.steadiness:.2f} % between periods (standard deviation of the height)",
            f"  not explained     {100 * self.residual:.2f} % of the amplitude",
            *(f"  note: {note}" for note in self.notes),
        ])  # fmt: skip

    def _level(self) -> str:
        if np.isfinite(self.set_down):
            return f"{1e3 * self.set_down:+.3f} mm from still water"
        return f"{self.level:.4g} m: neither 0 nor the depth, give still_water="


def quality_card(
    source: Any,
    *,
    depth: float,
    period: float,
    height: float,
    window: tuple[float, float],
    still_water: float | None = None,
    reference: float | None = None,
    gauges: Sequence[str | int] | None = None,
    towards: float = 1.0,
    gravity: float = GRAVITY,
) -> QualityCard:
    """The card of an empty flume: five gauges or more over a wavelength or more, less than half a wavelength apart.

    source, gauges, window, towards as in reflection(); height the target [m]; still_water its level on the scale of eta
    [m], if None the depth or 0, the nearer to the mean level, unless that is far from both; reference the wave number
    [rad/m] that the wave should have (Fenton's, for its height), linear theory if None. Raises AnalysisError.
    """
    positive(depth=depth, period=period, gravity=gravity)
    omega = 2 * np.pi / period
    g = as_gauges(source, gauges, window)
    g = Gauges(g.time, towards * g.x, g.eta, g.names)
    k0 = float(wave_number(omega, depth, gravity)) if reference is None else reference
    _enough(g.x, k0)
    periods = int(np.floor((g.time[-1] + g.step - g.time[0]) / period + 1e-6))
    if periods < 2:
        raise AnalysisError(
            f"the window {window[0]:g} to {window[1]:g} s holds {periods} periods: 2 are needed, 5 are good"
        )
    start = float(g.time[0])
    omega, notes = followed(lambda w, n: per_period(g, w, start, n)[:, :, 1], omega, start, start + periods * period, g)
    if notes and omega != 2 * np.pi / period:
        period = 2 * np.pi / omega
        periods = int(np.floor((g.time[-1] + g.step - start) / period + 1e-6))
        k0 = float(wave_number(omega, depth, gravity)) if reference is None else reference
    F = per_period(g, omega, start, periods)
    first = F[:, :, 1].mean(axis=0)
    kappa, Z, rest = decaying_waves(g.x, first, k0)
    near = g.x.min()
    incident, reflected = abs(Z[0] * np.exp(1j * kappa * near)), abs(Z[1] * np.exp(-1j * kappa * g.x.max()))
    length = 2 * np.pi / kappa.real
    level = _levels(g, period, periods)
    rest_level = _still_water(float(level.mean()), depth, height) if still_water is None else still_water
    slope = np.polyfit(np.arange(periods), level, 1)[0]
    sizes = np.abs(F[:, :, 1]).mean(axis=1)
    return QualityCard(
        height=2 * incident,
        target=height,
        decay=float(1.0 - np.exp(-kappa.imag * length)),
        celerity=float(k0 / kappa.real - 1.0),
        phase=float(2 * np.pi * (kappa.real / k0 - 1.0)),
        reflection=float(reflected / abs(Z[0] * np.exp(1j * kappa * g.x.max()))),
        drift=float(slope * (periods - 1)),
        set_down=float(level.mean()) - rest_level,
        residual=rest,
        wavelengths=float(np.ptp(g.x) / length),
        periods=periods,
        steadiness=float(sizes.std(ddof=1) / sizes.mean()),
        level=float(level.mean()),
        notes=tuple(notes),
    )


def _levels(g: Gauges, period: float, periods: int) -> NDArray[Any]:
    """Mean level of all gauges in each period [m]."""
    omega, start, mean = 2 * np.pi / period, float(g.time[0]), g.eta.mean(axis=0)
    parts = [(g.time >= start + j * period) & (g.time < start + (j + 1) * period) for j in range(periods)]
    return np.array([harmonics(g.time[p], mean[p], omega)[0].real for p in parts])


def decaying_waves(x: NDArray[Any], F: NDArray[Any], k: float) -> tuple[complex, NDArray[Any], float]:
    """kappa [rad/m], (Z_I, Z_R) referred to x = 0 and the unexplained part of |F|, starting at the wave number k.

    Variable projection: for a trial kappa the two amplitudes are linear. Decay is bounded by |alpha| < k / 10 (half the
    height in a wavelength), k by 15 %. Raises AnalysisError where no wave within these bounds explains the gauges.
    """
    from scipy.optimize import least_squares

    middle, size = x.mean(), np.linalg.norm(F)
    if size == 0.0:
        raise AnalysisError("the gauges hold no wave of this period: they are at rest")

    def waves(kappa: complex) -> NDArray[Any]:
        return np.exp(1j * kappa * np.outer(x - middle, [1.0, -1.0]))

    def rest(p: NDArray[Any]) -> NDArray[Any]:
        w = waves(k * complex(*p))
        r = (F - w @ np.linalg.lstsq(w, F, rcond=None)[0]) / size
        return np.concatenate([r.real, r.imag])

    trials = [(float(np.linalg.norm(rest(np.array([s, 0.0])))), s) for s in np.linspace(0.86, 1.14, 57)]
    start = [min(trials)[1], 0.0]
    box = ([0.85, -0.1], [1.15, 0.1])
    fit = least_squares(rest, start, bounds=box, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    if np.any(fit.active_mask):
        raise AnalysisError("no wave near this wave number explains the gauges: check period, depth and the places")
    kappa = k * complex(*fit.x)
    z = np.linalg.lstsq(waves(kappa), F, rcond=None)[0]
    z = z * np.exp(np.array([-1j, 1j]) * kappa * middle)
    return kappa, z, float(np.linalg.norm(fit.fun))


def _enough(x: NDArray[Any], k: float) -> None:
    length = 2 * np.pi / k
    places = np.sort(x)
    if len(x) < 5 or np.ptp(x) < 0.9 * length or np.diff(places).min() > 0.45 * length:
        raise AnalysisError(
            f"{len(x)} gauges over {np.ptp(x):.3g} m: 5 or more over a wavelength of {length:.3g} m or more are "
            "needed, some of them less than 0.45 wavelengths apart"
        )


def _still_water(mean: float, depth: float, height: float) -> float:
    """0 or the depth, whichever the mean level is near to; NaN if it is so far from both that no wave explains it."""
    datum = depth if abs(mean - depth) < abs(mean) else 0.0
    return datum if abs(mean - datum) <= DATUM * max(height, 0.1 * depth) else float("nan")

"""Reflection, transmission and dissipation of a structure from gauges, with intervals: one question, one answer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from houle.analysis.errors import AnalysisError, positive
from houle.analysis.estimate import Task, irregular, paper, regular
from houle.analysis.levels import Gauges
from houle.analysis.records import as_gauges, places
from houle.analysis.result import Reflection
from houle.analysis.waves import find_omega, spectrum
from houle.analysis.window import Window, choose_window
from houle.waves.dispersion import GRAVITY

HIGHEST = 3.0  # range of the level at a gauge [depths]: more is another unit, or a code for missing values


def reflection(
    source: Any,
    *,
    depth: float,
    period: float | None = None,
    kind: Literal["regular", "irregular"] = "regular",
    method: str = "zelt-skjelbreia",
    gauges: Sequence[str | int] | None = None,
    behind: Sequence[str | int] = (),
    window: tuple[float, float] | None = None,
    maker: float | None = None,
    structure: float | None = None,
    towards: float = 1.0,
    wave_number: float | Literal["fit"] | None = None,
    bed: float = 0.0,
    confidence: float = 0.95,
    seed: int = 0,
    gravity: float = GRAVITY,
    **limits: Any,
) -> Reflection:
    """Reflection, transmission and dissipation from gauges in front of a structure (and behind it), with intervals.

    source       a houle Run, a Dataset like series.nc or surface.nc, (time, x, eta), or a path: folder of a run,
                 netCDF file, CSV
    depth        of still water at the gauges [m]        period    T, or T_p [s]; found in the record if None
    kind         "regular": first harmonic over whole periods; "irregular": Fourier lines of 0.5 to 2 f_p
    method       "zelt-skjelbreia" (2 gauges or more), "mansard-funke" (3), "goda-suzuki" (2), "jh2020" (the paper's
                 formula, which does not measure reflection: see houle.analysis.paper)
    gauges       names or numbers of those in front; by default all that are not behind, or before the structure's face
    behind       names or numbers of those behind: one measures the height there, two or more take off what the far end
    reflects
    window       (start, end) [s]; if None chosen from maker, structure [m] and `limits`: ramp, settle, rear, reflector,
                 absorbing, far_end, minimum of window.choose_window. Cut to whole periods (regular)
    towards      +1 if the incident wave goes to +x, -1 if to -x; known when maker and structure are given
    wave_number  [rad/m] of the primary wave (regular); linear theory if None; "fit": the one that explains four gauges
    best
    bed          level of the bed [m] on the scale of eta, for jh2020
    confidence   of the intervals                    seed     of the resampling behind them
    Raises AnalysisError with the cure: singular spacings, no window, dry gauges, ...
    """
    if kind not in ("regular", "irregular"):
        raise AnalysisError(f'kind = {kind!r}: "regular" or "irregular"')
    if not 0.0 < confidence < 1.0:
        raise AnalysisError(f"confidence = {confidence:g}: give a share between 0 and 1, 0.95 for an interval of 95 %")
    positive(depth=depth, gravity=gravity)
    if maker is not None and structure is not None:
        towards = float(np.sign(structure - maker))
    front = _in_front(source, gauges, behind, structure, towards, window)
    back = as_gauges(source, list(behind), window) if len(behind) else None
    for records in filter(None, (front, back)):
        _require_levels(records, depth)
    if period is not None:
        positive(period=period)
    omega = 2 * np.pi / period if period is not None else _omega(front, kind)
    stand = [*front.x, *([] if back is None else back.x)]
    if window is None:
        span = _chosen(front, stand, omega, depth, maker, structure, kind, gravity, limits)
    else:
        span = _given(front, omega, window, limits)
    front = replace(front, x=front.x * towards)
    back = None if back is None else replace(back, x=back.x * towards)
    task = Task(kind, method, front, back, span, omega, depth, gravity, towards, confidence, seed)
    if method == "jh2020":
        return paper(task, bed)
    return regular(task, wave_number) if kind == "regular" else irregular(task)


def _in_front(
    source: Any,
    chosen: Sequence[str | int] | None,
    behind: Sequence[str | int],
    structure: float | None,
    towards: float,
    window: tuple[float, float] | None,
) -> Gauges:
    if chosen is None:
        every = places(source)  # a gauge that is not used may be dry
        away = {every.names.index(b) if isinstance(b, str) and b in every.names else b for b in behind}
        before = [structure is None or towards * (structure - x) > 0 for x in every.x]
        chosen = [g for g in range(len(every.x)) if g not in away and before[g]]
    if len(chosen) == 0:
        raise AnalysisError("there is no gauge in front of the structure")
    return as_gauges(source, chosen, window)


def _require_levels(g: Gauges, depth: float) -> None:
    """Raises AnalysisError where a level moves by more than HIGHEST depths: it cannot be in metres."""
    for name, row in zip(g.names, g.eta, strict=True):
        low, high = int(np.argmin(row)), int(np.argmax(row))
        if row[high] - row[low] > HIGHEST * depth:
            raise AnalysisError(
                f"gauge {name} goes from {row[low]:.4g} m (t = {g.time[low]:.5g} s) to {row[high]:.4g} m (t = "
                f"{g.time[high]:.5g} s) in {depth:g} m of water: check its unit, and codes for missing values"
            )


def _omega(front: Gauges, kind: str) -> float:
    if kind == "regular":
        half = front.time[0] + 0.5 * (front.time[-1] - front.time[0])  # the first half may hold the ramp
        late = front.between(half, np.inf)
        return find_omega(late.time, late.eta)
    peaks = [spectrum(front.time, row).T_p for row in front.eta]
    return 2 * np.pi / float(np.median(peaks))


def _chosen(
    front: Gauges,
    places: list[float],
    omega: float,
    depth: float,
    maker: float | None,
    structure: float | None,
    kind: str,
    gravity: float,
    limits: dict[str, Any],
) -> Window:
    if maker is None or structure is None:
        raise AnalysisError("give window=(start, end), or maker= and structure= (places in m) to have it chosen")
    given = {"maker": maker, "structure": structure, "gauges": places, "until": float(front.time[-1] + front.step)}
    return choose_window(
        omega, depth, **{"minimum": 3 if kind == "regular" else 20, **limits, **given, "gravity": gravity}
    )


def _given(front: Gauges, omega: float, window: tuple[float, float], limits: dict[str, Any]) -> Window:
    if limits:
        raise AnalysisError(f"{', '.join(limits)}: not used, the window is given")
    period = 2 * np.pi / omega
    start, end = max(window[0], float(front.time[0])), min(window[1], float(front.time[-1] + front.step))
    periods = int(np.floor((end - start) / period + 1e-6))
    if periods < 2:
        raise AnalysisError(
            f"the window {start:g} to {end:g} s holds {periods} periods of {period:.4g} s: 2 are needed"
        )
    return Window(start, start + periods * period, periods, "as given, cut to whole periods")

"""One question, one answer: how much does the structure reflect, transmit and swallow, and how sure is that?"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from houle.analysis import energies
from houle.analysis.energies import Lines, Pieces
from houle.analysis.errors import AnalysisError
from houle.analysis.linear import GRAVITY
from houle.analysis.linear import wave_number as linear_number
from houle.analysis.paper import jh2020
from houle.analysis.records import Gauges, as_gauges, places
from houle.analysis.separation import Components, fit_wave_number, separate_xt, spread
from houle.analysis.uncertainty import bootstrap, half_width, subsets
from houle.analysis.waves import find_omega, spectrum
from houle.analysis.window import Window, choose_window

Interval = tuple[float, float]
NONE = (float("nan"), float("nan"))
RESIDUAL = 0.1  # of the amplitude, above which a note is due


@dataclass(frozen=True)
class Reflection:
    """C_R = H_R / H_I, C_T = H_T / H_I, C_D = 1 - C_R^2 - C_T^2; NaN where gauges are missing.

    Heights [m] are 2 |Z| of the first harmonic (regular) or H_m0 in the band (irregular). Intervals are (low, high) of
    the stated confidence; `covers` says what is in them. `residual`: part of the amplitude at the gauges that an
    incident and a reflected wave do not explain. `spread`: see separation.spread.
    """

    kind: str
    method: str
    period: float
    depth: float
    wave_number: float
    C_R: float
    C_T: float
    C_D: float
    interval_R: Interval
    interval_T: Interval
    interval_D: Interval
    H_I: float
    H_R: float
    H_T: float
    window: Window
    residual: float
    spread: float
    confidence: float
    covers: str
    notes: tuple[str, ...]
    towards: float
    record: Gauges = field(repr=False)
    harmonics: tuple[Components, ...] = field(repr=False, default=())
    amplitudes: NDArray[Any] | None = field(repr=False, default=None)
    lines: Lines | None = field(repr=False, default=None)

    def __str__(self) -> str:
        wave = "T" if self.kind == "regular" else "T_p"
        height = "H" if self.kind == "regular" else "H_m0"
        parts = [
            ("C_R", self.C_R, self.interval_R),
            ("C_T", self.C_T, self.interval_T),
            ("C_D", self.C_D, self.interval_D),
        ]
        number = len(self.record.x)
        rows = [f"reflection: {self.kind} waves, {wave} = {self.period:.4g} s, {self.method}, {number} gauges in front"]
        rows += [f"  {name}  {_pm(value, span)}" for name, value, span in parts if np.isfinite(value)]
        heights = f"incident {self.H_I:.4g} m, reflected {self.H_R:.4g} m"
        rows.append(f"  {height}   {heights}" + (f", transmitted {self.H_T:.4g} m" if np.isfinite(self.H_T) else ""))
        rows.append(f"  window {self.window}")
        rows.append(f"  interval ({100 * self.confidence:g} %): {self.covers}")
        if np.isfinite(self.residual):
            rows.append(f"  two waves leave {100 * self.residual:.2g} % of the amplitude at the gauges unexplained")
        return "\n".join([*rows, *(f"  note: {note}" for note in self.notes)])

    def plot(self, path: str | os.PathLike[str]) -> Path:
        """A picture (PNG): signals and window, the separated waves along the flume, harmonics or spectrum."""
        from houle.analysis.picture import draw

        return draw(self, Path(path))


def _pm(value: float, span: Interval) -> str:
    return f"{value:.3f}" + (f"   ({span[0]:.3f} to {span[1]:.3f})" if np.isfinite(span[0]) else "   (no interval)")


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
    gauges       names or numbers of those in front; if None all that are not behind, or before the structure's face
    behind       those behind: one measures the height there, two or more take off what the far end reflects
    window       (start, end) [s]; if None chosen from maker, structure [m] and `limits`: ramp, settle, rear, reflector,
                 absorbing, far_end, minimum of window.choose_window. Cut to whole periods (regular)
    towards      +1 if the incident wave goes to +x, -1 if to -x; known when maker and structure are given
    wave_number  [rad/m] of the primary wave; linear theory if None; "fit": the one that explains four gauges best
    (regular) bed          level of the bed [m] on the scale of eta, for jh2020
    Raises AnalysisError with the cure: singular spacings, no window, dry gauges, ...
    """
    if kind not in ("regular", "irregular"):
        raise AnalysisError(f'kind = {kind!r}: "regular" or "irregular"')
    if maker is not None and structure is not None:
        towards = float(np.sign(structure - maker))
    front = _in_front(source, gauges, behind, structure, towards, window)
    back = as_gauges(source, list(behind), window) if len(behind) else None
    omega = 2 * np.pi / period if period else _omega(front, kind)
    stand = [*front.x, *([] if back is None else back.x)]
    if window is None:
        frame = _chosen(front, stand, omega, depth, maker, structure, kind, gravity, limits)
    else:
        frame = _given(front, omega, window, limits)
    front = replace(front, x=front.x * towards)
    back = None if back is None else replace(back, x=back.x * towards)
    task = Task(kind, method, front, back, frame, omega, depth, gravity, towards, confidence, seed)
    if method == "jh2020":
        return _paper(task, bed)
    return _regular(task, wave_number) if kind == "regular" else _irregular(task)


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


@dataclass(frozen=True)
class Task:
    """What is asked: gauges with the incident wave going to +x, and when; see reflection()."""

    kind: str
    method: str
    front: Gauges
    back: Gauges | None
    frame: Window
    omega: float
    depth: float
    gravity: float
    towards: float
    confidence: float
    seed: int

    @property
    def k(self) -> float:
        """Linear wave number [rad/m]."""
        return float(linear_number(self.omega, self.depth, self.gravity))


def _regular(task: Task, number: float | str | None) -> Reflection:
    x, frame = task.front.x, task.frame
    F = energies.per_period(task.front, task.omega, frame.start, frame.periods)
    mean = F.mean(axis=0)
    k = task.k if number is None else number
    k = fit_wave_number(x, mean[:, 1], task.k) if isinstance(k, str) else k
    through = None
    if task.back is not None:
        through = (energies.per_period(task.back, task.omega, frame.start, frame.periods, 1)[:, :, 1], task.back.x)

    def of(chosen: list[int], method: str) -> Pieces:
        return energies.regular(F[:, chosen, 1], x[chosen], k, method, through)

    parts = separate_xt(x, mean, task.omega, task.depth, k, task.gravity)
    notes = [] if frame.periods >= 5 else [f"{frame.periods} periods only: 5 or more make a steady state believable"]
    if number is None and parts[0].residual > RESIDUAL:
        notes.append(
            f"{100 * parts[0].residual:.0f} % of the amplitude is not two waves of k = {k:.4g} rad/m: "
            "try wave_number='fit' (high waves are longer), check period, depth and the places of the gauges"
        )
    if not all(part.resolved for part in parts):
        orders = ", ".join(str(part.order) for part in parts if not part.resolved)
        notes.append(
            f"harmonics {orders}: these gauges cannot tell free from bound waves (C_R is of the first harmonic)"
        )
    found = estimate(of, x, k, task)
    return _answer(task, k, found, 2.0, notes, parts[0].residual, harmonics=tuple(parts), amplitudes=mean)


def _irregular(task: Task, taper: float = 0.1) -> Reflection:
    peak = task.omega / (2 * np.pi)
    band, frame = (0.5 * peak, 2.0 * peak), task.frame
    inside = task.front.between(frame.start, frame.end)
    density = None if task.back is None else _transmitted(task, band, taper)

    def separated(chosen: list[int], method: str) -> Lines:
        return energies.lines(inside.pick(chosen), task.depth, band, method, task.gravity, taper)

    found = separated(list(range(len(inside.x))), task.method)
    used, notes = found.trust > 0, []
    if not used.all():
        notes.append(
            f"{np.sum(~used)} of {len(used)} lines are left out, the gauges cannot tell the waves apart there "
            f"({found.frequency[~used].min():.3g} to {found.frequency[~used].max():.3g} Hz)"
        )
    result = estimate(lambda rows, method: energies.irregular(separated(rows, method), density), inside.x, task.k, task)
    rest = float(np.sqrt(1.0 - np.mean(found.trust[used]))) if len(inside.x) > 2 else float("nan")
    return _answer(task, task.k, result, 4.0, notes, rest, lines=found)


def _transmitted(task: Task, band: tuple[float, float], taper: float) -> NDArray[Any]:
    """Density of the wave behind at the lines of the band: going away if two gauges stand there, all of it if one."""
    assert task.back is not None
    late = task.back.between(task.frame.start, task.frame.end)
    if len(late.x) > 1:
        return energies.lines(late, task.depth, band, "zelt-skjelbreia", task.gravity, taper).incident
    _, F, unit = energies.fourier(late, band, taper)
    return unit * np.abs(F[:, 0]) ** 2


@dataclass(frozen=True)
class Estimate:
    """Energies (incident, reflected, transmitted), coefficients and half widths (R, T, D), and what those cover."""

    energy: NDArray[Any]
    values: NDArray[Any]
    half: NDArray[Any]
    covers: str


def coefficients(energy: NDArray[Any]) -> NDArray[Any]:
    """C_R, C_T, C_D (..., 3) of the energies (..., 2 or 3): incident, reflected and, if it was measured,
    transmitted.
    """
    whole = np.where(energy[..., 0] > 0, energy[..., 0], np.nan)
    reflected = energy[..., 1] / whole
    through = energy[..., 2] / whole if energy.shape[-1] > 2 else np.full_like(whole, np.nan)
    return np.stack([np.sqrt(reflected), np.sqrt(through), 1.0 - reflected - through], axis=-1)


def estimate(of: Callable[[list[int], str], Pieces], x: NDArray[Any], k: float, task: Task) -> Estimate:
    """Coefficients and half widths; of(gauges, method) gives the pieces of energy that these gauges see."""
    pieces = of(list(range(len(x))), task.method)
    energy = pieces.energy(pieces.values)
    if not energy[0] > 0:
        raise AnalysisError("there is no incident wave at this period and direction: check period, window and towards")
    error = bootstrap(lambda values: coefficients(pieces.energy(values)), pieces.values, task.seed)
    covers = f"change between {len(pieces.values)} {pieces.unit} (moving-block bootstrap)"
    chosen, scatter = subsets(x, k, task.seed), np.full(3, np.nan)
    if len(chosen) > 1:
        others = [of(list(c), "zelt-skjelbreia") for c in chosen]
        scatter = np.std([coefficients(p.energy(p.values)) for p in others], axis=0, ddof=1)
        covers += f" and disagreement of {len(chosen)} {'triples' if len(chosen[0]) == 3 else 'pairs'} of gauges"
    else:
        covers += "; gauges that disagree would not show (two only)"
    half = half_width(error, len(pieces.values), scatter, task.confidence)
    return Estimate(
        energy, coefficients(energy), half, covers + "; not an error common to all gauges, nor of the model"
    )


def _answer(
    task: Task, k: float, e: Estimate, factor: float, notes: list[str], residual: float, **details: Any
) -> Reflection:
    low, high = e.values - e.half, e.values + e.half
    low[:2] = np.maximum(low[:2], 0.0)
    H_I, H_R, H_T = (float(h) for h in factor * np.sqrt(np.append(e.energy, np.nan)[:3]))
    values: dict[str, Any] = dict(zip(("C_R", "C_T", "C_D"), map(float, e.values), strict=True))
    spans = [(float(a), float(b)) for a, b in zip(low, high, strict=True)]
    intervals: dict[str, Any] = dict(zip(("interval_R", "interval_T", "interval_D"), spans, strict=True))
    quality: dict[str, Any] = {
        "residual": residual,
        "spread": float(spread(k, task.front.x)),
        "covers": e.covers,
        "notes": tuple(notes),
    }
    return Reflection(
        **_what(task, k),
        **values,
        **intervals,
        H_I=H_I,
        H_R=H_R,
        H_T=H_T,
        confidence=task.confidence,
        **quality,
        **details,
    )


def _what(task: Task, k: float) -> dict[str, Any]:
    same = {name: getattr(task, name) for name in ("kind", "method", "depth", "towards")}
    return {**same, "period": 2 * np.pi / task.omega, "wave_number": k, "window": task.frame, "record": task.front}


def _paper(task: Task, bed: float) -> Reflection:
    """Levels above the bed: the highest and the lowest at the gauges in front, crest less trough behind."""
    level = task.front.between(task.frame.start, task.frame.end).eta - bed
    through = float("nan")
    if task.back is not None:
        late = task.back.between(task.frame.start, task.frame.end).eta
        through = float(np.mean(late.max(axis=1) - late.min(axis=1)))
    p = jh2020(float(level.max()), float(level.min()), through)
    nothing: dict[str, Any] = {
        "interval_R": NONE,
        "interval_T": NONE,
        "interval_D": NONE,
        "residual": NONE[0],
        "spread": NONE[0],
    }
    return Reflection(
        **_what(task, task.k),
        **nothing,
        C_R=p.C_R,
        C_T=p.C_T,
        C_D=p.C_D,
        H_I=p.H_I,
        H_R=p.H_R,
        H_T=through,
        confidence=0.0,
        covers="none: this formula is not an estimate of the reflection",
        notes=(p.warning,),
    )

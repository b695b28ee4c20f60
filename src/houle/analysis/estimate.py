"""Coefficients with their intervals, from gauges and a window: regular waves, irregular waves, the paper's formula."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from houle.analysis import energies, phase
from houle.analysis.energies import Pieces
from houle.analysis.errors import AnalysisError
from houle.analysis.levels import Gauges
from houle.analysis.paper import jh2020
from houle.analysis.result import Reflection
from houle.analysis.separation import Lines, fit_wave_number, separate_xt, spread
from houle.analysis.uncertainty import bootstrap, half_width, subsets
from houle.analysis.window import Window
from houle.waves.dispersion import wave_number

RESIDUAL = 0.1  # share of the amplitude: a note says if the residual is larger
NONE = (float("nan"), float("nan"))


@dataclass(frozen=True)
class Task:
    """A task for the analysis: records in front and behind, with the incident wave going to +x, and the window."""

    kind: str
    method: str
    front: Gauges
    back: Gauges | None
    window: Window
    omega: float
    depth: float
    gravity: float
    towards: float
    confidence: float
    seed: int

    @property
    def k(self) -> float:
        """Linear wave number [rad/m]."""
        return float(wave_number(self.omega, self.depth, self.gravity))


def regular(task: Task, number: float | str | None) -> Reflection:
    """Regular waves: first harmonic over whole periods. number: wave number [rad/m], None (linear) or "fit"."""
    task, turning = _steady(task)
    x, window = task.front.x, task.window
    F = energies.per_period(task.front, task.omega, window.start, window.periods)
    mean = F.mean(axis=0)
    k = task.k if number is None else number
    k = fit_wave_number(x, mean[:, 1], task.k) if isinstance(k, str) else k
    through = None
    if task.back is not None:
        through = (energies.per_period(task.back, task.omega, window.start, window.periods, 1)[:, :, 1], task.back.x)

    def pieces_of(chosen: list[int], method: str) -> Pieces:
        return energies.regular(F[:, chosen, 1], x[chosen], k, method, through)

    parts = separate_xt(x, mean, task.omega, task.depth, k, task.gravity)
    notes = (
        turning
        if window.periods >= 5
        else [*turning, f"{window.periods} periods only: 5 or more make a steady state believable"]
    )
    if number is None and parts[0].residual > RESIDUAL:
        notes.append(
            f"{100 * parts[0].residual:.0f} % of the amplitude is not two waves of k = {k:.4g} rad/m: try "
            "wave_number='fit' (high waves are longer), check period, depth and the places of the gauges"
        )
    if not all(part.resolved for part in parts):
        orders = ", ".join(str(part.order) for part in parts if not part.resolved)
        notes.append(
            f"harmonics {orders}: these gauges cannot tell free from bound waves (C_R is of the first harmonic)"
        )
    found = estimate(pieces_of, x, k, task)
    return _answer(task, k, found, 2.0, notes, parts[0].residual, harmonics=tuple(parts), amplitudes=mean)


def _steady(task: Task) -> tuple[Task, list[str]]:
    """The task at the period whose phase stands still in the window, and notes. Raises AnalysisError."""
    window, front = task.window, task.front

    def amplitudes(omega: float, periods: int) -> NDArray[Any]:
        return np.asarray(energies.per_period(front, omega, window.start, periods, 3)[:, :, 1])

    end = min(window.end, float(front.time[-1]) + front.step)
    omega, notes = phase.followed(amplitudes, task.omega, window.start, end, front)
    if omega == task.omega:
        return task, notes
    periods = int(np.floor((end - window.start) * omega / (2 * np.pi) + 1e-6))
    whole = replace(window, end=window.start + periods * 2 * np.pi / omega, periods=periods)
    return replace(task, omega=omega, window=whole), notes


def irregular(task: Task, taper: float = 0.1) -> Reflection:
    """Irregular waves: Fourier lines of 0.5 to 2 f_p. taper: share of the record over which its ends fade."""
    peak = task.omega / (2 * np.pi)
    band, window = (0.5 * peak, 2.0 * peak), task.window
    inside = task.front.between(window.start, window.end)
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
    whole = np.sum(found.incident[used]) / np.sum((found.incident * found.trust)[used])
    result = replace(result, energy=float(whole) * result.energy)  # trust weighs lines, it lowers no wave
    return _answer(task, task.k, result, 4.0, notes, rest, lines=found)


def _transmitted(task: Task, band: tuple[float, float], taper: float) -> NDArray[Any]:
    """Density of the wave behind at the lines of the band: going away if two gauges stand there, all of it if one."""
    assert task.back is not None
    late = task.back.between(task.window.start, task.window.end)
    if len(late.x) > 1:
        return energies.lines(late, task.depth, band, "zelt-skjelbreia", task.gravity, taper).incident
    _, F, unit = energies.fourier(late, band, taper)
    return unit * np.abs(F[:, 0]) ** 2


@dataclass(frozen=True)
class Estimate:
    """Energies (incident, reflected, transmitted), coefficients, half widths (R, T, D), and what the latter cover."""

    energy: NDArray[Any]
    values: NDArray[Any]
    half: NDArray[Any]
    covers: str


def coefficients(energy: NDArray[Any]) -> NDArray[Any]:
    """C_R, C_T, C_D (..., 3) of the energies (..., 2 or 3): incident, reflected and, if measured, transmitted."""
    whole = np.where(energy[..., 0] > 0, energy[..., 0], np.nan)
    reflected = energy[..., 1] / whole
    through = energy[..., 2] / whole if energy.shape[-1] > 2 else np.full_like(whole, np.nan)
    return np.stack([np.sqrt(reflected), np.sqrt(through), 1.0 - reflected - through], axis=-1)


def estimate(pieces_of: Callable[[list[int], str], Pieces], x: NDArray[Any], k: float, task: Task) -> Estimate:
    """Coefficients and half widths; pieces_of(gauges, method) gives the pieces of energy that these gauges see."""
    pieces = pieces_of(list(range(len(x))), task.method)
    energy = pieces.energy(pieces.values)
    if not energy[0] > (phase.ROUND_OFF * np.abs(task.front.eta).max()) ** 2:
        raise AnalysisError("there is no incident wave at this period and direction: check period, window and towards")
    error = bootstrap(lambda values: coefficients(pieces.energy(values)), pieces.values, task.seed)
    covers = f"change between {len(pieces.values)} {pieces.unit} (moving-block bootstrap)"
    chosen, scatter = subsets(x, k, task.seed), np.full(3, np.nan)
    if len(chosen) > 1:
        others = [pieces_of(list(c), "zelt-skjelbreia") for c in chosen]
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
    notes = [*notes, *_impossible(values, spans)]
    quality: dict[str, Any] = {
        "residual": residual,
        "spread": float(spread(k, task.front.x)),
        "covers": e.covers,
        "notes": tuple(notes),
    }
    return Reflection(
        **_settings(task, k),
        **values,
        **intervals,
        H_I=H_I,
        H_R=H_R,
        H_T=H_T,
        confidence=task.confidence,
        **quality,
        **details,
    )


def _impossible(values: dict[str, float], spans: list[tuple[float, float]]) -> list[str]:
    """Notes on coefficients that no structure has, written when the intervals leave no doubt."""
    if values["C_R"] > 1.0 and not spans[0][0] <= 1.0:
        return [
            f"C_R = {values['C_R']:.3g} is above 1, which no structure does that only stands there: incident and "
            "reflected waves have changed places. Check the order and the signs of the positions, and towards (-1 if "
            "the incident waves go to -x)"
        ]
    if values["C_D"] < 0.0 and spans[2][1] < 0.0:
        return [
            f"C_D = {values['C_D']:.3g} is below 0: more energy leaves than comes. Check the positions and scales of "
            "the gauges, those behind above all"
        ]
    return []


def _settings(task: Task, k: float) -> dict[str, Any]:
    same = {name: getattr(task, name) for name in ("kind", "method", "depth", "towards")}
    return {**same, "period": 2 * np.pi / task.omega, "wave_number": k, "window": task.window, "record": task.front}


def paper(task: Task, bed: float) -> Reflection:
    """The paper's formula: highest and lowest level above the bed at the gauges in front, crest less trough behind."""
    level = task.front.between(task.window.start, task.window.end).eta - bed
    through = float("nan")
    if task.back is not None:
        late = task.back.between(task.window.start, task.window.end).eta
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
        **_settings(task, task.k),
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

"""The sea of a case, in the numbers that published formulas take: as asked for, or read off a gauge after the run."""

from __future__ import annotations

from dataclasses import replace
from math import inf, isfinite, nan, pi, radians, sqrt
from typing import TYPE_CHECKING, Any

import numpy as np

from houle.analysis.errors import AnalysisError
from houle.analysis.waves import spectrum, zero_crossing
from houle.case.section import CrossSection
from houle.results.answers.structure import Sea
from houle.waves.dispersion import GRAVITY, group_velocity, wave_number

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from houle.case.model import Case
    from houle.output.netcdf import Table
    from houle.results.answers.given import Given
    from houle.waves.wave import Components

NO_SEA = {
    "solitary": "a single wave is no sea",
    "focused": "one group of waves is no sea",
    "series": "the waves are a record, which gives no steady sea",
    "paddle": "the waves are those of a recorded paddle, which gives no steady sea",
    "ship": "the waves of a ship are no steady sea",
    "regular": "the waves are all alike, the formula is for a sea",
}


def sea_of(case: Case) -> Sea | None:
    """The sea that a case asks for; None without [waves]. Raises CaseError where no theory gives the wave."""
    waves, wave = case.waves, case.wave
    if waves is None or wave is None:
        return None
    ends = waves.zone.x if waves.zone is not None else (waves.place,)
    level = waves.depth + _bed(case, waves.place)
    given: dict[str, Any] = {
        "depth": waves.depth, "level": level, "maker": float(ends[-1]), "ramp": waves.ramp_time(), "end": case.time.end,
        "angle": radians(waves.direction), "lack": NO_SEA.get(waves.kind, ""),
    }  # fmt: skip
    parts = wave.components()
    if waves.kind == "regular" or parts is None:
        period = wave.period if waves.kind == "regular" else wave.length / wave.celerity
        height = float(wave.height) if waves.kind == "regular" else nan
        speed = _speed(period, waves.depth) if waves.kind == "regular" else wave.celerity
        words = f"H {height:.4g} m, T {period:.4g} s" if waves.kind == "regular" else ""
        return Sea(height, period, period, speed=speed, regular=waves.kind == "regular", words=words, **given)
    period, mean = parts.energy_period, _mean_period(parts)
    if given["lack"]:
        return Sea(nan, nan, mean, speed=_speed(period, waves.depth), **given)
    words = f"H_m0 {wave.height:.4g} m and T_m-1,0 {period:.4g} s as asked for in [waves]"
    return Sea(float(wave.height), period, mean, speed=_speed(wave.period, waves.depth), words=words, **given)


def measured(sea: Sea, case: Case, series: Table, reflection: Mapping[str, Any]) -> Sea:
    """The sea with what the run measured: H_m0 of the incident waves, or of all waves at the gauge far from shore."""
    height = reflection.get("H_I") if reflection.get("kind") == "irregular" else None
    if height is not None and isfinite(height) and height > 0.0 and not sea.lack:
        words = f"H_m0 {height:.4g} m measured as incident at the gauges, T_m-1,0 {sea.period:.4g} s as asked for"
        return replace(sea, height=float(height), words=words)
    if case.waves is None or case.waves.kind not in ("series", "paddle"):
        return sea
    return _at_gauge(sea, series)


def together(runs: Sequence[Given]) -> Sea | None:
    """The sea of several runs that differ by their seed: that of the first, with the mean energy of all."""
    seas = [one.sea for one in runs if one.sea is not None]
    if len(seas) < len(runs):
        return None
    height = sqrt(sum(sea.height**2 for sea in seas) / len(seas))
    return replace(
        seas[0], height=height, words=f"H_m0 {height:.4g} m in the mean of {len(seas)} seeds; one: {seas[0].words}"
    )


def first_place(case: Case, sea: Sea) -> float:
    """The first place x [m] that a case asks about, from the maker; that itself if it asks about none."""
    places = [table.x for table in case.overtopping] + [table.x[1] for table in case.runup]
    places += [] if case.reflection is None else [case.reflection.structure[0]]
    return min(places, key=lambda x: abs(x - sea.maker), default=sea.maker)


def _at_gauge(sea: Sea, series: Table) -> Sea:
    """The sea by the zero-moment of the elevation at the gauge nearest to the maker; as it is without a gauge."""
    if "eta" not in series:
        return replace(sea, lack=f"{sea.lack}, and no gauge stands offshore")
    time, eta = series["time"].values, series["eta"].values
    x, names = series["gauge_x"].values, series["gauge"].values
    wet = [g for g in range(len(x)) if np.isfinite(eta[g]).all()]
    if not wet:
        return replace(sea, lack=f"{sea.lack}, and every gauge is dry at times")
    gauge = min(wet, key=lambda g: abs(x[g] - sea.maker))
    late = time >= sea.start(float(x[gauge]))
    try:
        found = spectrum(time[late], eta[gauge][late])
        mean = zero_crossing(time[late], eta[gauge][late]).T_z
    except AnalysisError as error:
        return replace(sea, lack=f"{sea.lack}; gauge {names[gauge]}: {error}")
    words = (
        f"H_m0 {found.H_m0:.4g} m and T_m-1,0 {found.T_m10:.4g} s by the zero-moment of gauge {names[gauge]}, incident "
        "and reflected waves together"
    )
    return replace(sea, height=found.H_m0, period=found.T_m10, mean=mean, words=words, lack="")


def _mean_period(parts: Components) -> float:
    """Mean period between zero crossings, T_m0,2 = sqrt(m_0/m_2) [s]."""
    moving = parts.moving
    energy = moving.amplitude**2
    return float(2 * pi * sqrt(np.sum(energy) / np.sum(energy * moving.omega**2)))


def _speed(period: float, depth: float) -> float:
    """Group velocity [m/s]."""
    if not isfinite(period):
        return sqrt(GRAVITY * depth)
    return float(group_velocity(wave_number(2 * pi / period, depth), depth))


def _bed(case: Case, x: float) -> float:
    """Level of the bed [m] at the maker: the top of the solids there."""
    section = CrossSection(case)
    depth, level = section.standing(np.array([min(max(x, 1e-6), case.domain.size[0] * (1 - 1e-9))]))
    found = float(np.nanmax(level - depth, initial=-inf))
    return found if isfinite(found) else 0.0

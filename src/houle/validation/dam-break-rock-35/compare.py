"""Surface profiles against Liu et al. (1999), pressure noise, volume; order of convergence over three spacings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from houle.data import laboratory
from houle.grid import FloatArray
from houle.validation.check import Check, Variant, report
from houle.validation.measure import grid_convergence_index, noise, rms, volume_checks, water_left_of

if TYPE_CHECKING:
    from houle.results.run import Run

POINTS = laboratory.read(Path(__file__).parent / "data" / "surface.csv")
INSTANT, LIFTED = 10.8, 10.0  # targets without and with the gate as a plate [mm]
PEERS = {"olaFlow": "10.8", "REEF3D": "7.7-16.5 per profile"}
LEE, WIDTH = 0.59, 0.892  # m
EDGES = np.linspace(0.0, WIDTH, 90)  # edges of columns of 10 mm [m]
HALF_OPEN = 0.05  # s after the gate starts
GATE = [{"x": 0.29, "speed": 3.5}]  # 0.35 m in the 0.1 s that the laboratory states
JENSEN = {"porous.rock.resistance": {"law": "jensen-2014"}}  # 500, 2.0 and KC 128
LIU = {
    "porous.rock.resistance": {"law": "liu-1999", "period": 1.0}
}  # the authors' own: 200, 1.1, KC where the water is

VARIANTS = (
    Variant("dx-10-mm", {"domain.spacing": 0.01}),
    Variant("", quick=False),
    Variant("dx-2.5-mm", {"domain.spacing": 0.0025}, quick=False),
    Variant("gate-dx-10-mm", {"domain.spacing": 0.01, "gate": GATE}),
    Variant("gate", {"gate": GATE}, quick=False),
    Variant("jensen-dx-10-mm", {"domain.spacing": 0.01, **JENSEN}),
    Variant("jensen", JENSEN, quick=False),
    Variant("liu-1999", LIU, quick=False),
    Variant("liu-1999-gate", {"gate": GATE, **LIU}, quick=False),
    Variant("jh2020", {"numerics.scheme": "jh2020"}, quick=False),
)


def compare(run: Run) -> list[Check]:
    """Checks of one run. Targets hold for the coefficients of the case, at the spacings named; else it is a report."""
    score = laboratory.score(POINTS, run.surface)
    assert score is not None
    found = [report(f"rms at {t:g} s", 1e3 * e, "mm") for t, e in zip(score.times, score.rms, strict=True)]
    limit = LIFTED if run.case.gate else INSTANT
    found += [Check("rms of the five profiles", 1e3 * score.overall, "mm", limit, peers=PEERS)]
    if run.case.gate:
        found.append(_half_open(run))
    found += [_noise(run), *volume_checks(run)]
    judged = run.case.numerics.scheme != "jh2020" and run.case.porous[0].resistance.law == "olaflow"
    judged = judged and run.case.domain.spacing > 0.004
    return found if judged else [report(c.name, c.value, c.unit, c.peers) for c in found]


def across(runs: Mapping[str, Run]) -> list[Check]:
    """Distance between the waters of successive spacings at the instants of the laboratory: depth of the water alone.

    Not of the surface, which has air beneath where it overhangs. The order is judged over the whole flume. Reported
    beside it: up to the rock's lee face, so without the roller behind, and how far the water is from its place, the
    mean distance over which it would have to be moved (Wasserstein), to the end and before the jump breaks.
    """
    if not {"dx-10-mm", "", "dx-2.5-mm"} <= runs.keys():
        return []
    coarse, middle, fine = (_water(runs[name]) for name in ("dx-10-mm", "", "dx-2.5-mm"))
    one, two = (1e3 * np.diff(w, axis=1) / np.diff(EDGES) for w in (coarse - middle, middle - fine))  # mm
    moved = [1e3 * WIDTH * np.mean(np.abs(w) / fine[:, -1:], axis=1) for w in (coarse - middle, middle - fine)]
    before = EDGES[1:] <= LEE
    first, second, order = _order(rms(one), rms(two))
    return [
        report("water depth, 10 mm from 5 mm, rms", first, "mm"),
        report("water depth, 5 mm from 2.5 mm, rms", second, "mm"),
        Check("order of convergence, water depth", order, "", 1.0, "min"),
        report("grid convergence index at 2.5 mm", grid_convergence_index(second, 2.0, order), "mm"),
        _reported("water depth, up to the lee face", *_order(rms(one[:, before]), rms(two[:, before]))),
        _reported("water depth, up to 0.75 s", *_order(rms(one[:2]), rms(two[:2]))),
        _reported("place of the water", *_order(*(float(np.mean(m)) for m in moved))),
        _reported("place of the water, up to 1.15 s", *_order(*(float(np.mean(m[:3])) for m in moved))),
    ]


def _water(run: Run) -> FloatArray:
    """Water [m2] (5, 90) to the left of the `EDGES` at the instants of the laboratory."""
    return np.stack([water_left_of(EDGES, run.fields.frame(run.fields.nearest(t))) for t in POINTS.times])


def _order(first: float, second: float) -> tuple[float, float, float]:
    return first, second, float(np.log2(first / second))


def _reported(what: str, first: float, second: float, order: float) -> Check:
    return report(f"order of convergence, {what}", order, note=f"{first:.2f} and {second:.2f} mm")


def _half_open(run: Run) -> Check:
    """Distance from the profiles if the laboratory's clock starts with the gate half way up: no source says when."""
    score = laboratory.score(replace(POINTS, time=POINTS.time + HALF_OPEN), run.surface)
    assert score is not None
    return report("rms, clock from the half open gate on", 1e3 * score.overall, "mm")


def _noise(run: Run) -> Check:
    """Largest noise of the pressure over the sensors, without the first tenth of a second (the release)."""
    late = run.series.sel(time=slice(0.1, None))
    scale = run.case.fluid.density * run.case.fluid.gravity * 0.35
    worst = max(noise(late.time.values, late.pressure.sel(sensor=name).values) for name in late.sensor.values)
    return Check("pressure noise above 20 Hz", 100.0 * worst / scale, "% rho g h", 0.2)

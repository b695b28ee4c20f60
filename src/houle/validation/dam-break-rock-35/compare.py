"""Surface profiles against Liu et al. (1999), pressure noise, volume; order of convergence over three spacings."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from houle import laboratory
from houle.validation.check import Check, Variant, report
from houle.validation.measure import grid_convergence_index, noise, profile_distance, volume_checks

if TYPE_CHECKING:
    from houle.runner import Run

POINTS = laboratory.read(Path(__file__).parent / "data" / "surface.csv")
INSTANT, LIFTED = 10.8, 10.0  # mm, targets without and with the gate as a plate
PEERS = {"olaFlow": "10.8", "REEF3D": "7.7-16.5 per profile"}
GATE = [{"x": 0.29, "speed": 3.5}]  # 0.35 m in the 0.1 s that the laboratory states
JENSEN = {"porous.rock.resistance": {"law": "jensen-2014"}}  # 500, 2.0 and KC 128

VARIANTS = (
    Variant("dx-10-mm", {"domain.spacing": 0.01}),
    Variant("", quick=False),
    Variant("dx-2.5-mm", {"domain.spacing": 0.0025}, quick=False),
    Variant("gate-dx-10-mm", {"domain.spacing": 0.01, "gate": GATE}),
    Variant("gate", {"gate": GATE}, quick=False),
    Variant("jensen-dx-10-mm", {"domain.spacing": 0.01, **JENSEN}),
    Variant("jensen", JENSEN, quick=False),
    Variant("liu-1999", {"porous.rock.resistance": {"law": "liu-1999", "kc": 12.8}}, quick=False),
    Variant("jh2020", {"numerics.scheme": "jh2020"}, quick=False),
)


def compare(run: Run) -> list[Check]:
    """The paper's scheme, jh2020, is reported and not judged."""
    score = laboratory.score(POINTS, run.surface)
    assert score is not None
    found = [report(f"rms at {t:g} s", 1e3 * e, "mm") for t, e in zip(score.times, score.rms, strict=True)]
    limit = LIFTED if run.case.gate else INSTANT
    found += [Check("rms of the five profiles", 1e3 * score.overall, "mm", limit, peers=PEERS)]
    found += [_noise(run), *volume_checks(run)]
    paper = run.case.numerics.scheme == "jh2020"
    return [report(c.name, c.value, c.unit, c.peers) for c in found] if paper else found


def across(runs: Mapping[str, Run]) -> list[Check]:
    """Distance between the profiles of successive spacings at the instants of the laboratory."""
    if not {"dx-10-mm", "", "dx-2.5-mm"} <= runs.keys():
        return []
    coarse, middle, fine = (runs[name].surface for name in ("dx-10-mm", "", "dx-2.5-mm"))
    x = np.linspace(0.02, 0.87, 171)
    first, second = (profile_distance(*pair, POINTS.times, x) for pair in ((coarse, middle), (middle, fine)))
    order = float(np.log2(first / second))
    return [
        report("10 mm from 5 mm, rms", 1e3 * first, "mm"),
        report("5 mm from 2.5 mm, rms", 1e3 * second, "mm"),
        Check("order of convergence", order, "", 1.0, "min"),
        report("grid convergence index at 2.5 mm", 1e3 * grid_convergence_index(second, 2.0, order), "mm"),
    ]


def _noise(run: Run) -> Check:
    """Largest over the sensors, the first tenth of a second (the release) left out."""
    late = run.series.sel(time=slice(0.1, None))
    scale = run.case.fluid.density * run.case.fluid.gravity * 0.35
    worst = max(noise(late.time.values, late.pressure.sel(sensor=name).values) for name in late.sensor.values)
    return Check("pressure noise above 20 Hz", 100.0 * worst / scale, "% rho g h", 0.2)

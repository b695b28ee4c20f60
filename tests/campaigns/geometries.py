"""Random valid geometries, each run for a moment: nothing may gain energy, blow up or turn non-finite.

    python tests/campaigns/geometries.py --cases 200 --seed 1 [--threads 1] [--keep FOLDER]

Boxes, polygons and slopes of porous and solid, porosities from 0.05 to 0.95, with drag and without, gates, sponges and
open sides, water at rest and thrown, 2D and coarse 3D, all transfers, two kernels, with remeshing and without, both
schemes: some hundred to a few thousand particles each. A case passes when its run comes to its end and its kinetic
energy was never more than 1 % above what the water had and was given (houle.flow.budget, which stops a run at 5 %). The
case files of those that fail are written to FOLDER. Case number k of a seed is the same whatever runs before it. Ends
with status 1 if any failed.
"""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from houle import load
from houle.case.build import build
from houle.errors import CaseError, HouleError
from houle.flow.simulation import Simulation

TRANSFERS = ("fmpm", "fmpm", "flip", "apic", "pic")
MOST_STEPS = 4000
TOLERANCE = 0.01  # of the energy to be had


class Outcome(NamedTuple):
    """Result of a case: most, the largest ratio of kinetic energy to what there was; failure, empty where none."""

    case: dict[str, Any]
    steps: int
    particles: int
    most: float
    failure: str


def _shape(rng: np.random.Generator, size: np.ndarray, low: float, high: float) -> dict[str, Any]:
    """A box, or a quadrilateral or a slope in the section, whose extent is a share low to high of the tank."""
    extent = rng.uniform(low, high, len(size)) * size
    start = rng.uniform(-0.1, 1.0, len(size)) * (size - extent)
    end = start + extent
    kind = rng.choice(["box", "quadrilateral", "slope"])
    if kind == "box":
        return {"box": [np.round(start, 4).tolist(), np.round(end, 4).tolist()]}
    (x0, z0), (x1, z1) = (start[0], start[-1]), (end[0], end[-1])
    if kind == "slope":
        corners = [[x0, z0], [x1, z0], [x1, z1]] if rng.random() < 0.5 else [[x0, z0], [x1, z0], [x0, z1]]
    else:
        share = rng.uniform(0.0, 0.6, 2) * (x1 - x0)
        corners = [[x0, z0], [x1, z0], [x1 - share[0], z1], [x0 + 0.6 * share[1], z1]]
    return {"polygon": np.round(corners, 4).tolist()}


def _resistance(rng: np.random.Generator) -> dict[str, Any]:
    if rng.random() < 0.4:
        return {"resistance": {"a": 0.0, "b": 0.0}}
    if rng.random() < 0.5:
        return {"resistance": {"a": float(10 ** rng.uniform(-1, 2)), "b": float(10 ** rng.uniform(0, 3))}}
    return {"grain_diameter": float(10 ** rng.uniform(-2.5, -1)), "resistance": {"law": "van-gent-1995"}}


def _porous(rng: np.random.Generator, size: np.ndarray) -> dict[str, Any]:
    porosity = float(np.round(rng.choice([rng.uniform(0.05, 0.25), rng.uniform(0.25, 0.95)]), 3))
    added = {} if rng.random() < 0.7 else {"added_mass": float(rng.choice([0.0, 1.0]))}
    return {**_shape(rng, size, 0.2, 0.7), "porosity": porosity, **_resistance(rng), **added}


def _water(rng: np.random.Generator, size: np.ndarray) -> list[dict[str, Any]]:
    blocks: list[dict[str, Any]] = [_shape(rng, size, 0.2, 0.6) for _ in range(rng.integers(1, 3))]
    if rng.random() < 0.4:
        blocks.append({"below": float(np.round(rng.uniform(0.08, 0.4) * size[-1], 4))})
    if rng.random() < 0.2:
        blocks[0]["velocity"] = np.round(rng.uniform(-1.0, 1.0, len(size)), 2).tolist()
    return blocks


def _numerics(rng: np.random.Generator) -> dict[str, Any]:
    if rng.random() < 0.1:
        return {"scheme": "jh2020"}
    keys: dict[str, Any] = {"transfer": str(rng.choice(TRANSFERS))}
    if rng.random() < 0.15:
        keys["remesh"] = "none"
    if rng.random() < 0.15:
        keys["correction"] = 0.0
    if rng.random() < 0.15:
        keys["kernel"] = "quadratic"
    return keys


def random_case(seed: int, number: int) -> dict[str, Any]:
    """Tables of a case file. It may be one that houle refuses, of two bodies at the same place or of no water."""
    rng = np.random.default_rng([seed, number])
    plane = rng.random() < 0.8
    size = np.array([1.5, 0.5] if plane else [0.6, 0.3, 0.3]) * rng.uniform(0.7, 1.3)
    spacing = float(np.round(size[-1] / (rng.integers(14, 30) if plane else rng.integers(7, 10)), 4))
    case: dict[str, Any] = {
        "case": {"name": f"geometry-{seed}-{number}"},
        "domain": {"size": np.round(size, 4).tolist(), "spacing": spacing},
        "water": _water(rng, size),
        "porous": [_porous(rng, size) for _ in range(rng.integers(1, 4))],
        "numerics": _numerics(rng),
        "time": {"end": float(np.round(2.5 * np.sqrt(2.0 * size[-1] / 9.81), 3))},
    }
    if rng.random() < 0.5:
        case["solid"] = [_shape(rng, size, 0.1, 0.4) for _ in range(rng.integers(1, 3))]
    if rng.random() < 0.2:
        case["gate"] = [{"x": float(np.round(rng.uniform(0.3, 0.7) * size[0], 3)), "speed": 1.0}]
    if rng.random() < 0.2:
        low, high = [0.75 * size[0], *[0.0] * (len(size) - 1)], size.tolist()
        case["sponge"] = [{"box": [low, high], "strength": 5.0}]
    if rng.random() < 0.15:
        case["open"] = [{"side": "right", "level": float(np.round(0.3 * size[-1], 3))}]
        case["water"].append({"below": float(np.round(0.3 * size[-1], 3))})
    return case


def run(case: dict[str, Any], threads: int = 1) -> Outcome:
    """Raises CaseError for a case that houle refuses."""
    sim = Simulation(build(load(case)), threads)
    end, most, failure = sim.setup.time.end, 0.0, ""
    try:
        while sim.time < end and sim.steps < MOST_STEPS:
            sim.advance(end)
            flow, budget = sim.flow, sim.budget
            given = budget.available(flow, sim.ledger) + budget.fall * flow.particles.total_volume
            most = max(most, sim.ledger.kinetic / max(given, 1e-300))
    except HouleError as error:
        failure = str(error)
    if not failure and most > 1.0 + TOLERANCE:
        failure = f"the kinetic energy was {most:.3f} times what there was"
    if not failure and sim.time < end:
        failure = f"{sim.steps} steps came to {sim.time:.3g} s of {end:g} s"
    return Outcome(case, sim.steps, len(sim.particles), most, failure)


def campaign(seed: int, cases: int, threads: int = 1, first: int = 0) -> list[Outcome]:
    """The first so many valid cases of a seed, from this number on."""
    outcomes: list[Outcome] = []
    while len(outcomes) < cases:
        case = random_case(seed, first)
        first += 1
        try:
            outcomes.append(run(case, threads))
        except CaseError:
            continue
        _say(outcomes[-1], len(outcomes))
    return outcomes


def _say(outcome: Outcome, number: int) -> None:
    name, n = outcome.case["case"]["name"], [p["porosity"] for p in outcome.case["porous"]]
    kind = outcome.case["numerics"].get("scheme") or outcome.case["numerics"]["transfer"]
    line = f"{number:4d} {name:18s} {kind:7s} n = {n}, {outcome.particles} particles, {outcome.steps} steps, "
    print(f"{line}at most {outcome.most:.3f} of the energy. {outcome.failure}", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder for the cases that failed, as JSON")
    asked = parser.parse_args()
    outcomes = campaign(asked.seed, asked.cases, asked.threads, asked.first)
    failed = [o for o in outcomes if o.failure]
    for outcome in failed if asked.keep else []:
        asked.keep.mkdir(parents=True, exist_ok=True)
        text = json.dumps({"case": outcome.case, "failure": outcome.failure}, indent=1)
        (asked.keep / f"{outcome.case['case']['name']}.json").write_text(text + "\n", encoding="utf-8")
    print(f"{len(outcomes)} geometries, {len(failed)} failed; most energy {max(o.most for o in outcomes):.3f}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

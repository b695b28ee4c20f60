"""Mean overtopping of tests of the CLASH database (2004), computed as an engineer would, beside the laboratory.

    python benchmarks/clash.py write KIND DIR [--spacing 0.02] [--waves 100] [--roughness 0]
    houle run DIR/TEST.toml --out DIR/TEST      for every TEST that was written
    python benchmarks/clash.py compare DIR

KIND is slope, wall or mound.

Which tests: those with q / sqrt(g Hm0^3) >= 1e-4 whose T_m-1,0 is that of a JONSWAP spectrum, T_p/1.1, within 5 %,
whose still water from maker to structure covers at most 8 m2 (the cost), and of mounds whose filter is a spacing and a
half thick; sorted by q* and cut into eight parts of as many tests, from each part the one in its middle. One section
each, from the numbers of the table and nothing else: a relaxation zone, a level bed, the foreshore, a smooth slope with
a sharp crest or a wall, a dry basin behind that holds what comes over. Beds and walls slip, or rub with --roughness. A
mound has the stones that the table does not tell: armour of two layers with Hs/(Delta D_n50) = 1.75, three layers of
filter of a tenth of its mass, a core of a two-hundredth (The Rock Manual, chapter 5), drag by van Gent (1995) with his
coefficients and the period of the sea; a box behind its crest catches the water.

Printed for each: the discharge with its interval of 90 %, the laboratory's, EurOtop's, freeboard, heights of the waves
and CPU seconds; for all of a kind: the share within a factor of two and the geometric bias of both. Tests of the
same numbers differ by 1.25.
"""

from __future__ import annotations

import argparse
import csv
import json
from collections.abc import Iterator
from math import hypot, pi
from pathlib import Path
from typing import Any

import numpy as np

from houle import load, open_run
from houle.design.nearest import TABLE
from houle.design.sea import discharge
from houle.waves.dispersion import wave_number

LEAST, AREA, PARTS = 1e-4, 8.0, 8
STABILITY, DELTA, FLAT = 1.75, 1.65, 1000.0
VOIDS = {"armour": 0.45, "filter": 0.40, "core": 0.38}
MASSES = {"armour": 1.0, "filter": 0.1, "core": 0.005}  # of a stone, over that of the armour
LAYERS = {"armour": 2, "filter": 3}  # stones on each other
Row = dict[str, float]
Points = list[list[float]]


def tests(kind: str) -> Iterator[Row]:
    """Tests of a kind of which all numbers are known, with length [m] of the peak in front of the foreshore and q*."""
    lines = [line for line in TABLE.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    for line in csv.DictReader(lines):
        if line.pop("kind") != kind or "" in line.values():
            continue
        test = {name: float(value) for name, value in line.items()}
        test["q_star"] = test["q"] / discharge(test["hm0_toe"])
        test["length"] = round(2 * pi / float(wave_number(2 * pi / test["tp_deep"], test["depth_deep"])), 2)
        yield test


def bed_end(test: Row) -> float:
    """The place x [m] where the level bed ends: behind zone and gauges."""
    return round(2.1 * test["length"], 4)


def toe(test: Row) -> float:
    """The place x [m] where the structure begins: behind the level bed and the foreshore."""
    if test["foreshore_cot"] >= FLAT:
        return bed_end(test)
    return round(bed_end(test) + (test["depth_deep"] - test["depth_toe"]) * test["foreshore_cot"], 4)


def chosen(kind: str, spacing: float) -> list[Row]:
    """One test of each eighth, by the rule at the head of this file."""
    found = []
    for test in tests(kind):
        jonswap = abs(1.1 * test["tm10_deep"] / test["tp_deep"] - 1) <= 0.05
        small = toe(test) * test["depth_deep"] <= AREA
        fine = kind != "mound" or thickness(test, "filter") >= 1.5 * spacing
        smooth = kind == "mound" or test["gamma_f"] == 1.0
        if test["q_star"] >= LEAST and jonswap and small and fine and smooth:
            found.append(test)
    parts = np.array_split(np.array(sorted(found, key=lambda test: test["q_star"])), PARTS)
    return [part[len(part) // 2] for part in parts]


def stone(test: Row, layer: str) -> float:
    """Nominal diameter D_n50 [m] of the stones of a layer."""
    return float(test["hm0_toe"] / (STABILITY * DELTA) * MASSES[layer] ** (1 / 3))


def thickness(test: Row, layer: str) -> float:
    """Thickness [m] of a layer of a mound, across it."""
    return LAYERS[layer] * stone(test, layer)


def mound(test: Row, start: float, foot: float, spacing: float) -> dict[str, list[Any]]:
    """Armour, filter and core of a mound from its toe at (start, foot), and the box behind its crest."""
    cot, still = test["slope_cot"], test["depth_deep"]
    top, level = still + test["ac"], still + test["rc"]
    back = start + cot * (top - foot) + max(test["gc"], 3 * stone(test, "armour"))

    def outline(depth: float) -> Points:
        """From toe to crest and to the back, at a depth under the surface of the mound."""
        foot_x, crest = start + depth * hypot(1, cot), top - depth
        return [[foot_x, foot], [foot_x + cot * (crest - foot), crest], [back, crest]]

    depths = [0.0, thickness(test, "armour"), thickness(test, "armour") + thickness(test, "filter")]
    bodies: list[Any] = []
    for place, layer in enumerate(VOIDS):
        inner = outline(depths[place + 1])[::-1] if layer in LAYERS else [[back, foot]]
        bodies.append(
            {"name": layer, "polygon": outline(depths[place]) + inner, "porosity": VOIDS[layer]}
            | {"grain_diameter": stone(test, layer) / 0.84, "resistance": {"law": "van-gent-1995"}}
        )
    wall = [[back, 0.0], [back, level], [back + 2 * spacing, level], [back + 2 * spacing, 0.0]]
    return {"porous": bodies, "solid": [{"name": "box", "polygon": wall}]}


def solid(test: Row, start: float, foot: float, spacing: float) -> dict[str, list[Any]]:
    """A slope or wall from its toe at (start, foot), upright behind its crest."""
    level = test["depth_deep"] + test["rc"]
    crest = start + test["slope_cot"] * (level - foot)
    edge = [[start, 0.0], [start, foot], [crest, level], [crest + 2 * spacing, level], [crest + 2 * spacing, 0.0]]
    return {"solid": [{"name": "structure", "polygon": edge if foot > 0 else edge[1:]}]}


def wet(test: Row, kind: str, start: float, foot: float, back: float) -> Points:
    """Still water from the maker over the bed to the face of the structure, or to the box at the back of a mound."""
    still = test["depth_deep"]
    bed = [[0.0, 0.0], [bed_end(test), 0.0]] + ([[start, foot]] if foot > 0 else [])
    shore = [[back, foot], [back, still]] if kind == "mound" else [[start + test["slope_cot"] * (still - foot), still]]
    return [*bed, *shore, [0.0, still]]


def case(test: Row, kind: str, spacing: float, waves: int, roughness: float | None) -> dict[str, object]:
    """The case of a test."""
    height, still, length = test["hm0_deep"], test["depth_deep"], test["length"]
    start, foot = toe(test), round(still - test["depth_toe"], 4)
    parts = (mound if kind == "mound" else solid)(test, start, foot, spacing)
    body = parts["solid"][0]
    end = max(x for x, _ in body["polygon"])
    crest, level = end - spacing, still + test["rc"]
    time = 1.6 * waves * test["tp_deep"]
    basin = max(0.6, 2.5 * test["q"] * time / (0.6 * level))
    gauges = [1.2, 1.3, 1.45, 1.6, 1.75]
    if foot > 0:
        rear = [[end - 2 * spacing, 0.0], [end - 2 * spacing, foot]] if kind == "mound" else [[start, 0.0]]
        parts["solid"].append({"name": "bed", "polygon": [[bed_end(test), 0.0], *rear, [start, foot]]})
    if roughness is not None:
        parts["solid"] = [{**table, "roughness": roughness} for table in parts["solid"]]
    top = level + (3.0 if kind == "wall" else 2.0) * height
    return {
        "case": {"name": f"{kind}-{test['row']:.0f}", "title": f"CLASH, row {test['row']:.0f}"},
        "domain": {"size": [spacing * round((end + basin) / spacing), spacing * round(top / spacing)]}
        | {"spacing": spacing},
        "water": [{"polygon": wet(test, kind, start, foot, end - 2 * spacing)}],
        "waves": {"kind": "jonswap", "height": height, "period": test["tp_deep"], "depth": still, "seed": 1}
        | {"order": 2, "zone": {"x": [0.0, length]}},
        **parts,
        "gauge": [{"name": f"G{i}", "x": x * length} for i, x in enumerate(gauges)],
        "reflection": {"structure": [bed_end(test)], "gauges": [f"G{i}" for i in range(len(gauges))], "twin": False},
        "overtopping": [{"name": "crest", "x": crest}],
        "time": {"end": time, "until": {"waves": waves}},
        "output": {"every": 5.0, "series_every": 0.02},
    }


def write(kind: str, folder: Path, spacing: float, waves: int, roughness: float | None) -> None:
    """Writes a case file for each test that is chosen, and the test beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    for test in chosen(kind, spacing):
        name = f"{kind}-{test['row']:.0f}"
        text = load(case(test, kind, spacing, waves, roughness)).to_toml()
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
        (folder / f"{name}.json").write_text(json.dumps(test, indent=1), encoding="utf-8")
        print(f"{name}: q* {test['q_star']:.2e}, toe at {toe(test):.2f} m")


def compare(folder: Path) -> None:
    """Prints a row for each run that has ended, and the numbers of each kind."""
    print("test        q [l/s/m]  90 %             laboratory  EurOtop  Rc/Hm0  Hm0 in, asked [mm]  CPU [s]")
    errors: dict[str, list[tuple[float, float]]] = {}
    for file in sorted(folder.glob("*-*.json")):
        if not (folder / file.stem / "run.json").exists():
            continue
        summary = open_run(folder / file.stem).summary
        if not summary["finished"]:
            continue
        test = json.loads(file.read_text(encoding="utf-8"))
        answer = next(row for row in summary["answers"]["rows"] if row["unit"] == "m3/s/m")
        keys = ("value", "low_90", "high_90", "formula_value")
        q, low, high, formula = (1e3 * (np.nan if answer[key] is None else answer[key]) for key in keys)
        height = 1e3 * summary["reflection"]["H_I"]
        errors.setdefault(file.stem.split("-")[0], []).append((q / (1e3 * test["q"]), formula / (1e3 * test["q"])))
        print(
            f"{file.stem:11} {q:8.3f}   {low:.3f} to {high:.3f}   {1e3 * test['q']:8.3f}   {formula:8.3f}   "
            f"{test['rc'] / test['hm0_toe']:.2f}   {height:.0f}, {1e3 * test['hm0_deep']:.0f}   "
            f"{summary['cpu_seconds']:.0f}"
        )
    for kind, pairs in errors.items():
        off = np.log(np.maximum(np.array(pairs), 1e-3))
        near, bias = np.mean(np.abs(off) <= np.log(2), axis=0), np.exp(np.mean(off, axis=0))
        print(
            f"{kind}, {len(pairs)} tests within a factor of two, bias: {near[0]:.0%}, {bias[0]:.2f}; "
            f"EurOtop {near[1]:.0%}, {bias[1]:.2f}"
        )


def main() -> None:
    """Writes the cases, or compares their runs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_subparsers(dest="what", required=True)
    first = what.add_parser("write")
    first.add_argument("kind", choices=("slope", "wall", "mound"))
    first.add_argument("folder", type=Path)
    first.add_argument("--spacing", type=float, default=0.02)
    first.add_argument("--waves", type=int, default=100)
    first.add_argument("--roughness", type=float, help="of slope or wall and foreshore [m]; they slip without")
    what.add_parser("compare").add_argument("folder", type=Path)
    given = parser.parse_args()
    if given.what == "write":
        write(given.kind, given.folder, given.spacing, given.waves, given.roughness)
    else:
        compare(given.folder)


if __name__ == "__main__":
    main()

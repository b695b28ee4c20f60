"""Run-up of solitary waves on 1:19.85, ten of the 77 tests of Synolakis (1987), beside the laboratory.

    python benchmarks/solitary_run_up.py write LAB_RUNUP.txt DIR [--cells 30] [--roughness 0]
    houle run DIR/TEST.toml --out DIR/TEST                       for every TEST that was written
    python benchmarks/solitary_run_up.py compare DIR

LAB_RUNUP.txt has a line `H/d R/d d[cm]` for each test (NTHMP benchmark problem 4). Taken are the tests nearest to ten
heights from 0.005 to 0.6 in equal ratios. A piston (Goring 1979) makes the wave half its length (to 1 % of its
height), or ten depths, before the toe. Cells are a thirtieth of the depth. Repeats of a test differ by 2 to 6 % of R;
waves above H/d = 0.045 break on the slope. The law beside it is R/d = 2.831 sqrt(19.85) (H/d)^(5/4), for waves that do
not break. Target: mean absolute error 6 %.
"""

from __future__ import annotations

import argparse
import json
from math import acosh, sqrt
from pathlib import Path

import numpy as np

from houle import load, open_run

SLOPE, TESTS, LIP = 19.85, 10, 0.01


def law(height: float) -> float:
    """R/d of a wave of H/d that does not break (Synolakis 1987)."""
    return float(2.831 * sqrt(SLOPE) * height**1.25)


def chosen(file: Path) -> list[tuple[float, float, float]]:
    """H/d, R/d and depth [m] of the tests."""
    table = np.loadtxt(file, comments="#")
    nearest = [int(np.argmin(np.abs(np.log(table[:, 0] / h)))) for h in np.geomspace(0.005, 0.6, TESTS)]
    return [(float(h), float(r), 0.01 * float(d)) for h, r, d in table[nearest]]


def case(height: float, depth: float, cells: int, roughness: float | None) -> dict[str, object]:
    """The flume of a test: piston, level bed, slope up to 1.5 times the run-up of the law, 1.2 depths at most."""
    spacing = depth / cells
    half = acosh(1 / sqrt(LIP)) / sqrt(0.75 * height) * depth
    stroke = 4 * sqrt(height / 3) * depth
    rest = spacing * round((0.7 * stroke + 6 * spacing) / spacing)
    toe = rest + max(half, 10 * depth) + stroke / 2
    top = depth * (1 + min(1.5 * law(height), 1.2) + 0.1)
    end = toe + SLOPE * top
    speed = sqrt(9.81 * depth * (1 + height))
    time = (2.5 * half + (toe - rest) + (2.2 * SLOPE + 40) * depth) / speed
    slope = {"name": "slope", "polygon": [[toe, 0.0], [end, 0.0], [end, top]]}
    return {
        "case": {"name": f"run-up-{height:g}", "title": f"Solitary wave, H/d = {height:g}, on 1:{SLOPE}"},
        "domain": {"size": [end, spacing * round(max(top + 4 * spacing, depth * (1 + 1.8 * height)) / spacing)]}
        | {"spacing": spacing},
        "water": [{"polygon": [[rest, 0.0], [toe, 0.0], [toe + SLOPE * depth, depth], [rest, depth]]}],
        "waves": {"kind": "solitary", "height": height * depth, "depth": depth, "piston": {"x": rest}},
        "solid": [slope if roughness is None else slope | {"roughness": roughness}],
        "gauge": [{"name": "toe", "x": toe - depth}],
        "runup": [{"name": "shore", "x": [toe + 0.5 * SLOPE * depth, end]}],
        "time": {"end": time},
        "output": {"every": time / 20, "series_every": time / 1000},
    }


def write(file: Path, folder: Path, cells: int, roughness: float | None) -> None:
    """Writes a case file for each test, and the test beside it."""
    folder.mkdir(parents=True, exist_ok=True)
    for height, found, depth in chosen(file):
        name = f"run-up-{height:g}"
        text = load(case(height, depth, cells, roughness)).to_toml()
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
        (folder / f"{name}.json").write_text(json.dumps([height, found, depth]), encoding="utf-8")


def compare(folder: Path) -> None:
    """Prints a row for each run that has ended, and the mean error of all."""
    print("H/d     at the toe  R/d     laboratory  off     law")
    errors = []
    for file in sorted(folder.glob("run-up-*.json"), key=lambda file: float(file.stem.split("-")[-1])):
        if not (folder / file.stem / "run.json").exists():
            continue
        run = open_run(folder / file.stem)
        if not run.summary["finished"]:
            continue
        height, found, depth = json.loads(file.read_text(encoding="utf-8"))
        level = float(np.nanmax(run.series["runup_level"].values)) / depth - 1
        crest = float(np.nanmax(run.series["eta"].values)) / depth - 1
        off = level / found - 1
        errors.append(abs(off))
        print(f"{height:5g}   {crest:8.4f}    {level:6.4f}  {found:6.3f}  {100 * off:+8.1f} %  {law(height):6.3f}")
    print(f"mean absolute error {100 * np.mean(errors):.1f} % of {len(errors)} tests")


def main() -> None:
    """Writes the cases, or compares their runs."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    what = parser.add_subparsers(dest="what", required=True)
    first = what.add_parser("write")
    first.add_argument("file", type=Path)
    first.add_argument("folder", type=Path)
    first.add_argument("--cells", type=int, default=30)
    first.add_argument("--roughness", type=float, help="of the slope [m]; it slips without")
    what.add_parser("compare").add_argument("folder", type=Path)
    given = parser.parse_args()
    if given.what == "write":
        write(given.file, given.folder, given.cells, given.roughness)
    else:
        compare(given.folder)


if __name__ == "__main__":
    main()

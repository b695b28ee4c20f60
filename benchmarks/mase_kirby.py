"""Irregular waves that break on 1:20, run 2 of Mase & Kirby (1992), beside the laboratory; the record is not shipped.

    python benchmarks/mase_kirby.py write RECORD.csv DIR [--order 2] [--begin 20] [--duration 140]
    houle run DIR/case.toml --out DIR/run
    python benchmarks/mase_kirby.py compare RECORD.csv DIR

RECORD.csv has the columns time [s] and h470, h350 ... h025 [m], the gauges by their still depth [mm]. The piston stands
1.5 m in front of the toe and sends what was recorded there, from one zero crossing of the level to another. Per gauge:
Hm0 above 0.3 Hz and below [mm], and skewness of the level, of the run and of the laboratory over the same time.
Targets: Hm0 within 5 % down to 50 mm of water, below 0.3 Hz within 20 %, skewness within 0.1.
"""

from __future__ import annotations

import argparse
import io
from pathlib import Path

import numpy as np

from houle import Run
from houle.grid import FloatArray

DEPTH, TOE = 0.47, 2.3  # m
DEPTHS = (470, 350, 300, 250, 200, 175, 150, 125, 100, 75, 50, 25)  # mm
SPLIT = 0.3  # Hz: slower is infragravity
SETTLED = 15.0  # s after which waves have come to the last gauge
CASE = """[case]
name = "mase-kirby"
title = "Irregular waves breaking on 1:20 (Mase & Kirby 1992, run 2)"

[domain]
size = [13.9, 0.66]
spacing = 0.02

[[water]]
below = 0.47

[[solid]]
name = "slope"
polygon = [[2.3, 0.0], [13.9, 0.0], [13.9, 0.58]]

[waves]
kind = "series"
file = "toe.csv"
depth = 0.47
order = {order}
piston = {{x = 0.8, absorb = true}}

[time]
end = {end}

[output]
every = 10.0
series_every = 0.05
"""


def recorded(file: Path) -> dict[str, FloatArray]:
    """The columns of the record by their names."""
    lines = [line for line in file.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    table = np.genfromtxt(io.StringIO("\n".join(lines)), delimiter=",", names=True)
    return {str(name): table[name] for name in table.dtype.names}


def write(file: Path, folder: Path, order: int, begin: float, duration: float) -> None:
    """Writes the case and the record at its toe, without its mean, from a zero crossing on."""
    record = recorded(file)
    time, eta = record["time"], record["h470"] - record["h470"].mean()
    crossings = np.flatnonzero(eta[:-1] * eta[1:] <= 0)
    first, last = (crossings[np.argmin(np.abs(time[crossings] - t))] for t in (begin, begin + duration))
    piece, eta = slice(first, last + 1), eta - eta[first : last + 1].mean()
    folder.mkdir(parents=True, exist_ok=True)
    rows = [f"{t - time[first]:.2f},{v:.5f}" for t, v in zip(time[piece], eta[piece], strict=True)]
    head = [f"# Mase & Kirby (1992), run 2, from {time[first]:.2f} s on; error 0.2 mm", "t_s,eta_m"]
    (folder / "toe.csv").write_text("\n".join([*head, *rows]) + "\n", encoding="utf-8")
    gauges = [f'\n[[gauge]]\nname = "h{d:03d}"\nx = {TOE + (470 - d) * 0.02:.2f}\n' for d in DEPTHS]
    text = CASE.format(order=order, end=float(time[last] - time[first]) - 2.0) + "".join(gauges)
    (folder / "case.toml").write_text(text, encoding="utf-8")


def numbers(time: FloatArray, eta: FloatArray) -> tuple[float, float, float]:
    """Hm0 above the split [mm], Hm0 below it [mm] and skewness [-] of a level [m]."""
    even, wet = np.arange(time[0], time[-1], 0.05), np.isfinite(eta)
    level = np.interp(even, time[wet], eta[wet])
    level -= level.mean()
    lines, f = np.fft.rfft(level), np.fft.rfftfreq(len(level), 0.05)
    parts = [np.fft.irfft(np.where(keep, lines, 0), len(level)).std() for keep in (f >= SPLIT, f < SPLIT)]
    return 4e3 * float(parts[0]), 4e3 * float(parts[1]), float(np.mean(level**3) / level.std() ** 3)


def compare(file: Path, folder: Path) -> None:
    """Prints the numbers of the run and of the laboratory at each gauge."""
    record, run = recorded(file), Run(folder / "run")
    begin = float((folder / "toe.csv").read_text(encoding="utf-8").split("from ")[1].split(" s")[0])
    time = run.series.time.values
    kept = time > SETTLED
    print(f"{SETTLED:g} to {time[-1]:.4g} s\ndepth   Hm0 [mm]     below 0.3 Hz   skewness     (run, laboratory)")
    for depth in DEPTHS:
        mine = numbers(time[kept], run.series.eta.sel(gauge=f"h{depth:03d}").values[kept] - DEPTH)
        lab = (record["time"] >= begin + SETTLED) & (record["time"] <= begin + time[-1])
        known = numbers(record["time"][lab], record[f"h{depth:03d}"][lab])
        pairs = [f"{a:6.2f} {b:6.2f}" for a, b in zip(mine, known, strict=True)]
        print(f"{depth:4d}   {'   '.join(pairs)}")


def main() -> None:
    """Writes the case, or compares its run."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=("write", "compare"))
    parser.add_argument("record", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--order", type=int, choices=(1, 2), default=2)
    parser.add_argument("--begin", type=float, default=20.0)
    parser.add_argument("--duration", type=float, default=140.0)
    given = parser.parse_args()
    if given.what == "write":
        write(given.record, given.folder, given.order, given.begin, given.duration)
    else:
        compare(given.record, given.folder)


if __name__ == "__main__":
    main()

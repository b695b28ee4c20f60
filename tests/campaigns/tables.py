"""Spoiled tables and records: each is read, or refused by an error of ours, within LONGEST seconds.

    python tests/campaigns/tables.py --inputs 10000 --seed 1

An input is a table as a laboratory might write it, spoiled in up to three ways. It goes through houle.analysis.read_csv
and what follows it, or through the reader of the case file's own tables. The seed and the number of an input make it
again: --first N --inputs 1.
"""

from __future__ import annotations

import argparse
import random
import sys
import tempfile
import time
import traceback
import warnings
from pathlib import Path

import numpy as np
import scipy.optimize
import scipy.signal  # noqa: F401
import xarray  # noqa: F401  (what is imported late is no hang of an input)

from houle import analysis
from houle.case.tables.waves import Waves
from houle.case.wave import read_record
from houle.data import csv_table, laboratory
from houle.errors import HouleError

LONGEST = 2.0  # s
WORDS = [
    "abc",
    "",
    "NaN",
    "-9999",
    "1e400",
    "1,2,3",
    "1.2.3",
    "--",
    "#N/A",
    "0x1p3",
    "1_0",
    "12:00:00",
    "2024-13-45",
    "٣",
    "−1.5",
    "1D+02",
    "inf",
    '"',
    "'",
    "=A1",
    "-",
    "9" * 400,
    "\t",
    ";",
    "\x0b",
    "\x1c",
    "\x85",
    " ",
    "(",
    "[mm",
]
NAMES = [
    "W1",
    "W1 [mm]",
    "x=1.5",
    "x=150cm",
    "eta_m",
    "t_s",
    "Höhe",
    "",
    "1",
    "W [furlong]",
    "P [kPa]",
    "a/b",
    "[",
    "x=",
    "Comment",
    "Time",
    "t (ms)",
    "Zeit [s]",
    "x",
    "W(1)",
    "%",
    "{}",
    "s",
    "mm",
    "Date",
]
MARKS = [",", ";", "\t", " ", "  ", "|", ", ", ",,"]


def table(rng: random.Random) -> bytes:
    """The bytes of a file: lines above, names, units, rows; then spoiled."""
    mark, columns, rows = rng.choice(MARKS), rng.randint(1, 6), rng.choice([0, 1, 2, 3, 5, 30, 200])
    comma, step = rng.random() < 0.3, rng.choice([0.01, 0.5, 1.0, 1e-9, 1e9])
    lines = [
        rng.choice(
            [
                "# a comment",
                "Flume 3, run 2",
                "# x: 1.0, 1.35, 1.9",
                "LabVIEW Measurement",
                "",
                "x [mm];1;2",
                "Delta_X\t0.01",
                "***End_of_Header***",
            ]
        )
        for _ in range(rng.choice([0, 0, 1, 4]))
    ]
    if rng.random() < 0.8:
        lines.append(mark.join(["t_s" if rng.random() < 0.5 else rng.choice(NAMES), *rng.choices(NAMES, k=columns)]))
    if rng.random() < 0.2:
        lines.append(mark.join(["s", *rng.choices(["mm", "[cm]", "m", "V", ""], k=columns)]))
    kind = rng.choice(["time", "time", "time", "date", "clock", "none"])
    for i in range(rows):
        first = {
            "time": f"{i * step:.10g}",
            "date": f"2024-03-01 23:59:{i % 60:02d}",
            "clock": f"12:{i % 60:02d}:00.5",
            "none": f"{rng.gauss(0, 1):.4f}",
        }[kind]
        cells = [first, *(f"{0.1 * np.sin(0.7 * i + c):.6g}" for c in range(columns))]
        lines.append(mark.join(cell.replace(".", ",") if comma else cell for cell in cells))
    for _ in range(rng.choice([0, 0, 1, 2, 3])):
        lines = spoiled_lines(rng, lines, mark)
    text = rng.choice(["\n", "\n", "\r\n", "\r"]).join(lines) + rng.choice(["", "\n", "\n\n"])
    data = text.encode(rng.choice(["utf-8", "utf-8", "utf-8-sig", "utf-16", "cp1252", "latin-1"]), errors="replace")
    return spoiled_bytes(rng, data) if rng.random() < 0.2 else data


def spoiled_lines(rng: random.Random, lines: list[str], mark: str) -> list[str]:
    """One line changed, or their order."""
    if not lines:
        return [rng.choice(WORDS)]
    i, way = rng.randrange(len(lines)), rng.randrange(9)
    cells = lines[i].split(mark)
    if way == 0:
        cells[rng.randrange(len(cells))] = rng.choice(WORDS)
    elif way == 1:
        cells.append(rng.choice(WORDS))
    elif way == 2:
        cells.pop()
    elif way == 3:
        return [*lines[:i], *lines[i + 1 :]]
    elif way == 4:
        return [*lines[:i], lines[i], *lines[i:]]
    elif way == 5:
        return [*lines[:i], rng.choice(WORDS + NAMES), *lines[i:]]
    elif way == 6:
        return rng.sample(lines, len(lines))
    elif way == 7:
        return [line + mark * rng.randint(1, 3) for line in lines]
    else:
        cells = [rng.choice(WORDS) for _ in cells]
    return [*lines[:i], mark.join(cells), *lines[i + 1 :]]


def spoiled_bytes(rng: random.Random, data: bytes) -> bytes:
    """Cut, flipped, filled or repeated."""
    at, way = rng.randrange(len(data) + 1), rng.randrange(5)
    if way == 0:
        return data[:at]
    if way == 1:
        return data[:at] + bytes(rng.randrange(256) for _ in range(rng.choice([1, 4, 64]))) + data[at:]
    if way == 2:
        return data[:at] + b"\0" * 8 + data[at:]
    if way == 3:
        return data[:at] + b"7" * rng.choice([100, 2_000_000]) + data[at:]
    return rng.randbytes(rng.choice([1, 100, 5000]))


def spoiled_record(rng: random.Random) -> tuple[np.ndarray, np.ndarray]:
    """Times and levels of two gauges with holes, codes, jumps."""
    n = rng.choice([0, 1, 2, 5, 64, 400])
    t = np.arange(n) * rng.choice([0.05, 1.0])
    eta = np.array([0.02 * np.cos(4 * t + p) for p in (0.0, 0.7)])
    for _ in range(rng.choice([0, 1, 2, 3])):
        if not n:
            break
        i, way = rng.randrange(n), rng.randrange(9)
        j = min(n, i + rng.choice([1, 5, 100]))
        if way == 0:
            eta[0, i:j] = np.nan
        elif way == 1:
            eta[1, i:j] = rng.choice([-9999.0, 99.99, np.inf, 1e300, -np.inf, 0.0])
        elif way == 2:
            t[i] = rng.choice([np.nan, np.inf, -1.0, 1e300, t[0]])
        elif way == 3:
            t = np.delete(t, slice(i, j))
            eta = np.delete(eta, slice(i, j), axis=1)
            n = len(t)
        elif way == 4:
            t = t[::-1].copy()
        elif way == 5:
            t = np.array(sorted(rng.random() * 20 for _ in range(n)))
        elif way == 6:
            eta *= rng.choice([0.0, 1e-300, 1e200])
        elif way == 7:
            t = np.round(t, 1)
        else:
            t[i:] += 100.0
    return t, eta


def read_everything(file: Path, rng: random.Random) -> None:
    """What houle does with a file. Raises errors of ours, or what must not be."""
    way = rng.randrange(5)
    if way == 0:
        laboratory.read(file)
    elif way == 1:
        read_record(Waves(kind="series", file=str(file), depth=1.0, zone={"x": (0.0, 1.0)}))
    elif way == 2:
        csv_table.columns_in(file, ("velocity_m_s", "level_m"), "open.left.file")
        csv_table.read_columns(file, ("t_s", "level_m"), "open.left.file")
    else:
        data = analysis.read_csv(file, rng.choice([None, [0.5], [0.5, 1.0], [0.0, 0.31, 0.55]]))
        analyse(data.time.values, data.eta.values, rng)


def analyse(t: np.ndarray, eta: np.ndarray, rng: random.Random) -> None:
    """One of the functions of houle.analysis on a record."""
    way = rng.randrange(6)
    if way == 0:
        analysis.spectrum(t, eta[0])
    elif way == 1:
        analysis.zero_crossing(t, eta[0])
    elif way == 2:
        analysis.find_omega(t, eta)
    elif way == 3:
        analysis.run_up(t, eta[0])
    else:
        x = 0.3 * np.arange(len(eta))
        given = {"kind": "irregular"} if way == 4 else {"period": rng.choice([None, 1.5707963, 1.6, 0.5])}
        analysis.reflection((t, x, eta), depth=0.25, window=rng.choice([(0, 1e9), (1.0, 9.0)]), **given)


def attempt(seed: int, number: int, folder: Path) -> tuple[str, float]:
    """What went wrong with an input, "" if nothing, and the seconds of processor time it took."""
    rng = random.Random(f"{seed} {number}")
    start = time.process_time()
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            if rng.random() < 0.75:
                file = folder / "input.csv"
                file.write_bytes(table(rng))
                start = time.process_time()
                read_everything(file, rng)
            else:
                analyse(*spoiled_record(rng), rng)
    except HouleError:
        pass
    except Exception:
        return f"input {number}: {traceback.format_exc()}", time.process_time() - start
    took = time.process_time() - start
    return (f"input {number}: {took:.1f} s" if took > LONGEST else ""), took


def campaign(inputs: int, seed: int, first: int = 0) -> list[str]:
    """What went wrong with so many inputs."""
    with tempfile.TemporaryDirectory() as folder:
        return [wrong for n in range(first, first + inputs) if (wrong := attempt(seed, n, Path(folder))[0])]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--inputs", type=int, default=10000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    options = parser.parse_args()
    wrong = campaign(options.inputs, options.seed, options.first)
    print(*wrong, sep="\n")
    print(f"{options.inputs} inputs, {len(wrong)} of them wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

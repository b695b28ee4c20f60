"""Case files that nobody would write: each is read and looked at, or refused with a CaseError, within two seconds.

    python tests/campaigns/case_files.py --files 10000 --seed 1

Shipped cases and the two templates are mutated, as text and as tables; other files are made of random keys and values.
Each goes the way of `houle check`, one in fifty with its picture. What ends in another exception, or takes more than
LIMIT seconds of processor time (or a minute by the clock, for what waits and does not compute), is a fault of ours: it
is printed, kept in --keep, and the status is 1. File number i of a seed is the same on every machine.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import sys
import tempfile
import traceback
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from math import exp
from pathlib import Path
from typing import Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

from houle.case import new, reading
from houle.case.model import Case, load
from houle.check import cost, drag, gauges, report, rules
from houle.check.report import open_rows
from houle.errors import CaseError
from houle.output.section import draw

LIMIT, CLOCK = 2.0, 60.0  # s of processor time for a file, of waiting
DRAWN = 50  # one file in so many is drawn

NUMBERS = (0, 1, -1, 2, 0.1, 0.5, 1e-9, 1e-30, 1e9, 1e30, 1e300, -1e300, 5e-324, 10**30, -(10**30), float("inf"),
           float("nan"), True, False)  # fmt: skip
WORDS = ("", " ", "a", "regular", "solitary", "series", "focused", "jonswap", "left", "periodic", "slip", "no-slip",
         "van-gent-1995", "\0", "a\0b", "\x1b[31m", "ü€𝔘", "[bold]", "$x", "../..", "/", ".", "a" * 5000, "/dev/zero",
         "/dev/null", "fifo", "folder", "data/record.csv", "no.csv", "binary.csv", "nan")  # fmt: skip
KEYS = tuple(Case.model_fields)


class Hang(BaseException):
    """Taken too long; no `except Exception` of the program catches it."""


def seeds() -> list[str]:
    """Texts of the shipped cases and of the templates."""
    shipped = [(reading.SHIPPED / name / "case.toml").read_text(encoding="utf-8") for name in reading.shipped()]
    return [*shipped, *(t.read_text(encoding="utf-8").format(name="new") for t in (new.DAM_BREAK, new.WAVES))]


def any_value(draw: random.Random, depth: int = 0) -> Any:
    kind = draw.random()
    if kind < 0.35:
        return draw.choice(NUMBERS)
    if kind < 0.5:
        return draw.uniform(-2, 12)
    if kind < 0.75 or depth > 3:
        return draw.choice(WORDS)
    if kind < 0.9:
        return [any_value(draw, depth + 1) for _ in range(draw.randrange(5))]
    return {draw.choice((*KEYS, *WORDS)): any_value(draw, depth + 1) for _ in range(draw.randrange(4))}


def places(tables: Any) -> list[tuple[Any, Any]]:
    """(container, key) of everything inside."""
    inside = tables.items() if isinstance(tables, dict) else enumerate(tables) if isinstance(tables, list) else ()
    return [pair for key, value in list(inside) for pair in [(tables, key), *places(value)]]


def change_tables(tables: dict[str, Any], draw: random.Random) -> dict[str, Any]:
    """One to four values replaced, scaled, taken away, doubled or moved."""
    for _ in range(draw.randrange(1, 5)):
        there = places(tables)
        if not there:
            return tables
        holder, key = draw.choice(there)
        value, way = holder[key], draw.random()
        if way < 0.35 and isinstance(value, int | float):
            holder[key] = value * draw.choice((0, -1, 0.1, 0.5, 0.99, 1.01, 2, 10, 1000, 1e-6))
        elif way < 0.7:
            holder[key] = any_value(draw)
        elif way < 0.8:
            del holder[key]
        elif way < 0.9 and isinstance(holder, list):
            holder.append(value)
        else:
            other, place = draw.choice(there)
            if isinstance(other, dict):
                other[draw.choice((place, draw.choice(KEYS)))] = any_value(draw)
    return tables


def change_text(text: str, draw: random.Random) -> bytes:
    """One to six lines or letters lost, doubled, moved or spoiled."""
    data = bytearray(text.encode())
    for _ in range(draw.randrange(1, 7)):
        i = draw.randrange(len(data) + 1)
        way = draw.random()
        if way < 0.3:
            del data[i : i + draw.choice((1, 1, 2, 5, 80))]
        elif way < 0.6:
            data[i:i] = draw.choice(
                (b"[", b"]", b"{", b"=", b'"', b"\n", b"0", b"-", b".", b"e9", b"\0", b"\xff", b"#")
            )
        elif way < 0.8:
            lines = bytes(data).split(b"\n")
            j, k = draw.randrange(len(lines)), draw.randrange(len(lines))
            lines.insert(k, lines[j])
            data = bytearray(b"\n".join(lines))
        elif data:
            data[min(i, len(data) - 1)] = draw.randrange(256)
    return bytes(data)


def random_file(draw: random.Random) -> dict[str, Any]:
    """Tables of keys that exist, of values that come as they like."""
    tables: dict[str, Any] = {
        "case": {"name": "a"}, "domain": {"size": [4.0, 0.5], "spacing": 0.05}, "water": [{"below": 0.3}],
        "time": {"end": 1.0},
    }  # fmt: skip
    for _ in range(draw.randrange(1, 8)):
        key = draw.choice(KEYS)
        model = Case.model_fields[key].annotation
        names = [name for m in _models(model) for name in m.model_fields]
        row = {name: any_value(draw) for name in names if draw.random() < 0.4}
        many = "tuple" in str(model)
        tables[key] = [row] * draw.randrange(1, 3) if many else row
    return tables


def _models(kind: Any) -> Iterator[Any]:
    if hasattr(kind, "model_fields"):
        yield kind
    for inside in getattr(kind, "__args__", ()):
        yield from _models(inside)


def file(number: int, seed: int, texts: list[str]) -> bytes | dict[str, Any]:
    """The file of this number: bytes of a text, or tables."""
    draw = random.Random(f"{seed}/{number}")
    way = draw.random()
    if way < 0.25:
        return change_text(draw.choice(texts), draw)
    if way < 0.85:
        return change_tables(tomllib.loads(draw.choice(texts)), draw)
    return random_file(draw)


def look(source: Path | dict[str, Any], picture: Path | None) -> None:
    """What `houle check` does, without the terminal."""
    case = load(source)
    rules.require(case)
    gauges.steady(case)
    for rows in (report.wave_rows, report.absorber_rows, report.sponge_rows, open_rows):
        rows(case)
    drag.drag_sheets(case)
    cost.price(case)
    case.to_toml()
    if picture is not None:
        draw(case, picture)


@contextmanager
def limited(seconds: float) -> Iterator[None]:
    def stop(*_: Any) -> None:
        raise Hang(f"more than {seconds:g} s")

    old = [signal.signal(number, stop) for number in (signal.SIGPROF, signal.SIGALRM)]
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, CLOCK)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.setitimer(signal.ITIMER_REAL, 0)
        for number, handler in zip((signal.SIGPROF, signal.SIGALRM), old, strict=True):
            signal.signal(number, handler)


def try_one(content: bytes | dict[str, Any], folder: Path, drawn: bool) -> str | None:
    """None, or what went wrong. Tables go through a file if TOML can hold them, else as they are."""
    source: Path | dict[str, Any] = folder / "case.toml"
    if isinstance(content, bytes):
        (folder / "case.toml").write_bytes(content)
    else:
        try:
            text = reading.to_toml(content)
            tomllib.loads(text)
            (folder / "case.toml").write_text(text, encoding="utf-8")
        except Exception:  # no file could hold it: tables may be given all the same
            source = content
    try:
        with limited(LIMIT), warnings.catch_warnings():
            warnings.simplefilter("ignore")
            look(source, folder / "section.png" if drawn else None)
    except CaseError as error:
        return None if str(error).strip() else "a CaseError without words"
    except Hang as hang:
        return f"{hang}\n{traceback.format_exc(limit=-4)}"
    except Exception:
        return traceback.format_exc(limit=-6)
    return None


def furnish(folder: Path) -> None:
    """Files that the mutations name."""
    (folder / "data").mkdir()
    (folder / "folder").mkdir()
    rows = "".join(f"{t / 10:g},{-0.1 * exp(-((t / 10 - 15) ** 2) / 20):.5f}\n" for t in range(300))
    (folder / "data" / "record.csv").write_text(f"t_s,eta_m\n{rows}")
    for name in ("surface.csv",):
        shutil.copy(reading.SHIPPED / "dam-break-rock-35" / "data" / name, folder / "data")
    (folder / "binary.csv").write_bytes(bytes(range(256)) * 4)
    os.mkfifo(folder / "fifo")


def campaign(files: int, seed: int, keep: Path | None = None, say: Callable[[str], None] = print) -> int:
    """Number of faults found in so many files."""
    texts, faults = seeds(), 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        furnish(folder)
        for number in range(files):
            content = file(number, seed, texts)
            wrong = try_one(content, folder, number % DRAWN == 0)
            if wrong is None:
                continue
            faults += 1
            say(f"file {number} of seed {seed}: {wrong}")
            if keep is not None:
                keep.mkdir(parents=True, exist_ok=True)
                data = content if isinstance(content, bytes) else repr(content).encode(errors="backslashreplace")
                (keep / f"{seed}-{number}{'.toml' if isinstance(content, bytes) else '.py'}").write_bytes(data)
    say(f"{files} files of seed {seed}: {faults} faults")
    return faults


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--files", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder for the files that show a fault")
    asked = parser.parse_args()
    return min(1, campaign(asked.files, asked.seed, asked.keep))


if __name__ == "__main__":
    sys.exit(main())

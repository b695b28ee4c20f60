"""`houle bench`: the speed of the solver on this machine, operation by operation, beside its memory bandwidth.

Every measurement runs several times, with one and with all threads in turn, and each time in a process of its own, so
that it does not find memory and caches as the one before left them. All runs do bitwise the same, and other programs on
the machine can only make them slower: so the fastest time of each step, and of each operation in it, counts (`least`).
The time of the fastest run as a whole is given as well. One measurement is

    python -m houle.bench '{"case": "dam-break-rock-35", "overrides": {}, "threads": 1, "warm": 20, "steps": 200}'

which prints one line of JSON (`Measured`). The same process measures the memory bandwidth right after the steps, with
the triad a = b + s c on large arrays.
"""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, replace
from time import perf_counter, process_time
from typing import Any

DOUBLE = 8  # bytes
TRIAD_LENGTH = 1 << 23  # doubles per array: 64 MB, more than caches hold
TRIAD_BLOCK = 1 << 16  # doubles per block: few enough to stay in a cache, enough to forget the interpreter


@dataclass(frozen=True)
class Job:
    """A measurement: the time of `steps` steps of a case after `warm` others, taken `times` times."""

    title: str
    case: str
    overrides: dict[str, Any]
    warm: int
    steps: int
    times: int


JOBS = (Job("2D, dam break through rock, spacing 5 mm", "dam-break-rock-35", {"domain.spacing": 0.005}, 40, 200, 10),)
LARGE = (
    Job("2D, the same at 0.67 mm", "dam-break-rock-35", {"domain.spacing": 0.00067}, 5, 20, 3),
    Job("3D, dam break on a block (SPHERIC 2)", "spheric-2", {"domain.spacing": 0.0175}, 5, 15, 3),
)


@dataclass(frozen=True)
class Measured:
    """The result of one measurement.

    walls, cpus      elapsed time and CPU time of every step [s]
    operations       elapsed time of each operation in every step [s]
    iterations       mean per step of the pressure solver and of that of the position correction
    memory           peak of the memory of the process beyond that of the program [bytes]; None where unknown
    stepping         the same while stepping, without the set-up
    triad            memory bandwidth [bytes/s]
    """

    threads: int
    dimension: int
    particles: int
    cells: int
    walls: list[float]
    cpus: list[float]
    operations: dict[str, list[float]]
    iterations: tuple[float, float]
    memory: float | None
    stepping: float | None
    triad: float

    def microseconds(self, seconds: Sequence[float]) -> float:
        """Time per particle and step [us], from the seconds of every step."""
        return 1e6 * sum(seconds) / (len(seconds) * self.particles)

    @property
    def steps_per_second(self) -> float:
        return len(self.walls) / sum(self.walls)

    @property
    def traffic(self) -> float:
        """Estimated memory traffic [bytes/s], see least_traffic."""
        return self.steps_per_second * least_traffic(self.dimension, self.particles, self.cells, self.iterations)


def least(runs: Sequence[Measured]) -> Measured:
    """The least times of every step, and of every operation in it, among several runs of one job."""

    def each(seconds: Iterable[list[float]]) -> list[float]:
        return [min(times) for times in zip(*seconds, strict=True)]

    return replace(
        runs[0],
        walls=each(run.walls for run in runs),
        cpus=each(run.cpus for run in runs),
        operations={name: each(run.operations[name] for run in runs) for name in runs[0].operations},
        triad=max(run.triad for run in runs),
    )


def bench(threads: int | None = None, large: bool = False) -> list[list[Measured]]:
    """Measures on 1 and on `threads` threads (all cores if not given), prints a table per job, returns the numbers."""
    from rich.console import Console

    from houle.running.cores import usable

    console, most = Console(), threads or usable()
    found = []
    for job in JOBS + (LARGE if large else ()):
        runs: dict[int, list[Measured]] = {count: [] for count in (1, most)}
        for _ in range(job.times):
            for count, those in runs.items():
                with console.status(f"{job.title}: {count} thread{'s' if count > 1 else ''}"):
                    those.append(measure_apart(job, count))
        rows = [least(those) for those in runs.values()]
        show(job, rows, [min((run.walls for run in those), key=sum) for those in runs.values()], console)
        found.append(rows)
    if not large:
        console.print("A million particles in 2D and 3D: houle bench --large", highlight=False)
    return found


def show(job: Job, rows: Sequence[Measured], fastest: Sequence[Sequence[float]], console: Any) -> None:
    """Prints a table: time per particle and step by operation, memory, bandwidth; a column per number of threads.

    rows     results by number of threads, `least` of the runs
    fastest  the seconds of every step in the fastest run, by number of threads
    """
    from rich.table import Table

    first = rows[0]
    title = f"{job.title}: {first.particles} particles, {first.cells} cells, {len(first.walls)} steps"
    table = Table(title=title, title_justify="left")
    table.add_column("us per particle and step")
    for row in rows:
        table.add_column(f"{row.threads} thread{'s' if row.threads > 1 else ''}", justify="right")
    table.add_column("faster", justify="right")

    def compare(name: str, seconds: Sequence[Sequence[float]]) -> None:
        values = [row.microseconds(of_a_row) for row, of_a_row in zip(rows, seconds, strict=True)]
        table.add_row(name, *(f"{v:.3f}" for v in values), ratio(values[0], values[-1]))

    for name in sorted(first.operations, key=lambda name: sum(first.operations[name]), reverse=True):
        compare(name, [row.operations[name] for row in rows])
    table.add_section()
    compare("a step", [row.walls for row in rows])
    compare("in the fastest run", fastest)
    table.add_row("CPU time of a step", *(f"{row.microseconds(row.cpus):.3f}" for row in rows), "")
    table.add_row("steps per second", *(f"{row.steps_per_second:.3g}" for row in rows), "")
    for name, k in (("iterations, pressure", 0), ("iterations, correction", 1)):
        table.add_row(name, *(f"{row.iterations[k]:.1f}" for row in rows), "")
    for name, memory in (
        ("bytes of memory per particle, stepping", [row.stepping for row in rows]),
        ("with the set-up", [row.memory for row in rows]),
    ):
        each = ("-" if m is None else f"{m / row.particles:.0f}" for m, row in zip(memory, rows, strict=True))
        table.add_row(name, *each, "")
    table.add_row("memory traffic, at least [GB/s]", *(f"{row.traffic / 1e9:.1f}" for row in rows), "")
    table.add_row("triad in the same process [GB/s]", *(f"{row.triad / 1e9:.1f}" for row in rows), "")
    console.print(table, "")


def ratio(one: float, many: float) -> str:
    """The factor by which many threads are faster than one, in words; the arguments are times."""
    return f"{one / many:.2f} x" if many > 0 else "-"


def measure_apart(job: Job, threads: int) -> Measured:
    """Calls measure() in a process of its own."""
    order = {k: v for k, v in asdict(job).items() if k not in ("title", "times")} | {"threads": threads}
    command = [sys.executable, "-m", "houle.bench", json.dumps(order)]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True)
    data = json.loads(done.stdout.splitlines()[-1])
    return Measured(**{**data, "iterations": tuple(data["iterations"])})


def measure(case: str, overrides: dict[str, Any], threads: int, warm: int, steps: int) -> Measured:
    """Measures steps of a case in this process; writes no files."""
    import numpy as np

    from houle.case.build import build
    from houle.case.model import load
    from houle.flow.simulation import Simulation

    loaded = load(case, overrides)
    before = peak_memory()
    simulation = Simulation(build(loaded), threads)
    setting_up = peak_memory()
    forgotten = forget_peak()
    for _ in range(warm):
        simulation.advance(loaded.time.end)
    iterations, clocks = [], [(perf_counter(), process_time(), dict(simulation.timings))]
    for _ in range(steps):
        simulation.advance(loaded.time.end)
        clocks.append((perf_counter(), process_time(), dict(simulation.timings)))
        notes = simulation.ledger.notes
        iterations.append([notes.get("pressure_iterations", 0.0), notes.get("correction_iterations", 0.0)])
    walls, cpus, timings = zip(*clocks, strict=True)
    mean, after = np.mean(iterations, axis=0), peak_memory()
    stepping = after - before if forgotten and after is not None and before is not None else None
    most = None if before is None or setting_up is None or after is None else max(setting_up, after) - before
    return Measured(
        threads=threads,
        dimension=loaded.dimension,
        particles=len(simulation.particles),
        cells=int(np.prod(simulation.grid.shape)),
        walls=list(np.diff(walls)),
        cpus=list(np.diff(cpus)),
        operations={name: list(np.diff([t.get(name, 0.0) for t in timings])) for name in timings[-1]},
        iterations=(float(mean[0]), float(mean[1])),
        memory=most,
        stepping=stepping,
        triad=triad(threads),
    )


def least_traffic(dimension: int, particles: int, cells: int, iterations: tuple[float, float]) -> float:
    """Bytes that a step moves at least: if caches are perfect within a pass over an array and hold nothing after it.

    Doubles per particle: reading position, velocity and volume is one pass (2 d + 1). Sorting takes three (read, write,
    and the index), the four transfers and surface searches one each, moving and displacing the position two each.
    Doubles per cell: an iteration of the solver goes 4 times over coefficients, unknown and right side (d + 3) on the
    finest level and its multigrid on all levels costs 1/(1 - 2^-d) of that; the other operations pass some 12 (d + 1).
    """
    d, everything = dimension, 2 * dimension + 1
    per_particle = 7 * everything + 4 * d
    per_iteration = 4 * (d + 3) / (1 - 0.5**d)
    return DOUBLE * (particles * per_particle + cells * (sum(iterations) * per_iteration + 12 * (d + 1)))


def triad(threads: int, length: int = TRIAD_LENGTH, repeats: int = 5) -> float:
    """Memory bandwidth [bytes/s]: a = b + s c on arrays larger than the caches, 3 doubles per entry, best of `repeats`.

    It goes in blocks, so that the product, for which NumPy needs a pass of its own, does not leave the cache.
    """
    import numpy as np

    a, b, c = np.zeros(length), np.ones(length), np.full(length, 2.0)

    def part(index: int) -> None:
        for begin in range(index * length // threads, (index + 1) * length // threads, TRIAD_BLOCK):
            block = slice(begin, min(begin + TRIAD_BLOCK, (index + 1) * length // threads))
            np.multiply(c[block], 3.0, out=a[block])
            np.add(a[block], b[block], out=a[block])

    best = float("inf")
    with ThreadPoolExecutor(threads) as pool:
        for _ in range(repeats):
            begin = perf_counter()
            list(pool.map(part, range(threads)))
            best = min(best, perf_counter() - begin)
    return 3 * DOUBLE * length / best


def peak_memory() -> float | None:
    """Largest resident memory of this process since its start or forget_peak() [bytes]; None where it is unknown."""
    try:
        with open("/proc/self/status", encoding="ascii") as status:  # Linux
            return next(1024.0 * float(line.split()[1]) for line in status if line.startswith("VmHWM"))
    except (OSError, StopIteration):
        pass
    try:
        import resource
    except ImportError:  # Windows
        return None
    unit = 1 if sys.platform == "darwin" else 1024
    return float(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * unit)


def forget_peak() -> bool:
    """Lets peak_memory() start anew from the memory in use now. False where the system cannot (all but Linux)."""
    try:
        with open("/proc/self/clear_refs", "w", encoding="ascii") as file:
            file.write("5")
    except OSError:
        return False
    return True


if __name__ == "__main__":
    print(json.dumps(asdict(measure(**json.loads(sys.argv[1])))))

"""Compiles and runs the stress test of parallel loops, tests/stress/loops.cpp, with oneTBB.

    python tests/stress/loops.py                             2, 4 and 16 threads, 20 000 loops in all
    python tests/stress/loops.py --loops 1000000             longer
    python tests/stress/loops.py --sanitize thread           under ThreadSanitizer; or address, undefined

More threads than cores are the point of it, and slow: each number of threads gets a share of the loops that falls
with its square. Exit status 0 if every iteration of every loop ran once, in time and in order.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
from importlib import metadata
from pathlib import Path

SOURCE = Path(__file__).with_suffix(".cpp")
CORE = SOURCE.parents[2] / "core"


def compiler() -> str | None:
    """The C++ compiler: $CXX, else c++, as a path; None where there is none that takes the flags below."""
    return None if os.name == "nt" else shutil.which(os.environ.get("CXX", "c++"))


def onetbb() -> list[str] | None:
    """Flags for the headers and the library of the package tbb-devel; None where it is not installed."""
    try:
        header = next(f for f in metadata.files("tbb-devel") or [] if f.match("include/tbb/task_arena.h"))
    except (metadata.PackageNotFoundError, StopIteration):
        return None
    prefix = Path(header.locate()).resolve().parents[2]
    return [f"-I{prefix / 'include'}", f"-L{prefix / 'lib'}", f"-Wl,-rpath,{prefix / 'lib'}", "-ltbb"]


def build(folder: Path, sanitizer: str | None = None) -> Path:
    """The program, compiled into `folder`, under a sanitizer of the compiler (thread, address, undefined) or none."""
    program, threads = folder / f"loops-{sanitizer or 'plain'}", folder / "threads.o"
    checks = [f"-fsanitize={sanitizer}", "-g"] if sanitizer else []
    told = ["-fno-sanitize=thread", "-DHOULE_THREAD_SANITIZER"] if sanitizer == "thread" else []
    library = onetbb() or ["-ltbb"]  # the system's
    command = [compiler() or "c++", "-O2", "-std=c++20", f"-I{CORE}", "-pthread", *checks]
    source = CORE / "houle" / "exec" / "threads.cpp"
    subprocess.run([*command, *told, "-DHOULE_TBB", *library, "-c", str(source), "-o", str(threads)], check=True)
    subprocess.run([*command, str(SOURCE), str(threads), *library, "-o", str(program)], check=True)
    return program


def shares(loops: int, threads: list[int]) -> dict[int, int]:
    """Loops for each number of threads, at least 100, `loops` in all but for rounding."""
    weight = {n: 1.0 / n**2 for n in threads}
    return {n: max(100, round(loops * weight[n] / sum(weight.values()))) for n in threads}


def run(
    program: Path, threads: int, loops: int, seed: int = 1, timeout: float | None = None
) -> subprocess.CompletedProcess:
    """One run of the program; its one line of output says what was wrong."""
    options = {"TSAN_OPTIONS": "halt_on_error=1:ignore_noninstrumented_modules=1", "UBSAN_OPTIONS": "halt_on_error=1"}
    command = [str(program), str(threads), str(loops), str(seed)]
    return subprocess.run(command, env={**os.environ, **options}, capture_output=True, text=True, timeout=timeout)


def main() -> int:
    """The command line above."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--loops", type=int, default=20_000)
    parser.add_argument("--threads", type=int, nargs="+", default=[2, 4, 16])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--sanitize", choices=["thread", "address", "undefined"])
    wanted = parser.parse_args()
    status = 0
    with tempfile.TemporaryDirectory() as folder:
        program = build(Path(folder), wanted.sanitize)
        for threads, loops in shares(wanted.loops, wanted.threads).items():
            done = run(program, threads, loops, wanted.seed)
            print(done.stdout.strip() or done.stderr, flush=True)
            status = status or abs(done.returncode)
    return status


if __name__ == "__main__":
    sys.exit(main())

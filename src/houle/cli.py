"""The command line. A command reads its arguments, calls one function and sets the exit status, nothing else.

Exit status: 0 done; 1 a target of `validate` was missed; 2 the input is wrong (one message, nothing written); 3 a run
failed; 130 interrupted. Each command imports the modules that it needs when it is called, so that `houle --help`
answers at once.
"""

from __future__ import annotations

import atexit
import functools
import gc
import io
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any, TextIO

import typer

from houle.errors import HouleError, SimulationError

app = typer.Typer(
    help="Waves and dam-break flow through porous structures. CASE is a file, or the name of a shipped case.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

CaseArgument = Annotated[str, typer.Argument(metavar="CASE", help="Case file, or name of a shipped case.")]
Overrides = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Change a key: domain.spacing=0.01. Repeatable.")
]
Threads = Annotated[
    int | None, typer.Option(min=1, help="Threads, at most one per core; all when left out. Results do not change.")
]
Until = Annotated[float | None, typer.Option(help="Stop at this simulated time, in seconds; `houle resume` goes on.")]
Later = Annotated[
    float | None, typer.Option(help="Stop at this simulated time, in seconds; past its end for a run that is finished.")
]


def ending(command: Callable[..., Any]) -> Callable[..., Any]:
    """Makes a command end every error of the user or of a run with one message on standard error and an exit status."""

    @functools.wraps(command)
    def wrapped(*args: Any, **options: Any) -> Any:
        try:
            return command(*args, **options)
        except HouleError as error:
            status, message = 3 if isinstance(error, SimulationError) else 2, str(error)
        except KeyboardInterrupt as stop:
            status, message = 130, str(stop) or "interrupted"
        except OSError as error:
            where = f"{error.filename}: " if error.filename else ""
            status, message = 2, f"{where}{error.strerror or error}"
        typer.echo("houle: " + message.replace("\n", "\n       "), err=True)
        raise typer.Exit(status)

    return wrapped


@app.callback(invoke_without_command=True)
def about(version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False) -> None:
    if version:
        import houle

        typer.echo(f"houle {houle.__version__}")
        raise typer.Exit


@app.command()
@ending
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the case.")],
    waves: Annotated[bool, typer.Option("--waves", help="A flume with waves instead of a dam break.")] = False,
) -> None:
    """Write NAME.toml, a commented case file to start from."""
    from houle.case.new import write

    file = write(name, waves=waves)
    typer.echo(f"{file} written. Next: houle check {file}")


@app.command()
@ending
def check(
    case: CaseArgument,
    overrides: Overrides = None,
    threads: Threads = None,
    picture: Annotated[Path, typer.Option(help="Where the picture of the section goes.")] = Path("section.png"),
    scale: Annotated[
        float | None, typer.Option(help="Compare the pores with those of a prototype that many times as large.")
    ] = None,
) -> None:
    """Look at a case: findings, coefficients, cost, picture of the section. Runs nothing."""
    from houle.case.model import load
    from houle.check import report

    report.show(load(case, _changes(overrides)), picture, threads, scale=scale)


@app.command()
@ending
def run(
    case: CaseArgument,
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Result folder; runs/<case name> when left out.")
    ] = None,
    threads: Threads = None,
    until: Until = None,
    overrides: Overrides = None,
    movie: Annotated[bool, typer.Option("--movie", help="Also make an MP4.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing while it works.")] = False,
) -> None:
    """Compute a case."""
    import houle

    changes = _changes(overrides) | ({"output.movie": True} if movie else {})
    houle.run(case, out=out, threads=threads, until=until, progress=not quiet, overrides=changes)


@app.command()
@ending
def resume(
    directory: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a run.")],
    threads: Threads = None,
    until: Later = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing while it works.")] = False,
) -> None:
    """Go on from the newest good checkpoint, bitwise as if the run had not stopped; past the end with --until."""
    import houle

    houle.resume(directory, threads=threads, until=until, progress=not quiet)


@app.command()
@ending
def describe(
    topic: Annotated[
        str,
        typer.Argument(
            metavar="TOPIC",
            help="resistance | theories | makers | kernels | transfers | remeshing | numerics | fields | formulas | "
            "schema",
        ),
    ],
    name: Annotated[str, typer.Argument(metavar="NAME", help="One design formula, with its inputs.")] = "",
) -> None:
    """Explain the choices a case file offers, and design formulas, with citations; `schema` prints the JSON Schema."""
    from rich.console import Console

    from houle.case.describe import TOPICS, formula
    from houle.case.messages import nearest
    from houle.errors import CaseError
    from houle.registry import choices

    if topic not in TOPICS:
        raise CaseError(f"TOPIC = {topic} is not known.{nearest(topic, TOPICS)} Topics: {', '.join(TOPICS)}")
    if name and topic != "formulas":
        raise CaseError(f"NAME = {name}: only formulas are told one by one. Leave it out to see all {topic}.")
    if name and name not in (known := choices("formula")):
        raise CaseError(f"NAME = {name} is not known.{nearest(name, known)} Formulas: {', '.join(known)}")
    if name:
        formula(Console(), name)
    else:
        TOPICS[topic](Console())


@app.command()
@ending
def validate(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="NAME...", help="Shipped cases; all when left out.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Only the variants that take seconds to minutes.")] = False,
    threads: Threads = None,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Keep runs and tables in this folder; what is done there is not done again."),
    ] = None,
    variants: Annotated[
        list[str] | None,
        typer.Option("--variant", metavar="PATTERN", help="Only variants of such names: 'T-1.5-*'. Repeatable."),
    ] = None,
) -> None:
    """Run shipped cases, print the measured error beside tolerance and peers. Status 1 if one falls short."""
    from houle.running.runner import once
    from houle.validation.engine import validate as compare

    compute = functools.partial(once, threads=threads)
    raise typer.Exit(compare(names, once=compute, quick=quick, out=out, variants=variants))


@app.command()
@ending
def reproduce(
    paper: Annotated[str, typer.Argument(metavar="PAPER", help="jh2020")],
    out: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Folder of runs and page; reproduction-PAPER when left out.")
    ] = None,
    page: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the page here, its figures beside it, not into DIR.")
    ] = None,
    quick: Annotated[bool, typer.Option("--quick", help="The main runs on coarser grids, some minutes.")] = False,
    spacing: Annotated[float | None, typer.Option(help="Grid spacing of all runs, in metres.")] = None,
    only: Annotated[
        list[str] | None, typer.Option(metavar="NAME", help="Only this run; wave-* for several. Repeatable.")
    ] = None,
    threads: Threads = None,
    quiet: Annotated[bool, typer.Option("--quiet", help="Say nothing while it works.")] = False,
) -> None:
    """Compute a paper again: its figures and its table, with what can and what cannot be reproduced.

    Runs that lie finished in DIR are not run again, interrupted ones go on. Status 3 if one failed.
    """
    from houle.reproduction.command import reproduce as compute
    from houle.running.runner import once

    run = functools.partial(once, threads=threads, progress=not quiet)
    wanted: dict[str, Any] = {"quick": quick, "spacing": spacing, "only": only or ()}
    raise typer.Exit(compute(paper, out, once=run, file=page, progress=not quiet, **wanted))


@app.command()
@ending
def bench(
    threads: Threads = None,
    large: Annotated[bool, typer.Option("--large", help="Also with a million particles, 2D and 3D.")] = False,
) -> None:
    """Measure the throughput on this machine, per operation, beside the memory bandwidth it reaches."""
    from houle.bench import bench as measure

    measure(threads=threads, large=large)


def _changes(overrides: list[str] | None) -> dict[str, Any]:
    """The options --set KEY=VALUE as a mapping of keys to values."""
    from houle.case.reading import parse_override

    return dict(parse_override(text) for text in overrides or [])


class Steady(io.TextIOWrapper):
    """Standard output or error that drops the rest where nobody reads it any more (`| head`, a closed terminal)."""

    def write(self, text: str) -> int:
        try:
            return super().write(text)
        except OSError:
            self._drop()
            return len(text)

    def flush(self) -> None:
        try:
            super().flush()
        except OSError:
            self._drop()

    def _drop(self) -> None:
        """Sends the output from now on, and the rest of the buffer, to the null device."""
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, self.fileno())
        os.close(nowhere)


def steady(stream: TextIO | None, number: int) -> TextIO:
    """The stream as a `Steady` one, the null device if it is closed. Letters it cannot encode are replaced.

    number: its file descriptor, 1 or 2.
    """
    if stream is None:
        stream = open(number, "w", encoding="utf-8", errors="replace", closefd=False)  # noqa: SIM115
    if not isinstance(stream, io.TextIOWrapper):
        return stream
    errors = "replace" if number == 1 else "backslashreplace"
    encoding, lines = stream.encoding, stream.line_buffering or number == 2
    return Steady(stream.detach(), encoding=encoding, errors=errors, line_buffering=lines)


def open_descriptors() -> None:
    """Opens the null device as descriptor 0, 1 or 2 where that is closed.

    Otherwise a file of results would get the number, and the messages would be written into it.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free


def main() -> None:
    """Entry point of the command `houle`."""
    gc.set_threshold(250_000)  # imported objects stay: searching them for garbage again and again costs 0.4 s a run
    open_descriptors()
    sys.stdout, sys.stderr = steady(sys.stdout, 1), steady(sys.stderr, 2)
    atexit.register(gc.freeze)  # saves another 0.3 s: at the end the system takes all memory back anyway
    app(prog_name="houle")

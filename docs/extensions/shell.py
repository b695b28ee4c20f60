"""Commands of a page, really run: in a folder of its own, with the houle that builds the site."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
import textwrap
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

WIDTH = 104  # of what is printed, in characters


@dataclass
class Result:
    output: str
    seconds: float


class Shell:
    """A folder in which files are written and commands run, one after another.

    script: what the whole page runs. kept: whether the outcome of an earlier build with the same script will do; if
    not, the folder is emptied.
    """

    def __init__(self, folder: Path, script: str, kept: bool = False) -> None:
        self.folder, self.record = folder, folder / ".record.json"
        self.outcome: dict[str, Any] = {"script": script, "results": []}
        earlier = json.loads(self.record.read_text()) if kept and self.record.is_file() else {}
        self.earlier = earlier.get("results", []) if earlier.get("script") == script else []
        if not self.earlier:
            shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True, exist_ok=True)

    def write(self, name: str, content: str) -> None:
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(content, encoding="utf-8")

    def run(self, commands: str, fails: bool = False) -> Result:
        """What the commands print, standard output and error together. Raises ValueError when one fails.

        fails: the last one is expected to fail, and it is an error if it does not.
        """
        if self.earlier:
            return self._done(Result(**self.earlier.pop(0)))
        start = time.monotonic()
        done = subprocess.run(
            ["bash", "-e", "-c", commands],
            cwd=self.folder,
            env=self._environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            check=False,
        )
        if (done.returncode != 0) is not fails:
            raise ValueError(f"status {done.returncode} of\n{commands}\n{done.stdout}")
        return self._done(Result(done.stdout.rstrip(), time.monotonic() - start))

    def _done(self, result: Result) -> Result:
        self.outcome["results"].append(asdict(result))
        self.record.write_text(json.dumps(self.outcome))
        return result

    def _environment(self) -> dict[str, str]:
        programs = self.folder / ".bin"
        programs.mkdir(parents=True, exist_ok=True)
        for name, module in (("houle", "-m houle "), ("python", "")):
            program = programs / name
            program.write_text(f'#!/bin/sh\nexec "{sys.executable}" {module}"$@"\n')
            program.chmod(0o755)
        return {
            **os.environ,
            "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}",
            "XDG_CACHE_HOME": str(self.folder / ".cache"),  # nothing that an earlier run left is taken up
            "COLUMNS": str(WIDTH),
            "NO_COLOR": "1",
            "MPLBACKEND": "Agg",
        }


def cut(output: str, after: str, until: str) -> str:
    """The lines from the first that begins with `after` to before the next that begins with `until`."""
    lines = [re.sub(r"\s+$", "", line) for line in output.splitlines()]
    start = next((i for i, line in enumerate(lines) if line.startswith(after)), None)
    if start is None:
        raise ValueError(f"no line begins with {after!r} in\n{output}")
    stop = next((i for i, line in enumerate(lines) if i > start and until and line.startswith(until)), len(lines))
    return "\n".join(lines[start:stop]).strip("\n")


def wrapped(line: str) -> str:
    """A line that fits the page; what goes on below stands under the second column, if there is one."""
    if len(line) <= WIDTH:
        return line
    column = re.match(r"\S.*?\s{2,}", line)
    indent = " " * (column.end() if column else 4)
    return "\n".join(textwrap.wrap(line, WIDTH, subsequent_indent=indent, drop_whitespace=True))

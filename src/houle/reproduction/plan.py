"""The plan of a reproduction: the runs listed in the plan.toml of its folder, as cases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase as fnmatch
from pathlib import Path
from typing import Any

from houle.case.messages import nearest
from houle.case.model import Case, load
from houle.case.reading import read_toml
from houle.errors import CaseError

FOLDER = Path(__file__).parent
PLAN = "plan.toml"


@dataclass(frozen=True)
class Job:
    """A run of the plan; plan.toml explains its keys at its head.

    spacing, quick [m]; slope [degrees], height, flume [m], 0 where they do not apply.
    """

    name: str
    case: str
    part: str
    spacing: float
    quick: float | None = None
    set: dict[str, Any] = field(default_factory=dict)
    of: str = ""
    scheme: str = "houle"
    slope: int = 0
    height: float = 0.0
    flume: int = 0
    changed: str = ""
    folder: Path = FOLDER

    def load(self, spacing: float | None, quick: bool) -> Case:
        """The case to run, with the name of the job and, if given, this spacing [m]. Raises CaseError."""
        file = self.folder / f"{self.case}.toml"
        chosen = spacing or (self.quick if quick and self.quick else self.spacing)
        changes = {"case.name": self.name, "domain.spacing": chosen, **self.set}
        return load(file if file.is_file() else self.case, changes)


def papers() -> list[str]:
    """Names of the papers that come with a plan."""
    return sorted(p.parent.name for p in FOLDER.glob(f"*/{PLAN}"))


def folder_of(paper: str) -> Path:
    """The folder of a paper. Raises CaseError for an unknown one."""
    if paper not in papers():
        raise CaseError(f"PAPER = {paper} is not known.{nearest(paper, papers())} There is: {', '.join(papers())}")
    return FOLDER / paper


def read(folder: Path) -> list[Job]:
    """The runs of a plan, in its order."""
    return [Job(**row, folder=folder) for row in read_toml(folder / PLAN)["run"]]


def choose(jobs: Sequence[Job], only: Sequence[str], quick: bool) -> list[Job]:
    """The jobs asked for: those of --quick or all, and of these the names or patterns in `only`. Raises CaseError."""
    ready = [job for job in jobs if job.quick is not None or not quick]
    for pattern in only:
        if not any(fnmatch(job.name, pattern) for job in ready):
            names = [job.name for job in ready]
            raise CaseError(f"--only {pattern}: no such run.{nearest(pattern, names)} There are: {', '.join(names)}")
    return [job for job in ready if not only or any(fnmatch(job.name, pattern) for pattern in only)]

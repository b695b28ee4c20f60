"""Findings: the results of the checks of a case."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Finding:
    """One finding in a case.

    level  "error": the case cannot be run; "warning": the result may be wrong; "info": good to know
    key    key of the case file that it is about
    text   the two numbers compared and the cure; it is read after the key, so it begins with a verb, "=" or ":"
    """

    level: Literal["error", "warning", "info"]
    key: str
    text: str

    def __str__(self) -> str:
        return f"{self.key}{'' if self.text.startswith(':') else ' '}{self.text}"

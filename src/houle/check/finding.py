"""What a check finds in a case."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class Finding:
    """One thing found in a case: how bad it is, the key it is about, and what is said of it.

    The text quotes the two numbers compared and the cure. It follows the key, or begins with a colon.
    """

    level: Literal["error", "warning", "info"]
    key: str
    text: str

    def __str__(self) -> str:
        return f"{self.key}{'' if self.text.startswith(':') else ' '}{self.text}"

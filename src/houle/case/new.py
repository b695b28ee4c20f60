"""`houle new`: writes a commented case file to start from."""

from __future__ import annotations

import re
from pathlib import Path

from houle.case.reading import NAME
from houle.errors import CaseError

DAM_BREAK = Path(__file__).parent / "template.toml"
WAVES = Path(__file__).parent / "template_waves.toml"


def write(name: str, *, waves: bool = False) -> Path:
    """Writes NAME.toml, a dam break or a wave flume, and returns its path. Raises CaseError for a bad or taken name."""
    file = Path(name if name.endswith(".toml") else f"{name}.toml")
    if not re.match(NAME, file.stem):
        raise CaseError(f"NAME = {name} is not a name: letters, digits, - _ . only, a letter or digit first")
    try:
        with file.open("x", encoding="utf-8") as stream:
            stream.write((WAVES if waves else DAM_BREAK).read_text(encoding="utf-8").format(name=file.stem))
    except FileExistsError:
        raise CaseError(f"{file} is there already: choose another name, or remove it first") from None
    except OSError as error:
        raise CaseError(
            f"{file} cannot be written: {error.strerror}. Choose a folder that exists and is yours"
        ) from None
    return file

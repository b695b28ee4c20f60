# The compiled core for type checkers: whatever is asked for. Its functions are described where they are, core/houle.
from typing import Any

def __getattr__(name: str) -> Any: ...

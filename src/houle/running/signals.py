"""Signals that ask a run to stop: Ctrl-C, SIGTERM, and SIGHUP, when the terminal closes.

While steps are made they are noted, and the step is finished; before and after that they interrupt the program.
Python handles signals in the main thread; in other threads these functions do nothing. A SIGHUP that is ignored (nohup)
stays ignored.
"""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

WORDS = {"SIGINT": "Ctrl-C", "SIGTERM": "SIGTERM", "SIGHUP": "SIGHUP"}


def _wanted() -> dict[int, str]:
    """Number and name of the signals that the system knows and that are not ignored."""
    numbers = {getattr(signal, name): word for name, word in WORDS.items() if hasattr(signal, name)}
    hangup = getattr(signal, "SIGHUP", None)
    return {n: word for n, word in numbers.items() if not (n == hangup and signal.getsignal(n) == signal.SIG_IGN)}


@contextmanager
def as_interrupts() -> Iterator[None]:
    """Inside, a signal that would end the process raises KeyboardInterrupt with its name, as Ctrl-C does by itself."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return

    def stop(number: int, _: Any) -> None:
        raise KeyboardInterrupt(WORDS[signal.Signals(number).name])

    before = {n: signal.getsignal(n) for n in _wanted() if signal.getsignal(n) == signal.SIG_DFL}
    for number in before:
        signal.signal(number, stop)
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


@contextmanager
def noted() -> Iterator[list[str]]:
    """Yields a list that gets the name of a signal when it comes; a second signal of its kind acts as before."""
    reasons: list[str] = []
    if threading.current_thread() is not threading.main_thread():
        yield reasons
        return
    wanted = _wanted()
    before = {number: signal.getsignal(number) for number in wanted}

    def note(number: int, _: Any) -> None:
        reasons.append(wanted[number])
        signal.signal(number, before[number])

    for number in wanted:
        signal.signal(number, note)
    try:
        yield reasons
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
